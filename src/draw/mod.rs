//! Plots, pictures and the report, from measures and frames.
//!
//! `post` takes the frames of a run in their order, some in parallel, and writes everything.

pub mod canvas;
pub mod field;
pub mod figure;
pub mod film;
pub mod player;
pub mod plot;
pub mod post;
pub mod readable;
pub mod render;
pub mod report;
pub mod scale;
pub mod scatter;
pub mod section;
pub mod sheet;
pub mod surface;

/// 0 below `low`, 1 above `high`, smooth between.
fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
