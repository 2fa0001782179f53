"""A study on a real Slurm on this machine: killed and requeued points, the table of a local study."""

import json
import os
import re
import signal
import socket
import subprocess
import time

from place import say
from points import (
    checkpoints,
    children,
    compare,
    on_system,
    places,
    processes,
    stop_and_continue,
    wait_for,
)


class Slurm:
    """A controller and a node with this machine's cores, in a folder of their own."""

    def __init__(self, folder):
        self.processes = []
        folder.mkdir()
        host = socket.gethostname().split(".")[0]
        cores = os.cpu_count()
        # Requeued jobs wait until old credentials are no longer valid: by default two minutes.
        text = f"""
            ClusterName=check
            SlurmctldHost={host}(127.0.0.1)
            SlurmctldPort=16817
            SlurmdPort=16818
            AuthType=auth/munge
            AuthInfo=cred_expire=15,socket={folder}/munge.socket
            CredType=cred/munge
            SlurmUser=root
            SlurmdUser=root
            StateSaveLocation={folder}/state
            SlurmdSpoolDir={folder}/spool
            SlurmctldPidFile={folder}/slurmctld.pid
            SlurmdPidFile={folder}/slurmd.pid
            SlurmctldLogFile={folder}/slurmctld.log
            SlurmdLogFile={folder}/slurmd.log
            ProctrackType=proctrack/linuxproc
            TaskPlugin=task/none
            MpiDefault=none
            SwitchType=switch/none
            SelectType=select/cons_tres
            SelectTypeParameters=CR_CPU
            AccountingStorageType=accounting_storage/none
            JobAcctGatherType=jobacct_gather/none
            SchedulerType=sched/backfill
            SchedulerParameters=sched_interval=2,bf_interval=2
            ReturnToService=2
            KillWait=20
            NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=2000 State=UNKNOWN
            PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
        """
        self.configuration = folder / "slurm.conf"
        self.configuration.write_text("\n".join(line.strip() for line in text.splitlines()))
        for name in ["state", "spool"]:
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        os.environ["SLURM_CONF"] = str(self.configuration)
        munge = ["munged", "-F", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket"]
        files = ["pid", "seed", "log"]
        munge += [f"--{name}-file={folder}/munge.{name}" for name in files]
        self.start(folder, *munge)
        while not (folder / "munge.socket").exists():
            time.sleep(0.1)
        self.start(folder, "slurmctld", "-D", "-f", str(self.configuration))
        self.start(folder, "slurmd", "-D", "-f", str(self.configuration), "-N", host)
        deadline = time.time() + 60
        while "idle" not in self.ask("sinfo", "--noheader", "--format=%T", check=False):
            assert time.time() < deadline, (folder / "slurmd.log").read_text()
            time.sleep(0.5)

    def start(self, folder, *words):
        path = os.environ["PATH"] + ":/usr/sbin"
        log = open(folder / f"{words[0]}.out", "w")
        process = subprocess.Popen(
            words, env={**os.environ, "PATH": path}, stdout=log, stderr=subprocess.STDOUT
        )
        self.processes.append(process)

    def ask(self, *words, check=True):
        return subprocess.run(words, capture_output=True, text=True, check=check).stdout

    def tasks(self):
        """State of each task that has not ended."""
        lines = self.ask("squeue", "--noheader", "--array", "--format=%K %T").splitlines()
        return {int(line.split()[0]): line.split()[1] for line in lines}

    def stop(self):
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()


def restarts(slurm, point):
    said = slurm.ask("scontrol", "show", "job", "--oneliner")
    lines = [line for line in said.splitlines() if f"ArrayTaskId={point} " in line]
    return max((int(re.search(r"Restarts=(\d+)", line)[1]) for line in lines), default=0)


def check(slurm, folder):
    local, cluster = places(folder)
    submit = ["study", "study.toml", "--on", "slurm"]
    start = time.time()
    out, _ = cluster.call(*submit)
    assert "12" in out or "waiting" in out, out
    say(f"submitted in {time.time() - start:.1f} s: {out.splitlines()[-4]}")

    # Two points are killed, the one with its program, the other without.
    wait_for("two points", lambda: len(processes()) >= 2)
    wait_for("checkpoints", lambda: len(checkpoints(cluster)) >= 2)
    first, second = sorted(processes())[:2]
    victims = processes()
    for victim in [victims[first], *children(victims[second])]:
        os.kill(victim, signal.SIGKILL)
    say(f"kill -9 of points {first} and {second}")
    wait_for("a requeue", lambda: restarts(slurm, first) and restarts(slurm, second))
    say("both were queued again by their scripts")

    # A third one is requeued from outside, as Slurm does when it preempts.
    third = wait_for("a third point", lambda: sorted(set(processes()) - {first, second}))[0]
    subprocess.run(["scontrol", "requeue", f"{job(slurm)}_{third}"], check=True)
    wait_for("its requeue", lambda: restarts(slurm, third))
    say(f"point {third} was requeued")

    wait_for("a third checkpoint", lambda: len({c.parent for c in checkpoints(cluster)}) >= 3)
    stop_and_continue(cluster, submit, lambda: not slurm.tasks() and not processes())
    compare(local, cluster)
    stamps = (cluster.folder / "artifacts/impact").glob("*/stamp.json")
    resumed = sum(json.loads(stamp.read_text())["resumptions"] > 0 for stamp in stamps)
    say(f"{resumed} impacts went on from a checkpoint")
    assert resumed >= 3
    _, err = cluster.call(*submit)
    assert err.count("fresh") == 12, err
    cluster.call("verify")


def job(slurm):
    return slurm.ask("squeue", "--noheader", "--array", "--format=%F").split()[0]


on_system(Slurm, check)
