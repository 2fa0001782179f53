//! What is kept: checkpoints, the log of frames, exports.
//!
//! | module | what |
//! |---|---|
//! | [`digest`] | SHA-256 names of contents |
//! | [`atomic`] | files that appear whole or not at all |
//! | [`checkpoint`] | verified, compressed snapshots that stages exchange |
//! | [`log`] | frames over time, as MCAP that stock viewers show |
//! | [`background`] | checkpoints written while the solver goes on |
//! | [`layout`] | a layout file for viewers of the log |
//! | [`export`] | checkpoints and logs as VTK, CSV, PLY |

pub mod atomic;
pub mod background;
pub mod checkpoint;
pub mod digest;
pub mod export;
pub mod layout;
pub mod log;

pub use checkpoint::{Array, Checkpoint, CheckpointError};
pub use digest::Digest;
