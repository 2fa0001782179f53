"""A folder with the tiny scene, the program that CORONET names, and what both tests need."""

import json
import os
import pathlib
import shutil
import subprocess

PROGRAM = os.environ["CORONET"]
SCENE = pathlib.Path(__file__).parent.parent / "pipeline" / "tiny.toml"


class Place:
    """A folder with `tiny.toml`, in which the program runs."""

    def __init__(self, folder, **environment):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True)
        shutil.copy(SCENE, self.folder / "tiny.toml")
        self.environment = {**os.environ, **environment}

    def call(self, *words, code=0, **environment):
        """Standard output and standard error of the program, which must end with `code`."""
        done = subprocess.run(
            [PROGRAM, *words],
            cwd=self.folder,
            env={**self.environment, **environment},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
        assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
        assert "panicked" not in done.stderr, done.stderr
        return done.stdout, done.stderr

    def run(self, *words, **environment):
        """What each stage did, the digest of each result, and the warnings."""
        out, err = self.call("run", "tiny.toml", "--json", *words, **environment)
        lines = [json.loads(line) for line in out.splitlines()]
        stages = [line for line in lines if "status" in line]
        did = {(s["stage"], s["body"]): s["status"] for s in stages}
        digests = {(s["stage"], s["body"]): s["digest"] for s in stages}
        warnings = [line for line in err.splitlines() if "remote store" in line]
        return did, digests, warnings


def say(text):
    print(text, flush=True)
