"""What the engine gives; use the functions of `coronet`."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

__version__: str

_Figure = tuple[str, float, str, float | None, float | None]

class CoronetError(ValueError):
    """A scene, a result or a simulation that is wrong."""

class Frame:
    """One frame of the liquid, SI units; particles sorted by `id`."""

    @property
    def time(self) -> float:
        """Simulated time, s."""
    @property
    def scalars(self) -> dict[str, float]:
        """Scalars of the frame by name, each with its unit."""
    @property
    def id(self) -> NDArray[np.uint32]:
        """Identities, shape (n,)."""
    @property
    def body(self) -> NDArray[np.uint8]:
        """Indices of bodies, shape (n,)."""
    @property
    def position(self) -> NDArray[np.float32]:
        """Positions, m, shape (n, 3)."""
    @property
    def velocity(self) -> NDArray[np.float32]:
        """Velocities, m/s, shape (n, 3)."""
    @property
    def pressure(self) -> NDArray[np.float32]:
        """Pressures, Pa, shape (n,)."""
    @property
    def density(self) -> NDArray[np.float32]:
        """Densities, kg/m^3, shape (n,)."""
    @property
    def is_surface(self) -> NDArray[np.bool_]:
        """Whether particles are at the free surface, shape (n,)."""
    @property
    def mass(self) -> NDArray[np.float32] | None:
        """Masses of rings, kg, shape (n,); None where all particles have `particle_mass`."""
    @property
    def particle_mass(self) -> float | None:
        """Mass of each particle, kg; None of rings, which have a `mass` each."""
    def __len__(self) -> int: ...

class Frames(Iterator[Frame]):
    def __init__(self, path: str) -> None: ...
    def __iter__(self) -> Frames: ...
    def __next__(self) -> Frame: ...

def log_info(path: str) -> dict[str, Any]: ...
def read_checkpoint(path: str) -> dict[str, Any]: ...
def figures(log: str, measures: str) -> list[_Figure]: ...
def contact(log: str) -> float: ...
def simulate_scene(
    path: str | None,
    text: str | None,
    sets: list[str],
    each: Callable[[Frame, dict[str, float]], Any] | None,
) -> tuple[list[tuple[str, list[float]]], list[_Figure]]: ...
