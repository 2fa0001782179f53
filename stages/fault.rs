//! Exit codes, see `coronet --help`.

use std::io;

use coronet::draw::film::FilmError;
use coronet::method::Diverged;
use coronet::particle::pack::PackError;
use coronet::pipeline::PipelineError;
use coronet::pipeline::latest::ManifestError;
use coronet::pipeline::remote::RemoteError;
use coronet::pipeline::stamp::StampError;
use coronet::record::CheckpointError;
use coronet::record::export::ExportError;
use coronet::record::log::LogError;
use coronet::scene::error::SceneError;
use coronet::scene::key::KeyError;

pub const FAILED: u8 = 1;
pub const USAGE: u8 = 2;
pub const DIVERGED: u8 = 3;
pub const UNTRUSTED: u8 = 4;
pub const FILES: u8 = 5;
pub const BUSY: u8 = 6;
pub const INTERRUPTED: u8 = 130;
/// Plus the number of the signal that killed a point of a study, as shells have it.
pub const KILLED: u8 = 128;

/// Damaged results were found.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Untrusted(pub String);

/// The work was stopped on request.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Stopped(pub String);

/// Every point of a study failed, the last of them by this exit code.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Failed(pub String, pub u8);

/// Files that cannot be read were found.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Unreadable(pub String);

/// A mistake in the arguments that the parser does not detect.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Usage(pub String);

/// The exit code for `error`, from the most specific cause in its chain.
pub fn exit_code(error: &anyhow::Error) -> u8 {
    error.chain().find_map(code_of).unwrap_or(FAILED)
}

fn of_manifest(error: &ManifestError) -> u8 {
    match error {
        ManifestError::Invalid { .. } => UNTRUSTED,
        ManifestError::File(_) => FILES,
    }
}

fn code_of(error: &(dyn std::error::Error + 'static)) -> Option<u8> {
    if let Some(error) = error.downcast_ref::<PipelineError>() {
        return match error {
            PipelineError::Interrupted { .. } => Some(INTERRUPTED),
            PipelineError::Nondeterministic { .. } | PipelineError::DamagedAgain { .. } => {
                Some(UNTRUSTED)
            }
            PipelineError::UnknownStage { .. }
            | PipelineError::UnknownPipeline { .. }
            | PipelineError::Name { .. }
            | PipelineError::Within { .. }
            | PipelineError::NoNames { .. }
            | PipelineError::NotAStore { .. } => Some(USAGE),
            PipelineError::Busy { .. } => Some(BUSY),
            PipelineError::Manifest(error) => Some(of_manifest(error)),
            PipelineError::File(_) => Some(FILES),
            _ => None,
        };
    }
    if let Some(error) = error.downcast_ref() {
        return Some(of_manifest(error));
    }
    if let Some(error) = error.downcast_ref::<StampError>() {
        return match error {
            StampError::Invalid { .. } => Some(UNTRUSTED),
            StampError::File(_) => Some(FILES),
        };
    }
    if let Some(error) = error.downcast_ref::<RemoteError>() {
        return match error {
            RemoteError::Bad { .. } => Some(UNTRUSTED),
            _ => Some(FILES),
        };
    }
    if let Some(error) = error.downcast_ref::<csv::Error>() {
        return error.is_io_error().then_some(FILES);
    }
    if let Some(SceneError::File(error)) = error.downcast_ref::<SceneError>() {
        return Some(if error.is_not_found() { USAGE } else { FILES });
    }
    if error.is::<SceneError>() || error.is::<KeyError>() || error.is::<Usage>() {
        return Some(USAGE);
    }
    if let Some(PackError::TooFew { .. }) = error.downcast_ref::<PackError>() {
        return Some(USAGE);
    }
    if let Some(FilmError::Absent) = error.downcast_ref::<FilmError>() {
        return Some(USAGE);
    }
    let is_damage = error.downcast_ref().is_some_and(LogError::is_damage)
        || error.downcast_ref().is_some_and(CheckpointError::is_damage)
        || error.downcast_ref().is_some_and(ExportError::is_damage);
    if is_damage || error.is::<Untrusted>() {
        return Some(UNTRUSTED);
    }
    if error.is::<Stopped>() {
        return Some(INTERRUPTED);
    }
    if let Some(Failed(_, code)) = error.downcast_ref() {
        return Some(*code);
    }
    if error.is::<Unreadable>() {
        return Some(FILES);
    }
    if error.is::<Diverged>() {
        return Some(DIVERGED);
    }
    error.is::<io::Error>().then_some(FILES)
}
