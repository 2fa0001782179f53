"""Results of Coronet as tables and arrays, and simulations without files.

    import coronet
    run = coronet.open("artifacts/latest/pipeline")
    run.measures                       # pandas table, one row a frame
    frame = run.frame(at=10e-3)        # numpy arrays: frame.position, frame.velocity ...

All quantities are in SI units; z is up. Times count from the start of the run; the tables have
`time_after_contact_s` as well, not a number before the contact of the drop and where nothing meets.
"""

from __future__ import annotations

import itertools
import json
import os
import shutil
import subprocess
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from . import _core
from ._core import CoronetError, Frame, __version__

__all__ = [
    "Checkpoint",
    "CoronetError",
    "Figure",
    "Frame",
    "Run",
    "Simulated",
    "Store",
    "open",
    "read_checkpoint",
    "read_frames",
    "read_study",
    "run",
    "simulate",
    "__version__",
]

PathLike = str | os.PathLike[str]
#: A number, a text with a unit as in scene files, or a list of these.
Setting = str | float | int | bool | list[Any]


class Figure(NamedTuple):
    """One of the figures that a scene is about, as the largest depth of a crater."""

    name: str
    value: float
    #: SI unit of `value`; "1" for a ratio.
    unit: str
    #: When, s from the start; None for what belongs to the whole run.
    time_s: float | None
    #: When, s from contact.
    time_after_contact_s: float | None


@dataclass(frozen=True)
class Checkpoint:
    """A complete snapshot, as the state at the end of an impact."""

    kind: str
    #: Simulated time, s.
    time: float
    #: Number of time steps done.
    step: int
    scalars: dict[str, float]
    texts: dict[str, str]
    #: Arrays as they are stored, by name: `position_x` in m, `velocity_x` in m/s ...
    arrays: dict[str, np.ndarray]

    @property
    def position(self) -> np.ndarray:
        """Positions, m, shape (n, 3)."""
        return self._vector("position")

    @property
    def velocity(self) -> np.ndarray:
        """Velocities, m/s, shape (n, 3)."""
        return self._vector("velocity")

    def _vector(self, name: str) -> np.ndarray:
        return np.stack([self.arrays[f"{name}_{axis}"] for axis in "xyz"], axis=1)


def read_checkpoint(path: PathLike) -> Checkpoint:
    """Read a checkpoint file.

    Raises OSError if the file cannot be read, CoronetError if its content is wrong.
    """
    return Checkpoint(**_core.read_checkpoint(os.fspath(path)))


def read_frames(path: PathLike) -> Iterator[Frame]:
    """The frames of a log (`frames.mcap`), one after the other.

    Raises OSError if the file cannot be read, CoronetError if its content is wrong.
    """
    return iter(_core.Frames(os.fspath(path)))


def read_study(folder: PathLike) -> dict[str, pd.DataFrame]:
    """The tables of a study, by file name without ending: `study`, `figures`, `promises`.

    `folder` is where `coronet study` has written them. Where a table has an origin (`--into`), its
    lines `# key: value` are in `attrs` of the table. Raises FileNotFoundError if there is none.
    """
    files = sorted(Path(folder).glob("*.csv"))
    if not files:
        raise FileNotFoundError(f"{folder}: no table of a study here")
    return {file.stem: _read_table(file) for file in files}


def _read_table(file: Path) -> pd.DataFrame:
    with file.open(encoding="utf-8") as lines:
        head = list(itertools.takewhile(lambda line: line.startswith("# "), lines))
    table = pd.read_csv(file, skiprows=len(head))
    for line in head:
        key, _, value = line[2:].strip().partition(": ")
        table.attrs[key] = value
    return table


