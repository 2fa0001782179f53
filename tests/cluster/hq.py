"""A study on a real HyperQueue on this machine: a lost worker, the table of a local study."""

import os
import signal
import subprocess

from place import say
from points import checkpoints, compare, on_system, places, processes, stop_and_continue, wait_for


class HyperQueue:
    """A server and a worker with this machine's cores, in a folder of their own."""

    def __init__(self, folder):
        folder.mkdir()
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
    local, cluster = places(folder)
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

    stop_and_continue(cluster, submit, lambda: not processes())
    compare(local, cluster)
    cluster.call("verify")


on_system(HyperQueue, check)
