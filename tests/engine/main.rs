//! Tests of the engine, module by module.

mod measure_drop;
mod measure_pool;
mod measure_post;
mod measure_series;
mod measure_splash;
mod pack_completion;
mod pack_lattice;
mod pack_poisson;
mod pack_scene;
mod record_background;
mod record_checkpoint;
mod record_damage;
mod record_export;
mod record_log;
mod record_reader;
mod scene_error;
mod scene_file;
mod scene_key;
mod scene_number;
mod scene_quantity;
mod scene_schema;
