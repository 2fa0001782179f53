//! Rings: particles of the half-plane beside an axis of revolution.

/// Distances from the axis, in spacings, of the first columns of a lattice at rest, and their
/// masses over those of the annuli of the lattice. Least squares: with Wendland C2, h = 1.5
/// spacings, kernel sums are equal to 0.03 %, and their gradients vanish to 0.25 % of 1 / h, at the
/// axis as elsewhere. Rings in the middle of their annuli have sums that are 6 % too large.
const COLUMNS: [[f64; 2]; 3] = [[0.698, 1.227], [1.577, 0.9405], [2.5099, 0.9745]];

/// How near to a column of the lattice a ring counts as in it, in spacings.
const ALIKE: f64 = 1e-6;

/// The mass of a ring at `radius` m whose area is that of a lattice cell, over that of a cube with
/// this edge and density. What is in a column of a lattice goes where it is at rest.
pub fn settle(radius: &mut f64, spacing: f64) -> f64 {
    let place = *radius / spacing;
    let annulus = std::f64::consts::TAU * place.abs();
    let column = COLUMNS.iter().enumerate().find(|(k, _)| {
        let middle = *k as f64 + 0.5;
        (place - middle).abs() < ALIKE
    });
    match column {
        Some((_, [at, mass])) => {
            *radius = at * spacing;
            mass * annulus
        }
        None => annulus,
    }
}
