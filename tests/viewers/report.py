"""The page of a run in headless Chromium: the player turns, plays and follows the plots."""

import io
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageChops, ImageStat
from playwright.sync_api import sync_playwright

PROGRAM = os.environ["CORONET"]
ROOT = Path(__file__).resolve().parents[2]
#: The scenes in three dimensions, as rings and in two dimensions.
RINGS = ["--set", "box.symmetry=axis", "--set", "box.x=wall", "--set", "box.y=wall"]
FLAT = ROOT / "scenes/verification/dam-break.toml"
KINDS = {
    "mesh": [ROOT / "scenes/tiny.toml"],
    "outline": [ROOT / "scenes/tiny.toml", *RINGS, "--set", "effects.wetting.angle=90 deg"],
    "points": [FLAT, "--set", "impact.end=60 ms"],
}


def shot(canvas):
    return Image.open(io.BytesIO(canvas.screenshot())).convert("RGB")


def differ(first, second):
    """Mean difference of pixels, of 255."""
    return max(ImageStat.Stat(ImageChops.difference(first, second)).mean)


def check(page, kind, page_file, pictures):
    mistakes = []
    page.on("pageerror", lambda error: mistakes.append(str(error)))
    page.on("request", lambda request: request.url.startswith("http") and mistakes.append(request.url))
    page.goto(page_file.as_uri())
    canvas = page.locator("#player canvas")
    page.wait_for_function("document.querySelector('#player canvas').dataset.shown !== undefined")
    assert canvas.is_visible(), "the player is hidden"
    last = int(page.locator("#time").get_attribute("max"))
    assert last >= 8, last

    def show(number):
        page.locator("#time").evaluate(
            "(slider, n) => { slider.value = n; slider.dispatchEvent(new Event('input')); }", number
        )
        page.wait_for_function(
            f"document.querySelector('#player canvas').dataset.shown === '{number}'"
        )
        return shot(canvas)

    first, middle = show(0), show(last // 2)
    # There is liquid: pixels far from the grey of the background.
    red, _, blue = middle.split()
    blueness = ImageChops.subtract(blue, red)
    share = sum(blueness.histogram()[31:]) / (middle.width * middle.height)
    assert share > 0.03, f"{kind}: {share:.3f} of the pixels are liquid"
    assert differ(first, middle) > 0.3, "all frames look the same"
    again = show(0)
    assert differ(first, again) == 0.0, "a frame looks different the second time"

    if kind != "points":
        box = canvas.bounding_box()
        page.mouse.move(box["x"] + 200, box["y"] + 150)
        page.mouse.down()
        page.mouse.move(box["x"] + 320, box["y"] + 190)
        page.mouse.up()
        assert differ(again, shot(canvas)) > 0.3, "it does not turn"

    page.locator("#play").click()
    page.wait_for_function("document.querySelector('#player canvas').dataset.shown > 1")
    page.locator("#play").click()

    # A click into a plot shows its values there, and the liquid of that instant.
    chart = page.locator(".chart svg").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    read = page.locator(".chart .read").first.inner_text()
    assert " ms: " in read, read
    page.wait_for_function(
        "document.querySelector('#player canvas').dataset.shown === document.querySelector('#time').value"
    )
    clock = page.locator("#clock").inner_text()
    at, there = (float(text.split(" ms")[0].split()[-1].replace("\u2212", "-")) for text in (clock, read))
    step = page.evaluate(
        "(() => { const { film } = JSON.parse(document.getElementById('data').textContent);"
        "return film.shots[1].ms - film.shots[0].ms; })()"
    )
    assert abs(at - there) <= 0.51 * step, (clock, read)

    page.locator("#copy").click()
    page.wait_for_function("document.getElementById('copy').textContent === 'Copied'")
    assert not mistakes, mistakes
    # Printed and saved pages have all pictures, also those that were never looked at.
    loaded = "[...document.images].every((image) => image.complete && image.naturalWidth > 0)"
    page.wait_for_function(loaded, timeout=5000)
    page.evaluate("scrollTo(0, 0)")
    page.screenshot(path=pictures / f"report-{kind}.png")


def main():
    pictures = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        options = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]
        browser = play.chromium.launch(executable_path="/usr/bin/chromium", args=options)
        for kind, arguments in KINDS.items():
            command = [PROGRAM, "run", *map(str, arguments), "--name", kind, "--artifacts", folder]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            page_file = Path(folder, "latest", kind, "post", "report.html")
            size = page_file.stat().st_size
            assert size < 15e6, f"{size} bytes"
            check(browser.new_page(), kind, page_file, pictures)
            for name, width, scheme in [("phone", 390, "light"), ("dark", 1200, "dark")]:
                page = browser.new_page(viewport={"width": width, "height": 844}, color_scheme=scheme)
                page.goto(page_file.as_uri())
                page.wait_for_function(
                    "document.querySelector('#player canvas').dataset.shown !== undefined"
                )
                wide = page.evaluate("document.documentElement.scrollWidth")
                assert wide <= width, f"{kind}, {name}: {wide} pixels wide"
                page.screenshot(path=pictures / f"report-{kind}-{name}.png", full_page=True)
            print(f"report of {kind}: good, {size / 1e6:.1f} MB")
        browser.close()


main()
