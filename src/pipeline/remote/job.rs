//! A job of a run and its remote store. What fails there is told, and the run goes on without.

use std::path::Path;

use super::{Remote, RemoteError, Wanted};
use crate::pipeline::machine::Clock;
use crate::pipeline::stamp::InputStamp;
use crate::pipeline::{Decision, Event, PipelineError, Report, Status, Watch};

impl Remote<'_> {
    /// Looks for the result of a job. The caller holds the lock of `folder`.
    ///
    /// # Errors
    /// Only in a run that makes nothing: if the result cannot be fetched.
    pub(in crate::pipeline) fn fetched(
        &self,
        decision: &Decision,
        folder: &Path,
        inputs: &[InputStamp],
        watch: &dyn Watch,
    ) -> Result<Option<Report>, PipelineError> {
        let clock = Clock::start();
        let wanted = Wanted {
            stage: &decision.stage,
            key: decision.key.expect("all inputs are done"),
            folder,
        };
        let (job, place) = (decision.label(), self.place());
        let stamp = match self.fetch(&wanted, Some(inputs)) {
            Ok(Some(stamp)) => stamp,
            Ok(None) if self.only => return Err(PipelineError::NotThere { job, place }),
            Ok(None) => return Ok(None),
            Err(source) if self.only => {
                return Err(PipelineError::Remote { job, place, source });
            }
            Err(RemoteError::File(error)) => return Err(error.into()),
            Err(error) => {
                self.warn(&error, &job, "it is made here", watch);
                return Ok(None);
            }
        };
        let (seconds, cpu_seconds) = clock.read();
        Ok(Some(Report {
            stage: decision.stage.clone(),
            body: decision.body.clone(),
            status: Status::Fetched,
            reasons: decision.reasons.clone(),
            folder: folder.to_path_buf(),
            stamp,
            seconds,
            cpu_seconds,
        }))
    }

    /// Puts a result that was made here.
    pub(in crate::pipeline) fn offer(&self, made: &Report, watch: &dyn Watch) {
        if let Err(error) = self.put(&made.folder, &made.stamp) {
            self.warn(&error, &made.label(), "this result stays here", watch);
        }
    }

    /// Puts a result that was here before, unless that was tried. What cannot be put was told when
    /// it was made.
    pub(in crate::pipeline) fn offer_again(&self, found: &Report, watch: &dyn Watch) {
        let is_new = || {
            let mut offered = self.offered.lock().expect("nobody panics");
            offered.insert(found.stamp.key)
        };
        if self.only || !is_new() {
            return;
        }
        match self.put(&found.folder, &found.stamp) {
            Ok(_) | Err(RemoteError::Bad { .. }) => {}
            Err(error) => self.warn(&error, &found.label(), "this result stays here", watch),
        }
    }

    fn warn(&self, error: &RemoteError, job: &str, then: &str, watch: &dyn Watch) {
        let then = match error {
            RemoteError::Unusable(_) => "the run goes on without it",
            _ => then,
        };
        let text = format!("remote store {}: {error}; {then}", self.place());
        watch.event(&Event::Warning { job, text: &text });
    }
}
