"""Makes seeds of the fuzz targets from a small store and scenes, and a dictionary from the schema.

usage: seeds.py STORE [SCENE...]
needs: zstd

The first byte of a seed of `checkpoint`, `log` and `stamp` chooses what the target does with the
rest: see `targets/`. Of logs there is a form without compression, so that changes reach messages.
"""

import json
import struct
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
LONGEST = 40_000


def seed(target, name, data):
    folder = HERE / "seeds" / target
    folder.mkdir(parents=True, exist_ok=True)
    if len(data) <= LONGEST:
        (folder / name).write_bytes(data)


def plain(log):
    """The records of a log, those of its chunks in chunks without compression."""
    magic, position, out = log[:8], 8, [log[:8]]
    while position < len(log) - 8:
        opcode = log[position]
        (length,) = struct.unpack_from("<Q", log, position + 1)
        body = log[position + 9 : position + 9 + length]
        position += 9 + length
        if opcode == 6:
            times_and_size = body[:24]
            (word,) = struct.unpack_from("<I", body, 28)
            records = body[32 + word + 8 :]
            if body[32 : 32 + word] == b"zstd":
                command = ["zstd", "-d", "-c"]
                records = subprocess.run(command, input=records, capture_output=True, check=True).stdout
            head = times_and_size + struct.pack("<II", 0, 0) + struct.pack("<Q", len(records))
            body = head + records
        if opcode in (1, 3, 4, 5, 6, 9, 12, 15, 2):
            out.append(struct.pack("<BQ", opcode, len(body)) + body)
    return b"".join(out) + magic


def words(value):
    """All keys and words of the format of scenes."""
    if isinstance(value, dict):
        for key, inside in value.items():
            if key in ("properties", "patternProperties") and isinstance(inside, dict):
                yield from inside
            if key in ("enum", "const"):
                yield from inside if isinstance(inside, list) else [inside]
            yield from words(inside)
    elif isinstance(value, list):
        for inside in value:
            yield from words(inside)


def dictionary():
    schema = json.loads((HERE / "../docs/pipeline.schema.json").read_text())
    found = {word for word in words(schema) if isinstance(word, str) and word.isascii()}
    units = "mm um m cm ms s us m/s mm/s kg/m^3 g/cm^3 mPa s N/m mN/m Pa deg rad m/s^2 J/kg 1/s"
    found |= {word for word in found | set(units.split()) if '"' not in word and "\\" not in word}
    numbers = {"0", "-1", "1e308", "-0.0", "nan", "inf", "1e-300", "18446744073709551615", "[]", "{}"}
    lines = [f'"{word}"' for word in sorted(found | numbers) if word.isprintable()]
    for target in ("scene", "set"):
        (HERE / "dictionaries" / f"{target}.dict").write_text("\n".join(lines) + "\n")


def main(store, scenes):
    dictionary()
    for mode in (b"\0", b"\1"):
        raw = "raw" if mode == b"\0" else "repaired"
        for path in sorted(Path(store).rglob("*.checkpoint")):
            name = f"{path.parent.parent.name}-{path.stem}-{raw}"
            seed("checkpoint", name, mode + path.read_bytes())
        for path in sorted(Path(store).rglob("stamp.json")):
            seed("stamp", f"{path.parent.parent.name}-{raw}", mode + path.read_bytes())
        for path in sorted(Path(store).rglob("*.mcap")):
            log = path.read_bytes()
            seed("log", f"{path.stem}-{raw}", mode + log)
            seed("log", f"{path.stem}-plain-{raw}", mode + plain(log))
    for path in map(Path, scenes):
        seed("scene", path.stem, path.read_bytes())


main(sys.argv[1], sys.argv[2:])
