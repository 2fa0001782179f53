//! The pipeline from outside: a toy pipeline through the library, the real one through the binary.

#[cfg(unix)]
mod batch;
mod cleanup;
mod content;
mod damage;
#[cfg(target_os = "linux")]
mod disk;
#[cfg(target_os = "linux")]
mod edge;
mod export;
mod fault;
mod figures;
mod golden;
#[cfg(unix)]
mod hyperqueue;
mod inspect;
mod keys;
mod laboratory;
mod library;
mod names;
#[cfg(unix)]
mod points;
mod program;
mod promise;
#[cfg(unix)]
mod push;
mod remote;
mod render;
mod resume;
mod rings;
mod runs;
mod schema;
mod sharing;
mod shown;
mod stop;
mod study;
mod sweep;
mod toy;
mod truth;
mod tune;
