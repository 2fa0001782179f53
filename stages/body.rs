//! The result of packing and relaxation: the particles of one body.

use coronet::particle::Particles;
use coronet::pipeline::{Context, StageError};

/// The file of a body.
pub const BODY: &str = "body.checkpoint";

/// Reads body `index` from input `input`; the checkpoint does not contain its place in the scene.
pub fn read_body(context: &Context, input: usize, index: usize) -> Result<Particles, StageError> {
    let checkpoint = context.checkpoint(input, BODY)?;
    let mut particles = Particles::try_from(checkpoint).map_err(|error| StageError::Input {
        index: input,
        file: context.inputs[input].folder.join(BODY),
        what: error.to_string(),
    })?;
    particles.body.fill(index as u8);
    Ok(particles)
}
