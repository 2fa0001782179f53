//! What is reported: measures of one frame and of a run, plots, pictures, the report.
//!
//! A frame becomes a raster of the volume fraction, that becomes connected regions, and those
//! become numbers; `gauge` knows which numbers a scene calls for. `post` takes the frames of a run
//! in their order, some side by side, and writes everything.

mod area;
pub mod canvas;
pub mod conservation;
pub mod contact;
pub mod drop;
mod energy;
pub mod field;
pub mod figure;
pub mod gauge;
pub mod lamella;
pub mod letter;
pub mod loss;
pub mod plot;
pub mod pool;
pub mod post;
pub mod raster;
pub mod region;
pub mod report;
pub mod scatter;
pub mod section;
pub mod series;
pub mod summary;
pub mod tradeoff;
pub mod view;
pub mod whole;
