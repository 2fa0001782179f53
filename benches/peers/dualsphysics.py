#!/usr/bin/env python3
"""Times Coronet and DualSPHysics on the same dam break, in turns on this machine.

A cube of water of SIDE^3 particles, one thread, the same kernel length and speed of sound. Prints
particle-steps a CPU second, CPU seconds to the same instant and memory, medians of turns, and adds
them to the CSV that CORONET_INTO names. DualSPHysics is fetched from its repository, or taken from
DUALSPHYSICS, a folder with its sources, and built for this processor with its own makefile.
CPU seconds are those of its whole process, of Coronet those of the impact; memory is the largest of
each process, which in Coronet has packed before.

Needs git, make and g++, and `cargo build --release` of Coronet (or CORONET, its program).
"""

import argparse
import csv
import io
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPOSITORY = "https://github.com/DualSPHysics/DualSPHysics"
COMMIT = "ef3721a861fda961f0e2f9ec4cd317b19de99086"
OPTIONS = [
    "COMPILE_CHRONO=NO",
    "COMPILE_WAVEGEN=NO",
    "COMPILE_MOORDYNPLUS=NO",
    "USE_NATIVE_CPU_OPTIMIZATIONS=YES",
]
# What its class that writes particles consists of.
CLASSES = [
    "JAppInfo",
    "JBinaryData",
    "JException",
    "JLog2",
    "JObject",
    "JPartDataBi4",
    "JPartDataHead",
    "Functions",
]
SPACING = 0.005
# Kernel length over spacing, of the preset `paper`.
SMOOTHING = 1.3
GRAVITY = 9.81
COLUMNS = ["of", "measure", "particles", "threads", "value", "unit"]

CASE = """<?xml version="1.0" encoding="UTF-8" ?>
<case>
    <execution>
        <parameters>
            <parameter key="SavePosDouble" value="0" />
            <parameter key="StepAlgorithm" value="1" />
            <parameter key="VerletSteps" value="40" />
            <parameter key="Kernel" value="1" />
            <parameter key="ViscoTreatment" value="1" />
            <parameter key="Visco" value="0.02" />
            <parameter key="DensityDT" value="2" />
            <parameter key="DensityDTvalue" value="0.1" />
            <parameter key="TimeMax" value="{end}" />
            <parameter key="TimeOut" value="{end}" />
            <simulationdomain>
                <posmin x="default" y="default" z="default" />
                <posmax x="default" y="default" z="default + 100%" />
            </simulationdomain>
        </parameters>
        <particles np="{all}" nb="{fixed}" nbf="{fixed}" mkboundfirst="11" mkfluidfirst="1">
            <fixed mkbound="0" mk="11" begin="0" count="{fixed}" />
            <fluid mkfluid="0" mk="1" begin="{fixed}" count="{liquid}" />
        </particles>
        <constants>
            <data2d value="false" />
            <gravity x="0" y="0" z="-{gravity}" />
            <cflnumber value="0.2" />
            <gamma value="7" />
            <rhop0 value="1000" />
            <dp value="{spacing}" />
            <h value="{h}" />
            <b value="{b}" />
            <massbound value="{mass}" />
            <massfluid value="{mass}" />
        </constants>
    </execution>
</case>
"""

SCENE = """title = "Dam break beside a peer"

[box]
size = ["{length} m", "{width} m", "{height} m"]
x = "wall"
y = "wall"
z = ["wall", "open"]

[liquid]
density = "1000 kg/m^3"

[effects.gravity]
acceleration = "{gravity} m/s^2"

[effects.viscosity]
dynamic = "1 mPa s"

[body.column]
block = {{ low = [0, 0, 0], high = ["{width} m", "{width} m", "{width} m"] }}

[pack]
spacing = "{spacing} m"
arrangement = "lattice"

[impact]
end = "{end} s"

[frames]
interval = "{end} s"

[method]
name = "wcsph"

[method.wcsph]
reference_speed = "{speed} m/s"
sound_speed = "constant"
sound_speed_factor = 10
"""


