//! Plots, pictures and the report, from measures and frames.
//!
//! `post` takes the frames of a run in their order, some in parallel, and writes everything.

pub mod canvas;
pub mod field;
pub mod figure;
pub mod film;
pub mod letter;
pub mod plot;
pub mod post;
pub mod render;
pub mod report;
pub mod scatter;
pub mod section;
pub mod surface;
pub mod view;
