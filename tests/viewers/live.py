"""A running impact, seen by a client of the Foxglove WebSocket protocol while it runs."""

import asyncio
import base64
import csv
import json
import os
import struct
import subprocess
import tempfile
from pathlib import Path

import websockets
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

PROGRAM = os.environ["CORONET"]
SCENE = Path(__file__).resolve().parents[2] / "scenes/tiny.toml"
MESSAGE = 1  # opcode of a message: then u32 subscription, u64 log time, content


def reader(schema):
    """Class of the messages of a channel, from its schema."""
    files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(schema["schema"]))
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(schema["schemaName"]))


async def watch(port):
    """Messages by topic until the server goes, in the order of their arrival."""
    seen, channels = {}, {}
    unknown = "Unknown channel ID: "
    # It may not listen yet.
    for _ in range(100):
        try:
            socket = await websockets.connect(
                f"ws://127.0.0.1:{port}", subprotocols=["foxglove.sdk.v1"], max_size=None
            )
            break
        except OSError:
            await asyncio.sleep(0.1)
    try:
        async for message in socket:
            if isinstance(message, str):
                told = json.loads(message)
                if told["op"] == "status" and told["message"].startswith(unknown):
                    # The server advertises a channel just before it accepts subscriptions to it.
                    number = int(told["message"].removeprefix(unknown))
                    again = {"op": "subscribe", "subscriptions": [{"id": number, "channelId": number}]}
                    await socket.send(json.dumps(again))
                elif told["op"] == "advertise":
                    for channel in told["channels"]:
                        channels[channel["id"]] = (channel["topic"], reader(channel))
                    ids = [{"id": c["id"], "channelId": c["id"]} for c in told["channels"]]
                    await socket.send(json.dumps({"op": "subscribe", "subscriptions": ids}))
            elif message[0] == MESSAGE:
                number, time = struct.unpack_from("<IQ", message, 1)
                topic, kind = channels[number]
                seen.setdefault(topic, []).append((time, kind.FromString(message[13:])))
    except websockets.ConnectionClosed:
        pass
    return seen


def main():
    with tempfile.TemporaryDirectory() as folder:
        command = [PROGRAM, "run", str(SCENE), "--artifacts", folder, "--live=127.0.0.1:0"]
        run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        told = run.stderr.readline()
        assert told.startswith("live     ws://127.0.0.1:"), told
        seen = asyncio.run(watch(int(told.rsplit(":", 1)[1])))
        run.stderr.read()
        assert run.wait() == 0
        table = Path(folder, "latest/tiny/post/measures.csv")
        rows = list(csv.DictReader(table.open()))
    for topic in ["/tf", "/wall", "/body/drop", "/body/pool", "/measures", "/figures"]:
        assert seen.get(topic), (topic, list(seen))
    times = [message.time_s for _, message in seen["/measures"]]
    assert len(times) > len(rows) // 2, f"{len(times)} of {len(rows)} frames"
    assert times == sorted(times)
    # What it saw is what is in the table.
    by_time = {float(row["time_s"]): row for row in rows}
    for _, figures in seen["/figures"]:
        row = by_time[figures.time_s]
        for name in ["crater_depth_m", "crown_height_m", "crater_diameter_m"]:
            value, wanted = getattr(figures, name), float(row[name] or "nan")
            assert value == wanted or (value != value and wanted != wanted), (name, value, wanted)
    print(f"live: good, {len(times)} frames of {len(rows)}")

    refused = subprocess.run([PROGRAM, "run", str(SCENE), "--live=nowhere"], capture_output=True, text=True)
    assert refused.returncode == 2 and "127.0.0.1:8765" in refused.stderr, refused.stderr


main()