def run(words, **more):
    done = subprocess.run(words, capture_output=True, text=True, **more)
    if done.returncode:
        sys.exit(f"{words[0]} ended with {done.returncode}\n{done.stdout[-3000:]}{done.stderr}")
    return done.stdout


def built(folder):
    """The program, and that which writes its particles."""
    source = os.environ.get("DUALSPHYSICS")
    top = pathlib.Path(source) if source else folder / "DualSPHysics"
    if not top.exists():
        # Under another name until it is whole.
        part = folder / "DualSPHysics.part"
        shutil.rmtree(part, ignore_errors=True)
        run(["git", "clone", "--filter=blob:none", "--no-checkout", REPOSITORY, part])
        run(["git", "checkout", COMMIT, "--", "src/source"], cwd=part)
        part.rename(top)
    code = top / "src" / "source"
    place = top / "bin" / "linux"
    place.mkdir(parents=True, exist_ok=True)
    if not list(place.glob("DualSPHysics*CPU_linux64")):
        run(["make", "-f", "Makefile_cpu", f"-j{os.cpu_count()}", *OPTIONS], cwd=code)
    program = next(place.glob("DualSPHysics*CPU_linux64"))
    writer = folder / "case"
    words = ["g++", "-O1", "-fopenmp", "-std=c++11", f"-I{code}", ROOT / "benches/peers/case.cpp"]
    words += ["-DDISABLE_CHRONO", "-DDISABLE_WAVEGEN", "-DDISABLE_MOORDYNPLUS"]
    run([*words, *(code / f"{name}.cpp" for name in CLASSES), "-o", writer])
    return program.resolve(), writer


def measured(words):
    """Output, CPU seconds and largest memory in bytes of a command."""
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as child:
        text = child.stdout.read()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit(f"{words[0]} ended with {child.returncode}\n{text[-3000:]}")
    return text, usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def peer(folder, program, writer, side, end):
    """Prepares DualSPHysics; what runs it to an instant."""
    h, speed = SMOOTHING * SPACING, 10 * impact_speed(side)
    b = 1000 * speed**2 / 7
    fixed, liquid = map(int, run([writer, folder, *map(str, [side, SPACING, h, b])]).split())
    facts = dict(fixed=fixed, liquid=liquid, all=fixed + liquid, gravity=GRAVITY, spacing=SPACING)
    text = CASE.format(**facts, h=h, b=b, mass=1000 * SPACING**3, end=end)
    (folder / "dam.xml").write_text(text)

    def turn():
        words = [program, folder / "dam", folder / "out", "-cpu", "-ompthreads:1", "-sv:none"]
        text, cpu, memory = measured(words)
        steps = re.search(r"Steps of simulation\.*: ([\d.,']+)", text)
        steps = int(re.sub(r"\D", "", steps[1]))
        version = re.search(r"v(\d+\.\d+\.\d+)", text)[1]
        return {"steps": steps, "cpu": cpu, "memory": memory, "particles": liquid, "of": version}

    return turn


def impact_speed(side):
    """Speed of a fall through the height of the column, m/s."""
    return (2 * GRAVITY * side * SPACING) ** 0.5


def own(folder, preset, side, end):
    """Prepares Coronet; what runs it to an instant."""
    program = os.environ.get("CORONET", ROOT / "target/release/coronet")
    width = side * SPACING
    sizes = dict(length=2 * width, width=width, height=1.5 * width, speed=impact_speed(side))
    scene = folder / f"{preset}.toml"
    scene.write_text(SCENE.format(**sizes, gravity=GRAVITY, spacing=SPACING, end=end))
    store = folder / f"artifacts-{preset}"
    words = [program, "run", scene, "--artifacts", store, "--threads", "1", "--until", "impact"]
    words += ["--set", f"method.preset={preset}", "--json"]
    if preset == "paper":
        # In place of the step of 1 us of the paper: the largest stable one, as the others have.
        words += ["--set", "method.wcsph.time_stepping={adaptive={safety=1}}"]

    def turn():
        shutil.rmtree(store, ignore_errors=True)
        run(words)
        place = store / "latest" / preset / "impact"
        stamp = json.loads(run([program, "show", place, "--json"]))
        state = json.loads(run([program, "show", place / "state.checkpoint", "--json"]))
        count = next(array["length"] for array in state["arrays"] if array["name"] == "id")
        return {
            "steps": state["step"],
            "cpu": stamp["cpu_seconds"],
            "memory": stamp["memory_bytes"],
            "particles": count,
            "stamp": stamp,
        }

    return turn


