//! Tests of the engine, module by module.

mod record_checkpoint;
mod record_damage;
