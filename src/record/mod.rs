//! Files of results: checkpoints, the log of frames, exports.
//!
//! | module | what |
//! |---|---|
//! | [`digest`] | SHA-256 digests of contents |
//! | [`atomic`] | atomic replacement of files |
//! | [`checkpoint`] | verified, compressed snapshots that stages exchange |
//! | [`log`] | frames over time, as MCAP for standard viewers |
//! | [`background`] | checkpoints that are written while the solver continues |
//! | [`layout`] | a layout file for viewers of the log |
//! | [`export`] | checkpoints and logs as VTK, CSV, PLY |
//! | [`mark`] | the mark by which the program knows its own pictures and meshes |
//! | [`mesh`] | triangles as PLY, OBJ, glTF, VTP |

pub mod atomic;
pub mod background;
pub mod checkpoint;
pub mod digest;
pub mod export;
pub mod layout;
pub mod log;
pub mod mark;
pub mod mesh;

pub use checkpoint::{Array, Checkpoint, CheckpointError};
pub use digest::Digest;
