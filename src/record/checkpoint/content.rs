//! Particles and states as checkpoints, and back.
//!
//! Arrays of the particles have plain names (`id`, `position_x` ...); arrays and scalars of the
//! method have the prefix `method/`, so that names never collide.

use super::{Array, Checkpoint, CheckpointError};
use crate::particle::{Particles, State};

/// Kind of a checkpoint of [`Particles`].
pub const PARTICLES: &str = "particles";
/// Kind of a checkpoint of a [`State`].
pub const STATE: &str = "state";

const MASS: &str = "mass";
const METHOD: &str = "method/";
const WEIGHT: &str = "weight";
const POSITION: [&str; 3] = ["position_x", "position_y", "position_z"];
const VELOCITY: [&str; 3] = ["velocity_x", "velocity_y", "velocity_z"];

impl From<Particles> for Checkpoint {
    fn from(particles: Particles) -> Self {
        Checkpoint {
            kind: PARTICLES.into(),
            scalars: vec![(MASS.into(), particles.mass)],
            arrays: particle_arrays(particles),
            ..Checkpoint::default()
        }
    }
}

impl From<&Particles> for Checkpoint {
    fn from(particles: &Particles) -> Self {
        particles.clone().into()
    }
}

impl From<State> for Checkpoint {
    fn from(state: State) -> Self {
        let mut scalars = vec![(MASS.to_string(), state.particles.mass)];
        let of_method = state.scalars.into_iter();
        scalars.extend(of_method.map(|(name, value)| (format!("{METHOD}{name}"), value)));
        let mut arrays = particle_arrays(state.particles);
        let of_method = state.arrays.into_iter();
        arrays.extend(
            of_method.map(|(name, values)| (format!("{METHOD}{name}"), Array::F64(values))),
        );
        Checkpoint {
            kind: STATE.into(),
            time: state.time,
            step: state.step,
            scalars,
            texts: Vec::new(),
            arrays,
        }
    }
}

impl From<&State> for Checkpoint {
    fn from(state: &State) -> Self {
        state.clone().into()
    }
}

impl TryFrom<Checkpoint> for Particles {
    type Error = CheckpointError;

    fn try_from(mut checkpoint: Checkpoint) -> Result<Self, CheckpointError> {
        expect_kind(&checkpoint, PARTICLES)?;
        take_particles(&mut checkpoint, PARTICLES)
    }
}

impl TryFrom<Checkpoint> for State {
    type Error = CheckpointError;

    fn try_from(mut checkpoint: Checkpoint) -> Result<Self, CheckpointError> {
        expect_kind(&checkpoint, STATE)?;
        let particles = take_particles(&mut checkpoint, STATE)?;
        let mut arrays = Vec::new();
        for (name, array) in checkpoint.arrays {
            let Some(name) = name.strip_prefix(METHOD) else {
                continue;
            };
            match array {
                Array::F64(values) if values.len() == particles.len() => {
                    arrays.push((name.to_string(), values));
                }
                _ => {
                    let what = format!("array {METHOD}{name} does not fit the particles");
                    return Err(wrong(STATE, STATE, what));
                }
            }
        }
        let of_method = checkpoint.scalars.into_iter().filter_map(|(name, value)| {
            let name = name.strip_prefix(METHOD)?;
            Some((name.to_string(), value))
        });
        Ok(State {
            time: checkpoint.time,
            step: checkpoint.step,
            particles,
            scalars: of_method.collect(),
            arrays,
        })
    }
}

fn particle_arrays(particles: Particles) -> Vec<(String, Array)> {
    let mut arrays = vec![
        ("id".to_string(), Array::U32(particles.id)),
        ("body".to_string(), Array::U8(particles.body)),
    ];
    let names = POSITION.into_iter().chain(VELOCITY);
    let components = particles.position.into_iter().chain(particles.velocity);
    for (name, component) in names.zip(components) {
        arrays.push((name.into(), Array::F64(component)));
    }
    arrays.push(("density".into(), Array::F64(particles.density)));
    if !particles.weight.is_empty() {
        arrays.push((WEIGHT.into(), Array::F64(particles.weight)));
    }
    arrays
}

/// Takes the arrays of the particles out of `checkpoint` without copying them.
fn take_particles(
    checkpoint: &mut Checkpoint,
    expected: &'static str,
) -> Result<Particles, CheckpointError> {
    let mass = checkpoint
        .scalar(MASS)
        .ok_or_else(|| wrong(&checkpoint.kind, expected, format!("no scalar {MASS}")))?;
    let id = match take(checkpoint, expected, "id")? {
        Array::U32(values) => values,
        _ => return Err(wrong_type(checkpoint, expected, "id")),
    };
    let body = match take(checkpoint, expected, "body")? {
        Array::U8(values) => values,
        _ => return Err(wrong_type(checkpoint, expected, "body")),
    };
    let is_weighed = checkpoint.arrays.iter().any(|(name, _)| name == WEIGHT);
    let mut reals = |name: &str| match take(checkpoint, expected, name)? {
        Array::F64(values) if values.len() == id.len() => Ok(values),
        _ => Err(wrong_type(checkpoint, expected, name)),
    };
    let mut vector = |names: [&str; 3]| -> Result<[Vec<f64>; 3], CheckpointError> {
        Ok([reals(names[0])?, reals(names[1])?, reals(names[2])?])
    };
    let position = vector(POSITION)?;
    let velocity = vector(VELOCITY)?;
    let density = reals("density")?;
    let weight = match is_weighed {
        true => reals(WEIGHT)?,
        false => Vec::new(),
    };
    if body.len() != id.len() {
        return Err(wrong_type(checkpoint, expected, "body"));
    }
    Ok(Particles {
        id,
        body,
        position,
        velocity,
        density,
        mass,
        weight,
    })
}

fn take(
    checkpoint: &mut Checkpoint,
    expected: &'static str,
    name: &str,
) -> Result<Array, CheckpointError> {
    let found = checkpoint.arrays.iter_mut().find(|(key, _)| key == name);
    match found {
        Some((_, array)) => Ok(std::mem::replace(array, Array::U8(Vec::new()))),
        None => Err(wrong(
            &checkpoint.kind,
            expected,
            format!("no array {name}"),
        )),
    }
}

fn expect_kind(checkpoint: &Checkpoint, expected: &'static str) -> Result<(), CheckpointError> {
    if checkpoint.kind == expected {
        return Ok(());
    }
    Err(wrong(&checkpoint.kind, expected, "wrong kind".into()))
}

fn wrong_type(checkpoint: &Checkpoint, expected: &'static str, name: &str) -> CheckpointError {
    let what = format!("array {name} has the wrong type or length");
    wrong(&checkpoint.kind, expected, what)
}

fn wrong(kind: &str, expected: &'static str, what: String) -> CheckpointError {
    CheckpointError::WrongContent {
        kind: kind.to_string(),
        expected,
        what,
    }
}
