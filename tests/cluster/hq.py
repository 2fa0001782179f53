"""A study on a real HyperQueue on this machine: a lost worker, the table of a local study."""

import os
import pathlib
import signal
import subprocess
import tempfile
import time

from place import Place, say
from points import STUDY, checkpoints, processes, table, wait_for


class HyperQueue:
    """A server and a worker with this machine's cores, in a folder of their own."""

    def __init__(self, folder):
        os.environ["HQ_SERVER_DIR"] = str(folder)
        self.folder, self.processes = folder, []
        self.start("server")
        wait_for("the server", lambda: (folder / "hq-current").exists())
        self.worker = self.start("worker")

    def start(self, what):
        log = open(self.folder.parent / f"hq-{what}.txt", "a")
        process = subprocess.Popen(["hq", what, "start"], stdout=log, stderr=subprocess.STDOUT)
        self.processes.append(process)
        return process

    def stop(self):
        for process in reversed(self.processes):
            process.terminate()
            process.wait()


def check(hq, folder):
    local, cluster = Place(folder / "local"), Place(folder / "cluster")
    for place in [local, cluster]:
        (place.folder / "study.toml").write_text(STUDY)
    submit = ["study", "study.toml", "--on", "hq"]
    cluster.call(*submit)
    running = wait_for("two points", lambda: (p := processes()) and len(p) >= 2 and p)
    wait_for("checkpoints", lambda: len(checkpoints(cluster)) >= 2)
    hq.worker.send_signal(signal.SIGKILL)
    for process in running.values():
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass
    say(f"kill -9 of the worker and of points {sorted(running)}")
    hq.worker.wait()
    hq.worker = hq.start("worker")
    again = wait_for("their new start", lambda: (p := processes()) and set(running) <= set(p) and p)
    say(f"another worker started points {sorted(again)}")

    out, _ = cluster.call(*submit, "--look")
    say("looked at: " + out.splitlines()[-1])
    assert "running" in out, out
    _, err = cluster.call(*submit, "--cancel")
    assert "was told to stop" in err, err
    wait_for("the stop", lambda: not processes(), 60)
    out, _ = cluster.call(*submit, "--look")
    say("stopped:   " + out.splitlines()[-1])
    assert "0 running, 0 waiting" in out and "missing" in out, out
    start = time.time()
    cluster.call(*submit, "--wait")
    say(f"continued in another shell to the end, {time.time() - start:.0f} s")

    local.call("study", "study.toml", "--jobs", str(os.cpu_count()))
    assert table(local) == table(cluster), (table(local), table(cluster))
    assert len(table(local)) == 13
    say("the tables of 12 points are equal")
    cluster.call("verify")


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    (folder / "hq").mkdir()
    hq = HyperQueue(folder / "hq")
    try:
        check(hq, folder)
    finally:
        hq.stop()
say("HyperQueue: all well")
