"""One run on several processes of MPI: the digests of one process, also after kills."""

import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import tempfile
import time

from place import PROGRAM, Place, say

SPLASH = pathlib.Path(__file__).parent.parent.parent / "scenes" / "tiny.toml"
FAST = ["--set", "impact.end=2 ms"]
# In two dimensions, unless the name says otherwise.
SCENES = {
    "periodic sides": [],
    "walls": ["--set", "box.x=wall", *FAST],
    "walls of 60 degrees": ["--set", "box.x=wall", "--set", "effects.wetting.angle=60 deg", *FAST],
    "advancing and receding angles": [
        "--set",
        "box.x=wall",
        "--set",
        'effects.wetting={advancing="100 deg",receding="50 deg"}',
        *FAST,
    ],
    "open sides": ["--set", "box.x=open", "--set", "body.drop.velocity=4 m/s"],
    "half": ["--set", "box.symmetry=half", *FAST],
    "ISPH": ["--set", "method.name=isph", *FAST],
    "ISPH, walls of 60 degrees": [
        "--set",
        "method.name=isph",
        "--set",
        "box.x=wall",
        "--set",
        "effects.wetting.angle=60 deg",
        *FAST,
    ],
    "no tension, ISPH, walls": ["--set", "method.name=isph", "--set", "box.x=wall", *FAST],
    "three dimensions, no tension, MPS, half": [
        "--set",
        "method.name=mps",
        "--set",
        "box.symmetry=half",
        "--set",
        "pack.spacing=0.5 mm",
        *FAST,
    ],
    "three dimensions, MPS, half, walls": [
        "--set",
        "method.name=mps",
        "--set",
        "box.symmetry=half",
        "--set",
        "box.x=wall",
        "--set",
        "pack.spacing=0.5 mm",
        *FAST,
    ],
    "three dimensions, MPS, open sides": [
        "--set",
        "method.name=mps",
        "--set",
        "box.x=open",
        "--set",
        "body.drop.velocity=4 m/s",
        "--set",
        "pack.spacing=0.5 mm",
        *FAST,
    ],
    "three dimensions": ["--set", "pack.spacing=0.5 mm", *FAST],
    "three dimensions, quarter": ["--set", "box.symmetry=quarter", *FAST],
}
KILLS = 20
MPIRUN = os.environ.get("MPIRUN", "mpirun --oversubscribe --bind-to none").split()
ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def launch(place, ranks, words, mpirun=MPIRUN):
    return subprocess.Popen(
        [*mpirun, "-n", str(ranks), PROGRAM, "run", "tiny.toml", "--json", *words],
        cwd=place.folder,
        env={**place.environment, **ROOT},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def digests(text):
    lines = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
    stages = [line for line in lines if "status" in line]
    return {(s["stage"], s["body"]): s["digest"] for s in stages}


def finished(place, ranks, words, mpirun=MPIRUN):
    process = launch(place, ranks, words, mpirun)
    out, err = process.communicate()
    assert process.returncode == 0, f"{ranks} ranks: {process.returncode}\n{out}{err}"
    return digests(out)


def same_digests(folder):
    for name, sets in SCENES.items():
        place = Place(folder / name.replace(" ", "-"))
        if name.startswith("three"):
            shutil.copy(SPLASH, place.folder / "tiny.toml")
        if "no tension" in name:
            scene = place.folder / "tiny.toml"
            text, count = re.subn(r"\[effects.tension\]\n(.+\n)+", "", scene.read_text())
            assert count == 1, text
            scene.write_text(text)
        _, alone, _ = place.run("--threads", "1", "--artifacts", "alone", *sets)
        for ranks in [2, 3, 4, 7]:
            for threads in ["1", "2"]:
                words = ["--threads", threads, "--artifacts", f"with-{ranks}-{threads}", *sets]
                assert finished(place, ranks, words) == alone, f"{name}: {ranks} ranks"
        say(f"{name}: 2, 3, 4 and 7 ranks with 1 and 2 threads have the digests of one process")


def children(process):
    found = subprocess.run(
        ["pgrep", "--parent", str(process.pid)], capture_output=True, text=True
    ).stdout
    return [int(number) for number in found.split()]


def kills(folder):
    place, random_numbers = Place(folder / "kills"), random.Random(1)
    words = ["--threads", "1", "--set", "impact.checkpoint_every=200 ms", "--set", "impact.end=20 ms"]
    _, alone, _ = place.run(*words, "--artifacts", "alone")
    done, runs = 0, 0
    while done < KILLS:
        folder, runs = f"killed-{runs}", runs + 1
        while True:
            ranks = random_numbers.choice([2, 3, 4])
            process = launch(place, ranks, [*words, "--artifacts", folder])
            time.sleep(random_numbers.uniform(0.5, 3))
            victims = children(process)
            if process.poll() is None and victims and done < KILLS:
                subprocess.run(["kill", "-KILL", str(random_numbers.choice(victims))])
                done += 1
            out, err = process.communicate()
            if process.returncode == 0:
                break
        assert digests(out) == alone, f"after kills: {err}"
    say(f"{KILLS} kills of a rank: the same digests, with other numbers of ranks")


def refused(folder):
    place = Place(folder / "refused")
    process = launch(place, 2, ["--set", "method.name=isph", "--set", "method.preset=paper"])
    _, err = process.communicate()
    assert process.returncode != 0 and "several processes cannot share" in err, err
    say("a preset that ranks cannot share is refused in words")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        same_digests(folder)
        kills(folder)
        refused(folder)
