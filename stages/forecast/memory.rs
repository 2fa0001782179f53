//! Forecast of memory.

use coronet::scene::{Scene, numbers};

use super::{is_projected, particles, wall_particles};

/// Bytes of the program itself.
pub const BASE: f64 = 3.5e7;
/// Bytes of a particle (WCSPH, projections), of a wall particle and of a cell.
const PARTICLE: [f64; 2] = [1200.0, 2600.0];
const WALL: f64 = 300.0;
const CELL: f64 = 25.0;
/// Most cells along an axis.
const CELLS: f64 = 4096.0;
/// Bytes that rank 0 needs beside for each particle of all at the start and while it gathers a
/// frame.
const WHOLE: f64 = 120.0;

/// Bytes for `count` particles.
pub fn of(scene: &Scene, count: f64) -> f64 {
    BASE + count * PARTICLE[usize::from(is_projected(scene))]
}

/// Bytes for the box of a relaxation or an impact: cells, of half a support, and walls.
pub fn room(scene: &Scene) -> f64 {
    let edge = numbers::smoothing_length(scene);
    let along = |axis: &usize| (scene.domain.size[*axis] / edge).clamp(1.0, CELLS);
    let cells: f64 = scene.dimension.axes().iter().map(along).product();
    cells * CELL + wall_particles(scene) * WALL
}

/// Memory of rank 0 and of each other of `ranks` processes in an impact, bytes: a share of the
/// particles and walls, with those within a support beyond its two faces.
pub fn shared(scene: &Scene, ranks: f64) -> [f64; 2] {
    let count = particles(scene);
    let reach = 2.0 * numbers::smoothing_length(scene);
    let ghosts = (2.0 * reach / scene.domain.size[0]).min(1.0 - 1.0 / ranks);
    let own = of(scene, count * (1.0 / ranks + ghosts));
    let walls = wall_particles(scene) * (1.0 / ranks + ghosts) * WALL;
    let share = own + walls;
    [share + count * WHOLE, share]
}
