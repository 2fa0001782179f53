//! The pipeline from outside: a toy pipeline through the library, the real one through the binary.

mod fault;
mod keys;
mod program;
mod resume;
mod toy;
