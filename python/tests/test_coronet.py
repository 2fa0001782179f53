"""The package against a run of the program: `python/check` runs these."""

import fcntl
import os
import subprocess
import sys
import time
from pathlib import Path

import coronet
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
TINY = ROOT / "scenes" / "tiny.toml"
PROGRAM = os.environ.get("CORONET", str(ROOT / "target" / "release" / "coronet"))
SHORT = {"impact.end": "3 ms"}


@pytest.fixture(scope="session")
def store(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "artifacts"
    coronet.run(TINY, SHORT, artifacts=folder, program=PROGRAM)
    faster = {**SHORT, "body.drop.velocity": "1.2 m/s"}
    coronet.run(TINY, faster, artifacts=folder, name="loop/fast", program=PROGRAM)
    return coronet.Store(folder)


@pytest.fixture(scope="session")
def run(store):
    return store.run("tiny")


def test_a_store_lists_its_runs(store):
    assert {"tiny", "loop/fast"} <= set(store.names)
    assert [each.folder.name for each in store].count("fast") == 1
    with pytest.raises(KeyError, match="loop/fast"):
        store.run("none")
    with pytest.raises(FileNotFoundError, match="not a store"):
        coronet.Store(store.folder / "latest")
    with pytest.raises(FileNotFoundError, match="artifacts/latest/NAME"):
        coronet.open(store.folder)


def test_a_run_stays_what_it_was_and_warns(tmp_path):
    with pytest.warns(UserWarning, match="No panel at 6.0 ms"):
        coronet.run(TINY, SHORT, artifacts=tmp_path, program=PROGRAM)
    first = coronet.open(tmp_path / "latest" / "tiny")
    speed = first.settings["body.drop.velocity"]
    faster = {**SHORT, "body.drop.velocity": "1.3 m/s"}
    second = coronet.run(TINY, faster, artifacts=tmp_path, program=PROGRAM)
    assert first.settings["body.drop.velocity"] == speed != second.settings["body.drop.velocity"]
    assert not first.measures.equals(second.measures)


def test_a_program_ends_with_its_caller(tmp_path):
    call = f"import coronet; coronet.run({str(TINY)!r}, {{'impact.end': '10 s'}}, "
    call += f"artifacts={str(tmp_path)!r}, program={PROGRAM!r})"
    caller = subprocess.Popen([sys.executable, "-c", call])
    work = tmp_path / "impact"
    wait_for(lambda: any(work.glob("*/work/*.checkpoint")))
    (lock,) = work.glob("*/lock")
    caller.kill()
    caller.wait()
    with open(lock, "a") as file:
        wait_for(lambda: is_free(file))


def is_free(file):
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def wait_for(what):
    end = time.monotonic() + 60
    while not what():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_measures_are_a_table(run):
    table = run.measures
    assert list(table.columns[:2]) == ["time_s", "time_after_contact_s"]
    assert len(table) == len(run.times) > 5
    # It falls 0.4 mm from 1.5 m/s.
    contact = ((1.5**2 + 2 * 9.81 * 0.4e-3) ** 0.5 - 1.5) / 9.81
    assert run.contact_time == pytest.approx(contact)
    is_before = table["time_s"] < contact
    assert is_before.any() and table["time_after_contact_s"].isna().equals(is_before)
    shift = (table["time_s"] - table["time_after_contact_s"]).dropna().to_numpy()
    assert shift == pytest.approx(contact)


def test_figures_are_those_of_the_program(run):
    ended = subprocess.run(
        [PROGRAM, "show", str(run.folder / "post"), "--json"], capture_output=True, check=True
    )
    depth = run.figures["largest crater depth"]
    assert f'"value":{depth.value!r}'.encode() in ended.stdout.replace(b" ", b"")
    assert depth.unit == "m"
    assert depth.value == run.measures["crater_depth_m"].max()
    assert depth.time_s - depth.time_after_contact_s == pytest.approx(run.contact_time)


def test_settings_and_scene(run):
    assert run.settings["body.pool.layer.depth"] == "2 mm"
    assert "[body.pool]" in run.scene
    assert set(run.bodies) == {"pool", "drop"}
    assert run.settings["pack.spacing"] == f"{1e3 * run.spacing:g} mm"


def test_frames_are_arrays(run):
    frames = list(run.frames())
    assert [frame.time for frame in frames] == pytest.approx(list(run.times))
    assert [frame.time for frame in run.frames(every=2)] == [f.time for f in frames[::2]]
    frame = run.frame(at=1e-3)
    assert abs(frame.time - 1e-3) == np.abs(run.times - 1e-3).min()
    count = len(frame)
    for vector in (frame.position, frame.velocity):
        assert vector.shape == (count, 3) and vector.dtype == np.float32
    for values in (frame.pressure, frame.density, frame.id, frame.body, frame.is_surface):
        assert values.shape == (count,)
    assert 0 < frame.is_surface.mean() < 1
    assert np.all(np.diff(frame.id.astype(int)) > 0)
    # Measures of the table from the arrays.
    energy = 0.5 * frame.particle_mass * (frame.velocity.astype(float) ** 2).sum()
    row = run.measures.iloc[np.abs(run.times - 1e-3).argmin()]
    assert energy == pytest.approx(row["kinetic_energy_J"], rel=1e-4)
    with pytest.raises(ValueError, match="outside the run"):
        run.frame(at=1)


def test_an_export_for_numpy_is_what_the_log_holds(run, tmp_path):
    export = [PROGRAM, "export", str(run.folder), "--to", "npz", "--output", str(tmp_path)]
    subprocess.run([*export, "--at", "1 ms"], capture_output=True, check=True)
    frame = run.frame(at=1e-3)
    with np.load(tmp_path / "frame-00000.npz") as arrays:
        assert arrays["time_s"].shape == () and arrays["time_s"] == frame.time
        for name in ("position", "velocity", "pressure", "density", "id", "body"):
            assert np.array_equal(arrays[name], getattr(frame, name)), name
        assert arrays["mass"].sum() == pytest.approx(frame.scalars["mass_kg"], rel=1e-5)
        volume = 4 / 3 * np.pi * arrays["radius"].astype(float) ** 3
        assert volume == pytest.approx(arrays["mass"] / arrays["density"], rel=1e-5)
    subprocess.run([*export, "--body", "drop"], capture_output=True, check=True)
    with np.load(tmp_path / "frame-00003.npz") as arrays:
        assert {run.bodies[body] for body in arrays["body"]} == {"drop"}


def test_the_final_state_is_that_of_the_last_frame(run):
    state, last = run.state(), list(run.frames())[-1]
    assert state.step > 0 and state.time >= last.time
    assert state.position.shape == (len(last), 3) and state.position.dtype == np.float64
    order = np.argsort(state.arrays["id"])
    if state.time == last.time:
        assert state.position[order] == pytest.approx(last.position, abs=1e-8)


def test_a_run_stays_what_it_is_when_the_scene_runs_again(tmp_path):
    def go(end):
        return coronet.run(TINY, {"impact.end": end}, artifacts=tmp_path, program=PROGRAM)

    first, second = go("0.4 ms"), go("0.6 ms")
    assert first.settings["impact.end"] == "400 us"
    assert second.settings["impact.end"] == "600 us"


def test_damage_and_absence_are_told_apart(run, tmp_path):
    with pytest.raises(OSError, match="none.mcap"):
        list(coronet.read_frames(tmp_path / "none.mcap"))
    with pytest.raises(OSError, match="none.checkpoint"):
        coronet.read_checkpoint(tmp_path / "none.checkpoint")
    whole = run.log.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) // 2])
    frames = coronet.read_frames(cut)
    with pytest.raises(coronet.CoronetError, match="cut off or damaged"):
        seen = 0
        for _ in frames:
            seen += 1
    assert seen < len(run.times)
    bad = tmp_path / "bad.checkpoint"
    content = bytearray((run.folder / "impact" / "state.checkpoint").read_bytes())
    content[len(content) // 2] ^= 1
    bad.write_bytes(content)
    with pytest.raises(coronet.CoronetError, match="bad.checkpoint"):
        coronet.read_checkpoint(bad)


def test_a_simulation_without_files_gives_what_the_program_gives(run):
    frames = []
    found = coronet.simulate(TINY, SHORT, each=lambda frame, row: frames.append((frame, row)))
    assert len(frames) == len(run.times)
    assert np.array_equal(frames[-1][0].position, list(run.frames())[-1].position)
    depth = found.measures["crater_depth_m"].max()
    assert depth == run.figures["largest crater depth"].value
    assert found.figures["largest crater depth"] == run.figures["largest crater depth"]


def test_a_simulation_can_be_stopped():
    seen = []

    def each(frame, row):
        seen.append(row["time_s"])
        return len(seen) < 3

    found = coronet.simulate(TINY, SHORT, each=each)
    assert len(found.measures) == 3 and seen == list(found.measures["time_s"])

    def fails(frame, row):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        coronet.simulate(TINY, SHORT, each=fails)


def test_mistakes_of_a_scene_are_all_told():
    with pytest.raises(coronet.CoronetError) as told:
        coronet.simulate(TINY, {"pack.spacing": "0.1 s", "impact.ent": "1 ms"})
    assert "pack.spacing" in str(told.value) and "`impact.end`" in str(told.value)
    with pytest.raises(coronet.CoronetError, match="impact.ent"):
        coronet.run(TINY, {"impact.ent": "1 ms"}, program=PROGRAM)
    with pytest.raises(ValueError, match="either"):
        coronet.simulate()


def test_a_study_is_read(tmp_path):
    with pytest.raises(FileNotFoundError, match="no table"):
        coronet.read_study(tmp_path)
    tables = coronet.read_study(ROOT / "docs" / "results" / "data")
    assert tables and all(len(table) for table in tables.values())
    angles = tables["contact-angle"]
    assert angles.attrs["command"] == "coronet study scenes/study/contact-angle.toml"
    assert angles["by circle"].between(20, 165).all()
