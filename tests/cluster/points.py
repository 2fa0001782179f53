"""A study of twelve points, and what its processes and results are."""

import csv
import pathlib
import time

# Twelve points of some seconds each.
STUDY = """
title = "Energy of tiny drops"
pipeline = "tiny.toml"
set = ["impact.end=120 ms", "impact.checkpoint_every=0.5 s", "post.panels=[]"]

[[axis]]
name = "velocity"
key = "body.drop.velocity"
values = ["0.8 m/s", "1 m/s", "1.2 m/s"]

[[axis]]
name = "seed"
key = "pack.seed"
values = [1, 2]

[[axis]]
name = "speed of sound"
points = [
    { label = "adaptive" },
    { label = "constant", set = ["method.wcsph.sound_speed=constant"] },
]

[[figure]]
name = "energy"
column = "kinetic_energy_J"
of = "last"
"""


def table(place):
    """The rows of the table without the last column, the times."""
    with open(place.folder / "artifacts/latest/study/figures.csv") as file:
        return [row[:-1] for row in csv.reader(file)]


def processes():
    """The points that run: process of `coronet study --point K`, with those that it started."""
    found = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_text().split("\0")
        except OSError:
            continue
        if "--point" in words and words[1] == "study":
            found[int(words[words.index("--point") + 1])] = int(folder.name)
    return found


def children(process):
    """The processes that a process has started."""
    return [int(p) for p in pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def wait_for(what, condition, seconds=120):
    deadline = time.time() + seconds
    while not (found := condition()):
        assert time.time() < deadline, f"{what}: not after {seconds} s"
        time.sleep(0.2)
    return found


def checkpoints(place):
    return list((place.folder / "artifacts/impact").glob("*/work/*.checkpoint"))
