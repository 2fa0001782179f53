//! Measures of one frame and of a run.
//!
//! A frame becomes a raster of the volume fraction, the raster becomes connected regions, and these
//! become numbers; `gauge` selects the numbers of a scene.

pub mod answer;
mod area;
pub mod conservation;
pub mod contact;
pub mod drop;
pub mod ending;
mod energy;
mod force;
mod forest;
pub mod gauge;
pub mod kind;
pub mod lamella;
pub mod layer;
pub mod loss;
pub mod moment;
pub mod norm;
pub mod piece;
pub mod pool;
pub mod raster;
pub mod region;
pub mod series;
pub mod summary;
pub mod tradeoff;
pub mod whole;
