"""A study of twelve points on a batch system, and what its processes and results are."""

import csv
import os
import pathlib
import tempfile
import time

from place import Place, say

# Twelve points of some seconds each.
STUDY = """
title = "Energy of tiny drops"
pipeline = "tiny.toml"
set = ["impact.end=300 ms", "impact.checkpoint_every=0.5 s", "post.panels=[]"]

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


def places(folder):
    """One for the study on this machine, one for that on the batch system."""
    both = [Place(folder / name) for name in ["local", "cluster"]]
    for place in both:
        (place.folder / "study.toml").write_text(STUDY)
    return both


def stop_and_continue(cluster, submit, is_stopped):
    """Another shell looks, stops everything, and continues to the end."""
    out, _ = cluster.call(*submit, "--look")
    say("looked at: " + out.splitlines()[-1])
    assert "0 running, 0 waiting" not in out, out
    _, err = cluster.call(*submit, "--cancel")
    assert "was told to stop" in err, err
    wait_for("the stop", is_stopped, 60)
    out, _ = cluster.call(*submit, "--look")
    say("stopped:   " + out.splitlines()[-1])
    assert "0 running, 0 waiting" in out and "missing" in out, out
    start = time.time()
    cluster.call(*submit, "--wait")
    say(f"continued in another shell to the end, {time.time() - start:.0f} s")


def compare(local, cluster):
    """Runs the study on this machine: both tables must be equal."""
    local.call("study", "study.toml", "--jobs", str(os.cpu_count()))
    assert table(local) == table(cluster), (table(local), table(cluster))
    assert len(table(local)) == 13
    say("the tables of 12 points are equal")


def on_system(system, check):
    """Starts a batch system, and stops it when `check` is through with it."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        started = system(folder / "system")
        try:
            check(started, folder)
        finally:
            started.stop()
    say(f"{system.__name__}: all well")
