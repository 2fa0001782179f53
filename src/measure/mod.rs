//! What is reported: measures of one frame and of a run, plots, pictures, the report.
//!
//! A frame becomes a raster of the volume fraction, that becomes connected regions, and those
//! become numbers; `gauge` knows which numbers a scene calls for. `post` takes the frames of a run
//! in their order, one at a time, and writes everything.

pub mod raster;
mod area;
pub mod region;
pub mod pool;
pub mod drop;
pub mod gauge;
pub mod series;
pub mod canvas;
pub mod letter;
pub mod plot;
pub mod section;
pub mod view;
pub mod field;
pub mod summary;
pub mod figure;
pub mod report;
pub mod post;
