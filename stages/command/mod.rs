//! The commands: one in each file.

pub mod completions;
pub mod diff;
pub mod export;
mod footage;
pub mod gc;
pub mod init;
pub mod list;
pub mod man;
pub mod place;
pub mod plan;
pub mod push;
pub mod recover;
pub mod render;
mod rest;
pub mod run;
pub mod schema;
pub mod show;
pub mod status;
pub mod study;
pub mod tune;
pub mod verify;