class Run:
    """A finished run: its settings, measures, figures, frames and final state.

    It stays the run that the name meant when it was opened.
    """

    def __init__(self, folder: PathLike):
        """`folder`: the latest results of a name, `artifacts/latest/NAME`."""
        self.folder = Path(folder)
        self.name = self.folder.name
        # Links that another run turns elsewhere.
        self._impact, self._post = ((self.folder / stage).resolve() for stage in ("impact", "post"))
        if not (self._impact / "stamp.json").is_file():
            raise FileNotFoundError(
                f"{self.folder}: no finished impact here; give the folder of a run, as "
                "artifacts/latest/NAME"
            )
        self._info: dict[str, Any] | None = None

    def __repr__(self) -> str:
        return f"<Run {self.folder}>"

    @property
    def log(self) -> Path:
        """The log of the frames, in MCAP."""
        return self._impact / "frames.mcap"

    @property
    def measures(self) -> pd.DataFrame:
        """Measures of all frames: one row a frame, `time_s` and `time_after_contact_s` first."""
        table = pd.read_csv(self._measures())
        if "time_after_contact_s" not in table:
            after = table["time_s"] - self.contact_time
            table.insert(1, "time_after_contact_s", after.where(after >= 0))
        return table

    @property
    def contact_time(self) -> float:
        """When the falling drop meets pool or wall, s from the start; 0 if it never does."""
        return _core.contact(os.fspath(self.log))

    @property
    def figures(self) -> dict[str, Figure]:
        """The figures that the scene is about, by name."""
        found = _core.figures(os.fspath(self.log), os.fspath(self._measures()))
        return {figure[0]: Figure(*figure) for figure in found}

    @property
    def settings(self) -> dict[str, str]:
        """All settings that the impact depends on, by name, with their units."""
        stamp = json.loads((self._impact / "stamp.json").read_text("utf-8"))
        return {setting["name"]: setting["value"] for setting in stamp["settings"]}

    @property
    def scene(self) -> str:
        """Text of the scene file."""
        return self.info["scene"]

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies; `Frame.body` are indices into it."""
        return self.info["bodies"]

    @property
    def spacing(self) -> float:
        """Distance between particles, m."""
        return self.info["spacing"]

    @property
    def info(self) -> dict[str, Any]:
        """Facts of the log: bodies, spacing, dimension, scene, provenance."""
        if self._info is None:
            self._info = _core.log_info(os.fspath(self.log))
        return self._info

    @property
    def times(self) -> np.ndarray:
        """Times of all frames, s, shape (frames,)."""
        return pd.read_csv(self._measures(), usecols=["time_s"])["time_s"].to_numpy()

    def frames(self, every: int = 1) -> Iterator[Frame]:
        """All frames, or every n-th, in order of time."""
        if every < 1:
            raise ValueError(f"every = {every}: give 1 or more")
        for number, frame in enumerate(read_frames(self.log)):
            if number % every == 0:
                yield frame

    def frame(self, at: float) -> Frame:
        """The frame nearest to a time, s from the start.

        Raises ValueError if the time is outside the run.
        """
        times = self.times
        room = 0.5 * float(np.diff(times).max(initial=0.0)) + 1e-12
        if not times[0] - room <= at <= times[-1] + room:
            raise ValueError(
                f"at = {at} s is outside the run: its frames are from {times[0]} to {times[-1]} s"
            )
        wanted = int(np.abs(times - at).argmin())
        for number, frame in enumerate(read_frames(self.log)):
            if number == wanted:
                return frame
        raise CoronetError(f"{self.log}: fewer frames than rows in measures.csv")

    def state(self) -> Checkpoint:
        """All that the solver had at the end of the impact, in double precision."""
        return read_checkpoint(self._impact / "state.checkpoint")

    def _measures(self) -> Path:
        path = self._post / "measures.csv"
        if not path.is_file():
            raise FileNotFoundError(
                f"{path}: not evaluated yet; finish it with `coronet run` and open it again"
            )
        return path


class Store:
    """A folder of results."""

    def __init__(self, folder: PathLike = "artifacts"):
        self.folder = Path(folder)
        if not (self.folder / "store.json").is_file():
            raise FileNotFoundError(f"{self.folder}: not a store of Coronet (no store.json in it)")

    def __repr__(self) -> str:
        return f"<Store {self.folder}>"

    @property
    def names(self) -> list[str]:
        """Names of all finished runs."""
        latest = self.folder / "latest"
        manifests = latest.glob("**/manifest.json")
        found = (path.parent for path in manifests)
        return sorted(str(f.relative_to(latest)) for f in found if (f / "impact").is_dir())

    def run(self, name: str) -> Run:
        """The run of a name. Raises KeyError if there is none."""
        if name not in self.names:
            raise KeyError(f"no run {name!r} in {self.folder}; there are: {', '.join(self.names)}")
        return Run(self.folder / "latest" / name)

    def __iter__(self) -> Iterator[Run]:
        return (self.run(name) for name in self.names)


def open(folder: PathLike) -> Run:  # noqa: A001 - as in `coronet.open`
    """Open a run: the folder `artifacts/latest/NAME`."""
    return Run(folder)


def _sets(settings: Mapping[str, Setting]) -> list[str]:
    """Settings as the program takes them: `key=value` in TOML."""

    def text(value: Any) -> str:
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(text(each) for each in value) + "]"
        if isinstance(value, str):
            return json.dumps(value, ensure_ascii=False)
        return repr(float(value)) if isinstance(value, float) else str(value)

    return [f"{key}={text(value)}" for key, value in settings.items()]


def run(
    scene: PathLike,
    settings: Mapping[str, Setting] | None = None,
    *,
    artifacts: PathLike = "artifacts",
    name: str | None = None,
    program: PathLike | None = None,
    threads: int | None = None,
) -> Run:
    """Run a scene file by the program `coronet`, as on the command line, and open the results.

    What was computed before is reused, and an interrupted run continues. `settings` override those
    of the file: `{"pack.spacing": "0.25 mm"}`. `program` is the path of the program if it is not
    found as `coronet`. Its warnings are those of Python. Raises CoronetError with the message of the
    program if it fails. If this process ends, the program stops after its next checkpoint.
    """
    found = program or os.environ.get("CORONET") or shutil.which("coronet")
    if found is None:
        raise FileNotFoundError("there is no program `coronet` on the path; give program=...")
    command = [os.fspath(found), "run", os.fspath(scene), "--json", "--stop-at-end-of-input"]
    command += ["--artifacts", os.fspath(artifacts)]
    for each in _sets(settings or {}):
        command += ["--set", each]
    if name is not None:
        command += ["--name", name]
    if threads is not None:
        command += ["--threads", str(threads)]
    # Nothing is ever written; its end is that of this process.
    reader, writer = os.pipe()
    try:
        ended = subprocess.run(command, stdin=reader, capture_output=True, encoding="utf-8")
    finally:
        os.close(reader)
        os.close(writer)
    if ended.returncode != 0:
        raise CoronetError(ended.stderr.strip() or f"coronet ended with {ended.returncode}")
    summary = json.loads(ended.stdout.splitlines()[-1])
    for warning in summary["warnings"]:
        warnings.warn(warning, stacklevel=2)
    # The name without the settings is that of the newest run.
    return Run(Path(summary["artifacts"], "latest", summary["name"]))


@dataclass(frozen=True)
class Simulated:
    """What a simulation gave."""

    #: One row a frame.
    measures: pd.DataFrame
    figures: dict[str, Figure]


def simulate(
    scene: PathLike | None = None,
    settings: Mapping[str, Setting] | None = None,
    *,
    text: str | None = None,
    each: Callable[[Frame, dict[str, float]], Any] | None = None,
) -> Simulated:
    """Simulate a scene in this process, without files; the results are those of the program.

    Give the path of a scene file or the `text` of one. `each` is called with every frame and its
    measures; if it returns False, the simulation stops. Raises CoronetError with line, key, value
    and remedy for a wrong scene, and for a simulation that diverges.
    """
    if (scene is None) == (text is None):
        raise ValueError("give either the path of a scene file or the text of one")
    path = None if scene is None else os.fspath(scene)
    columns, figures = _core.simulate_scene(path, text, _sets(settings or {}), each)
    found = {figure[0]: Figure(*figure) for figure in figures}
    return Simulated(pd.DataFrame(dict(columns)), found)