def main():
    layout = argparse.RawTextHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=layout)
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "target" / "peers")
    parser.add_argument("--side", type=int, default=50, help="particles along the cube (50)")
    parser.add_argument("--end", type=float, default=0.02, help="simulated time, s (0.02)")
    parser.add_argument("--turns", type=int, default=3, help="turns of each (3)")
    options = parser.parse_args()
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    program, writer = built(folder)
    turns = {"DualSPHysics": peer(folder, program, writer, options.side, options.end)}
    for preset in ["paper", "modern"]:
        turns[f"coronet {preset}"] = own(folder, preset, options.side, options.end)
    found = {name: [] for name in turns}
    for _ in range(options.turns):
        for name, turn in turns.items():
            found[name].append(turn())
            facts = {key: found[name][-1][key] for key in ["steps", "cpu", "memory"]}
            print(name, facts, file=sys.stderr, flush=True)
    report(found)


def report(found):
    rows, middle = [], {}
    count = found["DualSPHysics"][0]["particles"]
    for name, turns in found.items():
        rates = [count * turn["steps"] / turn["cpu"] for turn in turns]
        middle[name] = statistics.median(rates), statistics.median(t["cpu"] for t in turns)
        rows += [
            [name, "step", count, 1, f"{middle[name][0] / 1e6:.3f}e6", "particle-steps/s/core"],
            [name, "cpu", count, 1, f"{middle[name][1]:.4g}", "s"],
            [name, "steps", count, 1, turns[0]["steps"], "1"],
            [name, "memory", count, 1, f"{turns[0]['memory'] / count:.0f}", "B/particle"],
        ]
    peer = middle["DualSPHysics"]
    for name, (rate, cpu) in middle.items():
        if name != "DualSPHysics":
            rows.append([name, "rate_over_peer", count, 1, f"{rate / peer[0]:.3g}", "1"])
            rows.append([name, "cpu_of_peer_over_own", count, 1, f"{peer[1] / cpu:.3g}", "1"])
    into = os.environ.get("CORONET_INTO")
    for row in rows:
        print(*row)
    if into:
        stamp = found["coronet paper"][0]["stamp"]
        version = found["DualSPHysics"][0]["of"]
        pathlib.Path(into).write_text(headed(stamp, version, rows))


def asked():
    """The arguments that the figures depend on: not the folder."""
    words = iter(sys.argv[1:])
    kept = []
    for word in words:
        if word == "--folder":
            next(words)
        elif not word.startswith("--folder="):
            kept.append(word)
    return kept


def headed(stamp, version, rows):
    """A table with its origin, as the tables of docs/results need it."""
    here = stamp["machine"]
    part = re.search(r'part\("wcsph", (\d+)\)', (ROOT / "stages/jobs.rs").read_text())[1]
    fetched = "" if "DUALSPHYSICS" in os.environ else f", commit {COMMIT[:12]}"
    head = {
        "version": f"{stamp['program']}; DualSPHysics {version}{fetched}",
        "flow": stamp["version"],
        "parts": f"wcsph {part}",
        "machine": f"{here['processor']}, {here['cores']} cores, {here['system']}",
        "date": stamp["started"][:10],
        "command": " ".join(["benches/peers/dualsphysics.py", *asked()]),
    }
    text = io.StringIO()
    text.writelines(f"# {key}: {value}\n" for key, value in head.items())
    csv.writer(text, lineterminator="\n").writerows([COLUMNS, *rows])
    return text.getvalue()


if __name__ == "__main__":
    main()
