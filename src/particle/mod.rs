//! What moves: arrays of particles.

/// Liquid particles, structure of arrays, SI units, length `len()` each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// Stable identity: index at packing, body after body.
    pub id: Vec<u32>,
    /// Index into `Scene::bodies`.
    pub body: Vec<u8>,
    /// x, y, z, m.
    pub position: [Vec<f64>; 3],
    /// m/s.
    pub velocity: [Vec<f64>; 3],
    /// kg/m^3.
    pub density: Vec<f64>,
    /// Mass of one particle (all equal), kg (kg/m in 2-D).
    pub mass: f64,
}

impl Particles {
    pub fn len(&self) -> usize {
        self.id.len()
    }

    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }
}

/// Fixed wall particles: positions, m, and prescribed velocities, m/s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wall {
    pub position: [Vec<f64>; 3],
    pub velocity: [Vec<f64>; 3],
}
