//! The commands: one in each file.

pub mod completions;
pub mod export;
pub mod gc;
pub mod man;
mod place;
pub mod plan;
pub mod recover;
pub mod run;
pub mod schema;
pub mod show;
pub mod study;
pub mod tune;
pub mod verify;
