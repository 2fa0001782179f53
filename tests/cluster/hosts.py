"""One run on two hosts of Open MPI, which are network namespaces of this machine and share only its
files: the digests of one process, also after one of them is lost."""

import pathlib
import signal
import subprocess
import tempfile
import time

from place import Place, say
from ranks import SCENES, finished, launch

# Name of each host and its address.
HOSTS = {"coronet-a": "10.250.7.1", "coronet-b": "10.250.7.2"}
SHARED = ["walls", "ISPH, walls of 60 degrees"]


def ip(*words):
    done = subprocess.run(["ip", *words], capture_output=True, text=True, check=True)
    return done.stdout


class Hosts:
    """Two namespaces that are connected by a wire."""

    def __init__(self, folder):
        self.agent = folder / "agent"
        # Open MPI calls it as `agent HOST COMMAND`, where it would call ssh.
        cases = "".join(f"{address}) name={name};;\n" for name, address in HOSTS.items())
        self.agent.write_text(
            f"""#!/bin/sh
address=$1
shift
case $address in
{cases}esac
exec ip netns exec "$name" unshare --uts sh -c 'hostname "$1"; shift; exec sh -c "$*"' sh "$name" "$@"
"""
        )
        self.agent.chmod(0o755)

    def __enter__(self):
        first, second = HOSTS
        self.remove()
        for name in HOSTS:
            ip("netns", "add", name)
        ip("link", "add", "wire", "netns", first, "type", "veth", "peer", "name", "wire", "netns", second)
        for name, address in HOSTS.items():
            ip("-n", name, "address", "add", f"{address}/24", "dev", "wire")
            ip("-n", name, "link", "set", "lo", "up")
            ip("-n", name, "link", "set", "wire", "up")
        return self

    def __exit__(self, *_):
        self.remove()

    def remove(self):
        """Those that there are: a test that was killed leaves them."""
        there = [line.split()[0] for line in ip("netns", "list").splitlines()]
        for name in set(HOSTS).intersection(there):
            self.kill(name)
            ip("netns", "delete", name)

    def mpirun(self, each):
        """The start of a command for `each` so many ranks on each host."""
        name, slots = next(iter(HOSTS)), ",".join(f"{address}:{each}" for address in HOSTS.values())
        enter = f'hostname {name}; exec mpirun.openmpi "$@"'
        options = ["--bind-to", "none", "--mca", "plm_rsh_agent", self.agent, "--host", slots]
        return ["ip", "netns", "exec", name, "unshare", "--uts", "sh", "-c", enter, "sh", *options]

    def processes(self, name):
        """Numbers of the processes of a host that are ranks, and of all."""
        numbers = [int(number) for number in ip("netns", "pids", name).split()]
        return [n for n in numbers if command(n) == "coronet"], numbers

    def kill(self, name):
        for number in self.processes(name)[1]:
            subprocess.run(["kill", "-KILL", str(number)], stderr=subprocess.DEVNULL)


def command(number):
    try:
        return pathlib.Path(f"/proc/{number}/comm").read_text().strip()
    except FileNotFoundError:
        return None


def same_digests(hosts, folder):
    for name in SHARED:
        place = Place(folder / name.replace(" ", "-"))
        words = ["--threads", "1", *SCENES[name]]
        _, alone, _ = place.run(*words, "--artifacts", "alone")
        for each in [1, 2]:
            found = finished(
                place, 2 * each, [*words, "--artifacts", f"with-{each}"], hosts.mpirun(each)
            )
            assert found == alone, f"{name}: {each} ranks a host"
        say(f"{name}: two hosts with 1 and 2 ranks each have the digests of one process")


def loses_a_host(hosts, folder):
    place = Place(folder / "lost")
    words = ["--threads", "1", "--set", "impact.checkpoint_every=100 ms", "--set", "impact.end=20 ms"]
    _, alone, _ = place.run(*words, "--artifacts", "alone")
    process = launch(place, 4, [*words, "--artifacts", "lost"], hosts.mpirun(2))
    while not list(place.folder.glob("lost/impact/*/work/*.checkpoint")):
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    on_each = [len(hosts.processes(name)[0]) for name in HOSTS]
    assert on_each == [2, 2], on_each
    hosts.kill("coronet-b")
    _, err = process.communicate(timeout=60)
    assert process.returncode not in [0, -signal.SIGKILL], process.returncode
    # What Open MPI calls the process that it has on each host.
    assert "daemon" in err, err
    _, found, _ = place.run(*words, "--artifacts", "lost")
    assert found == alone
    say("a host is lost: the run ends and says so, and goes on with the other to the same digests")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        with Hosts(folder) as hosts:
            same_digests(hosts, folder)
            loses_a_host(hosts, folder)
