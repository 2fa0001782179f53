"""Remote stores on an S3 server on this machine: shared results, hostile objects, no server."""

import http.server
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time

import boto3
import botocore

from place import Place, say

BUCKET = "results"
URL = f"s3://{BUCKET}/team/one"
JOBS = 7


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def environment(port, key="key"):
    return {
        "AWS_ACCESS_KEY_ID": key,
        "AWS_SECRET_ACCESS_KEY": "secret",
        "AWS_REGION": "us-east-1",
        "AWS_ENDPOINT": f"http://127.0.0.1:{port}",
        "AWS_ALLOW_HTTP": "true",
        "AWS_TIMEOUT": "2 s",
    }


class Server:
    """A server of moto and a client of it."""

    def __init__(self):
        self.port = free_port()
        program = pathlib.Path(sys.executable).parent / "moto_server"
        words = [program, "--host", "127.0.0.1", "--port", str(self.port)]
        self.process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.client = boto3.client(
            "s3",
            endpoint_url=f"http://127.0.0.1:{self.port}",
            aws_access_key_id="key",
            aws_secret_access_key="secret",
            region_name="us-east-1",
        )
        deadline = time.time() + 60
        while True:
            try:
                self.client.create_bucket(Bucket=BUCKET)
                return
            except botocore.exceptions.EndpointConnectionError:
                assert time.time() < deadline, "the server does not start"
                time.sleep(0.2)

    def names(self, prefix):
        pages = self.client.get_paginator("list_objects_v2").paginate(Bucket=BUCKET, Prefix=prefix)
        return [item["Key"] for page in pages for item in page.get("Contents", [])]

    def read(self, name):
        return self.client.get_object(Bucket=BUCKET, Key=name)["Body"].read()

    def write(self, name, content):
        self.client.put_object(Bucket=BUCKET, Key=name, Body=content)

    def remove(self, name):
        self.client.delete_object(Bucket=BUCKET, Key=name)

    def stamp(self, prefix, stage):
        return self.names(f"{prefix}/results/{stage}/")[0]


def words(did):
    return sorted(set(did.values()))


def two_stores(server, folder):
    """The second store computes nothing. Its log is long enough for an upload in pieces."""
    sets = ["pack.spacing=0.1 mm", "frames.interval=0.002 ms", "post.panels=[]"]
    long = ["--name", "long"] + [word for one in sets for word in ("--set", one)]
    first, second = (Place(folder / name, **environment(server.port)) for name in ["one", "two"])
    did, made, warnings = first.run("--remote", URL)
    assert words(did) == ["ran"] and len(did) == JOBS and not warnings, (did, warnings)
    did, got, warnings = second.run(CORONET_REMOTE=URL)
    assert words(did) == ["fetched"] and got == made and not warnings, (did, warnings)
    _, made, _ = first.run("--remote", URL, *long)
    did, got, warnings = second.run("--remote", URL, *long)
    assert words(did) == ["fetched"] and got == made and not warnings, (did, warnings)
    second.call("verify")
    sizes = server.client.list_objects_v2(Bucket=BUCKET)["Contents"]
    largest = max(item["Size"] for item in sizes)
    assert largest > 8 << 20, largest
    say(f"two stores: {JOBS} results fetched, the largest object has {largest / 1e6:.1f} MB")
    third = Place(folder / "three", **environment(server.port))
    third.call("pull", "tiny.toml", code=2)
    third.call("pull", "tiny.toml", "--remote", URL)
    out, _ = first.call("push", "--remote", URL)
    assert "0 results put" in out, out
    _, err = third.call("pull", "tiny.toml", "--remote", URL, "--set", "pack.seed=7", code=1)
    assert "does not have this result" in err, err
    return made


def hostile(server, folder):
    """Each bad object ends in a recomputation with a warning, and is good afterwards."""
    url = f"s3://{BUCKET}/hostile"
    good = Place(folder / "good", **environment(server.port))
    _, expected, _ = good.run("--remote", url)
    files = server.names("hostile/files/")
    frames = next(name for name in files if server.read(name)[1:5] == b"MCAP")
    stamp = server.stamp("hostile", "impact")
    file = b'"file": "'
    cases = {
        "a flipped bit": (frames, lambda old: old[:500] + bytes([old[500] ^ 1]) + old[501:]),
        "cut off": (frames, lambda old: old[: len(old) // 2]),
        "empty": (frames, lambda old: b""),
        "longer": (frames, lambda old: old + b"x"),
        "missing": (frames, None),
        "a stamp of another key": (stamp, lambda old: server.read(server.stamp("hostile", "post"))),
        "an edited stamp": (stamp, lambda old: old.replace(b'"threads": ', b'"threads": 1')),
        "a stamp that leads out": (stamp, lambda old: old.replace(file, file + b"../../", 1)),
        "a huge stamp": (stamp, lambda old: b"[" * (17 << 20)),
        "no stamp at all": (stamp, lambda old: b"\0" * 100),
    }
    for number, (what, (name, spoil)) in enumerate(cases.items()):
        # Of a missing file, the stamp says that it must be there.
        if spoil:
            server.write(name, spoil(server.read(name)))
        else:
            server.remove(name)
        place = Place(folder / f"bad-{number}", **environment(server.port))
        did, digests, warnings = place.run("--remote", url)
        ran = [stage for (stage, _), word in did.items() if word == "ran"]
        assert ran == ["impact"] and len(warnings) == 1, (what, did, warnings)
        assert digests == expected, what
        place.call("verify")
        place = Place(folder / f"again-{number}", **environment(server.port))
        did, digests, warnings = place.run("--remote", url)
        assert words(did) == ["fetched"] and digests == expected and not warnings, (what, did)
        say(f"{what}: made again, the same digests, good afterwards")


class Refusal(http.server.BaseHTTPRequestHandler):
    """A server that permits nothing."""

    def answer(self):
        self.send_response(403)
        self.send_header("Content-Length", "0")
        self.end_headers()

    do_GET = do_HEAD = do_PUT = do_POST = answer

    def log_message(self, *_):
        pass


def no_server(folder):
    """Without an answer, a run says so once and goes on."""
    refusing = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Refusal)
    threading.Thread(target=refusing.serve_forever, daemon=True).start()
    silent = socket.create_server(("127.0.0.1", 0))
    ports = {
        "no network": free_port(),
        "403": refusing.server_port,
        "no answer": silent.getsockname()[1],
    }
    for what, port in ports.items():
        place = Place(folder / what.replace(" ", "-"), **environment(port))
        start = time.time()
        did, _, warnings = place.run("--remote", URL, "--until", "pack")
        assert words(did) == ["ran"] and len(warnings) == 1, (did, warnings)
        assert "goes on without it" in warnings[0], warnings
        say(f"{what}, {time.time() - start:.1f} s: {warnings[0]}")
        assert "secret" not in warnings[0]
        place.call("verify")
        place.call("push", "--remote", URL, code=5)
        place.call("pull", "tiny.toml", "--set", "pack.seed=9", "--remote", URL, code=5)
    refusing.shutdown()


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    server = Server()
    try:
        place = Place(folder / "nobody", **environment(server.port))
        _, err = place.call("run", "tiny.toml", "--until", "pack", "--remote", "s3://nowhere/a")
        assert "no such bucket" in err, err
        two_stores(server, folder / "shared")
        hostile(server, folder / "hostile")
    finally:
        server.process.terminate()
        server.process.wait()
    no_server(folder / "none")
say("S3: all well")
