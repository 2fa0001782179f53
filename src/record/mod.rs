//! What is kept: checkpoints, the log of frames, exports.
//!
//! | module | what |
//! |---|---|
//! | [`digest`] | SHA-256 names of contents |
//! | [`atomic`] | files that appear whole or not at all |
//! | [`checkpoint`] | verified, compressed snapshots that stages exchange |

pub mod atomic;
pub mod checkpoint;
pub mod digest;

pub use checkpoint::{Array, Checkpoint, CheckpointError};
pub use digest::Digest;
