"""A run in the viewer Rerun: the liquid upright, its figures and measures plotted.

    python -m coronet.rerun artifacts/latest/pipeline             # opens the viewer
    python -m coronet.rerun artifacts/latest/pipeline --save run.rrd

Needs the package `rerun-sdk`, as in `pip install "./python[rerun]"`. A recording holds its layout (a
blueprint); Rerun applies none that lies beside an MCAP file.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterable

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from . import Frame, PathLike, Run
from . import open as open_run

#: Name of the time line: seconds from the start of the run.
TIMELINE = "time"
#: Units of measures by the end of their name; of several that fit the first.
UNITS = {
    "kg_m_s": "kg m/s",
    "m_s": "m/s",
    "m2": "m^2",
    "m": "m",
    "s": "s",
    "Pa": "Pa",
    "N": "N",
    "J": "J",
    "kg": "kg",
    "deg": "deg",
}
#: Colours of bodies, which are distinguishable for the colour-blind (Okabe & Ito 2008).
COLOURS = np.array([[86, 180, 233], [230, 159, 0], [0, 158, 115], [204, 121, 167]], dtype=np.uint8)


def _points(frame: Frame, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions, m, shape (n, 3), and bodies; rings of the surface become circles of points."""
    position, body = frame.position, frame.body
    if frame.mass is None:
        return position, body
    outer = frame.is_surface
    radius, height = position[outer, 0], position[outer, 2]
    count = np.maximum(1, np.round(2 * np.pi * radius / spacing)).astype(int)
    ring = np.repeat(np.arange(len(radius)), count)
    first = np.repeat(np.cumsum(count) - count, count)
    angle = 2 * np.pi * (np.arange(len(ring)) - first) / count[ring]
    turned = [radius[ring] * np.cos(angle), radius[ring] * np.sin(angle), height[ring]]
    return np.stack(turned, axis=1), body[outer][ring]


def _plots(columns: Iterable[str]) -> list[rrb.TimeSeriesView]:
    """A plot for each unit, which is the end of the name of a column."""
    units: dict[str, list[str]] = {}
    for column in columns:
        ends = (unit for end, unit in UNITS.items() if column.endswith(f"_{end}"))
        units.setdefault(next(ends, "without unit"), []).append(column)
    return [
        rrb.TimeSeriesView(name=unit, contents=[f"/measures/{c}" for c in columns])
        for unit, columns in units.items()
    ]


def log(run: Run) -> None:
    """Log all frames and measures of a run to the present recording of Rerun."""
    rr.log("liquid", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    radius = 0.6 * run.spacing
    for frame in run.frames():
        rr.set_time(TIMELINE, duration=frame.time)
        position, body = _points(frame, run.spacing)
        for number, name in enumerate(run.bodies):
            own = body == number
            colour = COLOURS[number % len(COLOURS)]
            rr.log(f"liquid/{name}", rr.Points3D(position[own], colors=colour, radii=radius))
    table = run.measures
    columns = [c for c in table.columns if c not in ("time_s", "time_after_contact_s")]
    for column in columns:
        known = table[column].notna()
        rr.send_columns(
            f"measures/{column}",
            indexes=[rr.TimeColumn(TIMELINE, duration=table["time_s"][known])],
            columns=rr.Scalars.columns(scalars=table[column][known]),
        )
    view = rrb.Spatial3DView(origin="liquid", name=run.name)
    plots = rrb.Tabs(*_plots(columns))
    rr.send_blueprint(rrb.Blueprint(rrb.Horizontal(view, plots, column_shares=[3, 2])))


def save(run: Run, path: PathLike) -> None:
    """Write a run as a recording of Rerun (`.rrd`)."""
    with rr.RecordingStream("coronet") as recording:
        recording.save(os.fspath(path))
        log(run)
        # What waits in batches is lost with the recording.
        recording.flush()


def show(run: Run) -> None:
    """Open a run in the viewer."""
    with rr.RecordingStream("coronet") as recording:
        recording.spawn()
        log(run)
        recording.flush()


def main() -> None:
    """`python -m coronet.rerun`."""
    parser = argparse.ArgumentParser(description="Show a run in Rerun.")
    parser.add_argument("run", help="folder of a run, as artifacts/latest/NAME")
    parser.add_argument("--save", metavar="FILE", help="write a recording in place of a viewer")
    arguments = parser.parse_args()
    run = open_run(arguments.run)
    if arguments.save is None:
        show(run)
    else:
        save(run, arguments.save)


if __name__ == "__main__":
    main()
