//! Coronet: drop impact with particles. The engine; the program is in `stages/`.
//!
//! Modules in reading order; a module names only modules of its own row or of rows before it:
//! `file | scene space kernel | particle | effect | method | measure record | pipeline simulate`.

pub mod effect;
pub mod file;
pub mod kernel;
pub mod measure;
pub mod method;
pub mod particle;
pub mod pipeline;
pub mod record;
pub mod scene;
pub mod simulate;
pub mod space;
