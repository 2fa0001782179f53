//! Rings: particles of the half-plane beside an axis of revolution.

use std::f32::consts::TAU;

use super::Frame;

/// Distances from the axis, in spacings, of the first columns of a lattice at rest, and their
/// masses over those of the annuli of the lattice. Least squares: with Wendland C2, h = 1.5
/// spacings, kernel sums are equal to 0.03 %, and their gradients vanish to 0.25 % of 1 / h, at the
/// axis as elsewhere. Rings in the middle of their annuli have sums that are 6 % too large.
const COLUMNS: [[f64; 2]; 3] = [[0.698, 1.227], [1.577, 0.9405], [2.5099, 0.9745]];

/// How near to a column of the lattice a ring counts as in it, in spacings.
const ALIKE: f64 = 1e-6;

/// The mass of a ring at `radius` m whose area is that of a lattice cell, over that of a cube with
/// an edge of `spacing` m and its density. What is in a column of a lattice, which are `pitch` m
/// apart, goes where it is at rest.
pub fn settle(radius: &mut f64, pitch: f64, spacing: f64) -> f64 {
    let place = *radius / pitch;
    let annulus = std::f64::consts::TAU * (*radius / spacing).abs();
    let column = COLUMNS.iter().enumerate().find(|(k, _)| {
        let middle = *k as f64 + 0.5;
        (place - middle).abs() < ALIKE
    });
    match column {
        Some((_, [at, mass])) => {
            *radius = at * pitch;
            mass * annulus
        }
        None => annulus,
    }
}

/// Part of a turn by which rings that follow each other start apart: their points form no rows.
const GOLDEN: f32 = 0.618_034;

/// The rings of a frame as points about the axis, x = y = 0: `count` of each, at equal angles. They
/// have the identity of their ring and share its mass.
pub fn points(frame: &Frame, mut count: impl FnMut(usize) -> usize) -> Frame {
    let mut points = Frame {
        time: frame.time,
        scalars: frame.scalars.clone(),
        ..Frame::default()
    };
    for i in 0..frame.id.len() {
        let count = count(i);
        for k in 0..count {
            let start = (GOLDEN * i as f32).fract();
            let (sin, cos) = (TAU * (k as f32 + start) / count as f32).sin_cos();
            let turn = |from: &[Vec<f32>; 3], to: &mut [Vec<f32>; 3]| {
                let [x, y, z] = [0, 1, 2].map(|a| from[a][i]);
                let turned = [x * cos - y * sin, x * sin + y * cos, z];
                to.iter_mut().zip(turned).for_each(|(to, c)| to.push(c));
            };
            turn(&frame.position, &mut points.position);
            turn(&frame.velocity, &mut points.velocity);
            points.id.push(frame.id[i]);
            points.body.push(frame.body[i]);
            points.pressure.push(frame.pressure[i]);
            points.density.push(frame.density[i]);
            points.surface.push(frame.surface[i]);
            points.mass.push(frame.mass[i] / count as f32);
        }
    }
    points
}

/// Number of points a spacing apart on a ring at `radius`, both m; at least one.
pub fn point_count(radius: f32, spacing: f32) -> usize {
    ((TAU * radius / spacing).round() as usize).max(1)
}
