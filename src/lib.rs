//! Coronet: drop impact with particles. This library is the engine; the program that calls it is in
//! `stages/`.
//!
//! # How a scene becomes results
//!
//! 1. [`scene::file`] reads a scene file into a [`scene::Scene`]: SI units, defaults and the preset
//!    of the method filled in, all mistakes found. Its [`scene::Problem`] is all that a solver
//!    reads.
//! 2. [`particle::pack`] fills each body with particles; [`method::build`] makes a solver on them.
//!    A body first relaxes alone, at rest ([`scene::Problem::resting`]); then all bodies meet.
//! 3. A solver steps ([`method::Solver`]). In every step it finds neighbours ([`space`]), sums over
//!    pairs ([`space::sweep`]), adds the effects that the scene has ([`effect`]), and moves.
//! 4. At intervals a [`particle::Frame`] goes to the log ([`record::log`]), and a
//!    [`particle::State`] to a checkpoint ([`record::checkpoint`]).
//! 5. [`measure`] turns frames into numbers, [`draw`] turns both into plots, pictures and a report.
//! 6. [`pipeline`] runs these stages, each only if what it reads has changed: the key of a result
//!    is the hash of the input of its stage ([`scene::input`]).
//!
//! [`simulate`] does 1 to 3 and 5 as calls, without files.
//!
//! # Rooms
//!
//! A module names only modules of its own row or of rows above it (a test holds this):
//!
//! | row | modules |
//! |---|---|
//! | 1 | [`file`]: reading files |
//! | 2 | [`scene`]: what is asked; [`space`]: cells, neighbours, sums over pairs; [`kernel`] |
//! | 3 | [`particle`]: particles, packing, walls |
//! | 4 | [`effect`]: gravity, viscosity, tension, wetting, vibration |
//! | 5 | [`method`]: the solvers |
//! | 6 | [`measure`]: numbers; [`record`]: log, checkpoints, exports, meshes |
//! | 7 | [`draw`]: plots, pictures, the surface of the liquid, films, the report |
//! | 8 | [`pipeline`]: keys, store, runs; [`simulate`] |
//!
//! # What always holds
//!
//! * Equal settings give equal bits, for any number of threads and through any interruption.
//!   Reductions run over fixed chunks in a fixed order ([`space::parallel`]); each particle adds up
//!   its own neighbours and never writes into the sum of another particle.
//! * A stage is given only its input, never the whole scene. So everything that can change its
//!   result is in its key.
//! * An effect that is absent costs nothing: no array, no work in a step, no entry in a key.
//!   [`effect::select`] builds only the effects of the scene.
//! * A step allocates nothing once its arrays have grown.
//! * Positions are f64; where pairs are formed they are fixed-point numbers relative to the box, so
//!   that differences are exact. Pair sums are f32 unless `method.precision` is `double`.
//! * Unsafe code is in [`space`] and where the operating system is called.
//!
//! # Where to add what
//!
//! * **A setting**: its field in `scene/`; if presets differ in it, its values in
//!   `scene/preset/*.toml`.
//! * **A measure**: a function in `measure/`, called in `measure/gauge.rs`; a figure of the end of
//!   a run also in `measure/answer.rs`.
//! * **An effect**: `effect/NAME.rs` and its `mod` in `effect/mod.rs`; its table, and what it does
//!   at rest and to all particles alike, in `scene/effects.rs`; where it is built in
//!   `effect/select.rs`.
//! * **A method**: a folder in `method/` with a [`method::Solver`] (a projection is a `Scheme` of
//!   [`method::projection`]), built in `method/mod.rs`; its settings in `scene/method/`; its
//!   presets in `scene/preset/`; every `match` over [`scene::Method`], which the compiler finds;
//!   the lists of methods in `scene/preset/mod.rs` and `tests/`.
//! * **What a method keeps of a particle**: its `columns!`, with a [`particle::column::Role`].
//! * **What a pair sum reads**: its [`payload!`].
//! * **A format of export**: a file in `record/export/`, its arms in `record/export/mod.rs`, its
//!   word in `stages/arguments/output.rs`.
//! * **A plot**: `draw/figure.rs`.
//!
//! Then: if results change, raise the VERSION in `stages/jobs.rs`, or stored results stay in use;
//! renew the golden digests, the schema and the page of settings (`CONTRIBUTING.md` has the
//! commands); tests stand in `tests/engine/`.
//!
//! An effect is an [`effect::Effect`]: a uniform acceleration, accelerations of particles near a
//! surface, a limit of the step, an energy. Every method calls it through
//! [`method::liquid::Liquid`]. Forces between pairs, such as viscosity, are a type parameter
//! of the pair sums of a method ([`effect::viscosity::PairViscosity`]).
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | advective step, acoustic step | the outer and the inner step of dual-criteria stepping |
//! | band | cells that hold or touch particles near a surface |
//! | blob | what one particle adds to the field of a rendered surface |
//! | body | connected liquid of a scene file: a pool, a drop |
//! | case, model | constants that a method derives from a problem |
//! | column | an array with one entry a particle, declared with its role |
//! | frame | what the log keeps of an instant |
//! | hold | to keep an acceleration over a step |
//! | image | the copy of a particle behind a mirror plane |
//! | kernel sum | SUM V W over the neighbours: 1 inside, 0.77 at a flat surface |
//! | liquid | what every method moves: particles, rows, walls, effects, the budget |
//! | ledger | the work by which the liquid gains or loses energy in total |
//! | mist | single particles that leave the scene |
//! | pass | what one pair of particles adds to the sums of a loop |
//! | problem | liquid, box, effects and method: all that a solver reads |
//! | payload | the numbers that a point carries for a pass, by name |
//! | records, rows | what a pair loop reads of particles; the neighbours of a particle |
//! | shore | walls in the energy of the surface |
//! | state | all that a solver needs to go on, bit for bit |
//! | support | radius beyond which a kernel is zero, 2 h |
//!
//! # Symbols
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s0, h, H | particle spacing, smoothing length, that of the tension | m |
//! | rho0, rho | density at rest, density | kg/m^3 |
//! | mu, nu | dynamic and kinematic viscosity | Pa s, m^2/s |
//! | sigma | surface tension coefficient | N/m |
//! | c | speed of sound | m/s |
//! | g | gravity | m/s^2 |
//! | W, w, slope, curve | kernel; in units of h; w'(q) / q; its derivative over q | |
//! | q, d | distance and separation over h, own minus other | |
//! | dt | time step | s |
//! | We, Re, Oh, Fr, Bo, Ca | the dimensionless numbers of the drop | |

pub mod draw;
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
