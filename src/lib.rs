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
//! A module names only modules of its own row or of rows above it, and no two files import each
//! other (both are tests):
//!
//! | row | modules |
//! |---|---|
//! | 1 | [`file`]: reading files |
//! | 2 | [`scene`]: what is asked; [`space`]: cells, neighbours, sums over pairs; [`kernel`] |
//! | 3 | [`particle`]: particles, packing, walls |
//! | 4 | [`effect`]: gravity, viscosity, tension, wetting |
//! | 5 | [`method`]: the solvers |
//! | 6 | [`measure`]: numbers; [`record`]: log, checkpoints, exports |
//! | 7 | [`draw`]: plots, pictures, the report |
//! | 8 | [`pipeline`]: keys, store, runs; [`simulate`] |
//!
//! # What always holds
//!
//! * Equal settings give equal bits, for any number of threads and through any interruption.
//!   Reductions run over fixed chunks in a fixed order ([`space::parallel`]); every target gathers
//!   its own sum, no sum is scattered.
//! * A stage gets nothing of a scene but its input, so that what it reads is in its key.
//! * An effect that a scene does not have costs nothing: it is the type `()` or `None`
//!   ([`effect::select`] is where a scene becomes types), has no array, and is in no key.
//! * A step allocates nothing once its arrays have grown.
//! * Positions are f64; where pairs are formed they are fixed-point numbers relative to the box, so
//!   that differences are exact. Pair sums are f32 unless `method.precision` is `double`.
//! * Unsafe code is in [`space`] and where the operating system is called.
//!
//! # Where to add what
//!
//! | to add | edit |
//! |---|---|
//! | a setting | its field in `scene/`; its value of each preset in `scene/preset/*.toml` |
//! | a measure | a function in `measure/`, called in `measure/gauge.rs` |
//! | an effect | `effect/NAME.rs`, its table in `scene/effects.rs`, a line in `effect/select.rs` |
//! | a method | a folder in `method/`, its settings in `scene/method/`, a line in `method::build` |
//! | what a method keeps of a particle | its `columns!`, with a [`particle::column::Role`] |
//! | a format of export | a file in `record/export/`, a line in its `mod.rs` |
//! | a plot | `draw/figure.rs` |
//!
//! An effect is an [`effect::Effect`]: a uniform acceleration, accelerations of particles near a
//! surface, a limit of the step, an energy. Every method calls it through
//! [`method::liquid::Liquid`]. Pair forces as viscosity are types of the pair sums of a method
//! ([`effect::viscosity::PairViscosity`]).
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | advective step, acoustic step | the outer and the inner step of dual-criteria stepping |
//! | band | cells that hold or touch particles near a surface |
//! | body | connected liquid of a scene file: a pool, a drop |
//! | case, model | constants that a method derives from a problem |
//! | column | an array with one entry a particle, declared with its role |
//! | frame | what the log keeps of an instant |
//! | hold | to keep an acceleration over a step |
//! | image | the copy of a particle behind a mirror plane |
//! | kernel sum | SUM V W over the neighbours: 1 inside, 0.77 at a flat surface |
//! | liquid | what every method moves: particles, rows, walls, effects, the budget |
//! | ledger | the work of all that is no exchange between energies of the liquid |
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
