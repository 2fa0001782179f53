//! What the log shows of a solver.

use crate::particle::{Frame, Particles};

/// Per-particle fields that only the solver knows.
pub struct Fields<'a> {
    /// Pa, by particle index.
    pub pressure: &'a (dyn Fn(usize) -> f64 + Sync),
    /// Whether the particle is at the free surface.
    pub surface: &'a (dyn Fn(usize) -> bool + Sync),
}

/// A frame of `particles`, sorted by id.
pub fn of(time: f64, p: &Particles, fields: &Fields, scalars: Vec<(String, f64)>) -> Frame {
    let mut order: Vec<u32> = (0..p.len() as u32).collect();
    order.sort_unstable_by_key(|&i| p.id[i as usize]);
    let narrow = |v: &Vec<f64>| {
        order
            .iter()
            .map(|&i| v[i as usize] as f32)
            .collect::<Vec<f32>>()
    };
    Frame {
        time,
        id: order.iter().map(|&i| p.id[i as usize]).collect(),
        body: order.iter().map(|&i| p.body[i as usize]).collect(),
        position: [
            narrow(&p.position[0]),
            narrow(&p.position[1]),
            narrow(&p.position[2]),
        ],
        velocity: [
            narrow(&p.velocity[0]),
            narrow(&p.velocity[1]),
            narrow(&p.velocity[2]),
        ],
        pressure: order
            .iter()
            .map(|&i| (fields.pressure)(i as usize) as f32)
            .collect(),
        density: narrow(&p.density),
        surface: order
            .iter()
            .map(|&i| (fields.surface)(i as usize) as u8)
            .collect(),
        scalars,
    }
}
