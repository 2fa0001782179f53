"""A film of `coronet render` as FFmpeg decodes it: its frames are the pictures of the same instants."""

import os
import subprocess
import tempfile
from pathlib import Path

import av
import numpy
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SIZE = (320, 240)
# Lossy compression and chroma at half the resolution: mean difference of grey levels, of 255.
NEAR = 4.0


def main():
    coronet = os.environ["CORONET"]
    with tempfile.TemporaryDirectory() as folder:
        call = lambda *words: subprocess.run([coronet, *words], check=True, cwd=folder)
        call("run", str(ROOT / "scenes/tiny.toml"), "--until", "impact")
        render = ["render", "tiny", "--every", "1 ms", "--size", "x".join(map(str, SIZE))]
        call(*render, "--output", "film.mp4")
        call(*render, "--output", "still.png")
        stills = [grey(Image.open(path)) for path in sorted(Path(folder).glob("still*.png"))]
        with av.open(str(Path(folder, "film.mp4"))) as film:
            frames = [grey(frame.to_image()) for frame in film.decode(video=0)]
    assert len(frames) == len(stills) == 7, f"{len(frames)} frames, {len(stills)} pictures"
    for index, (frame, still) in enumerate(zip(frames, stills)):
        assert frame.shape == still.shape == SIZE[::-1], f"frame {index} is {frame.shape}"
        assert still.std() > 5, f"picture {index} shows nothing"
        away = numpy.abs(frame - still).mean()
        assert away < NEAR, f"frame {index} differs from its picture by {away:.1f} grey levels"
    moved = numpy.abs(stills[-1] - stills[0]).mean()
    assert moved > NEAR, "nothing moves"
    print(f"film: good, {len(frames)} frames")


def grey(image):
    return numpy.asarray(image.convert("L"), dtype=float)


main()
