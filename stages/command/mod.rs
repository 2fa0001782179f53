//! The commands: one in each file.

pub mod completions;
pub mod diff;
pub mod export;
pub mod gc;
pub mod init;
pub mod list;
pub mod man;
pub mod place;
pub mod plan;
pub mod recover;
mod rest;
pub mod run;
pub mod schema;
pub mod show;
pub mod status;
pub mod study;
pub mod tune;
pub mod verify;
