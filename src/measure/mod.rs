//! What is reported: measures of one frame and of a run.

/// One recorded frame of the liquid, SI units, f32 as in the log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    pub time: f64,
    pub id: Vec<u32>,
    pub body: Vec<u8>,
    pub position: [Vec<f32>; 3],
    pub velocity: [Vec<f32>; 3],
    pub pressure: Vec<f32>,
    pub density: Vec<f32>,
    /// 1 at the free surface, else 0.
    pub surface: Vec<u8>,
}

/// Scalars that the impact computes in f64 while it runs, one per frame, by name with unit suffix
/// (`kinetic_energy_J`, `mass_kg`, `mass_removed_kg`, `time_step_s` ...), in a fixed order.
pub type Scalars = Vec<(String, f64)>;
