//! The loop over the jobs: each is fresh, or is made under its lock and published.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::content::{ContentError, content, set_aside};
use super::context::{Context, Input, Spent};
use super::decide::{Done, decide, relatives};
use super::machine::Clock;
use super::name::{MANIFEST, is_name};
use super::need::needed;
use super::progress::Teller;
use super::remote::Remote;
use super::report::{Ended, Report, Status};
use super::store::{OUT, Store, WORK};
use super::{Decision, Event, Pipeline, PipelineError, StageError, Watch, key, latest, publish};
use crate::file::FileError;
use crate::record::Digest;

/// A run of a pipeline.
pub struct Run<'a> {
    /// Where results are kept.
    pub store: &'a Store,
    /// The jobs to run.
    pub pipeline: &'a Pipeline<'a>,
    /// Another name of the results besides that of the pipeline.
    pub also: Option<&'a str>,
    /// Name of the stage to run, with all that it needs; all if `None`.
    pub until: Option<&'a str>,
    /// Set to stop the run at the next restartable instant.
    pub stop: &'a AtomicBool,
    /// Receives the events.
    pub watch: &'a dyn Watch,
    /// Where results are looked for before they are made, and put after.
    pub remote: Option<&'a Remote<'a>>,
    /// For the stamps.
    pub threads: usize,
    /// For the stamps: name and version of the program.
    pub program: String,
}

impl Run<'_> {
    /// Whether its names can be used and its last stage exists.
    ///
    /// # Errors
    /// If not.
    pub fn check(&self) -> Result<(), PipelineError> {
        if let Some(name) = names(self).find(|name| !is_name(name)) {
            let name = name.to_string();
            return Err(PipelineError::Name { name });
        }
        for name in names(self) {
            let outer = name.match_indices('/').map(|(at, _)| &name[..at]);
            let is_taken = |outer: &&str| {
                let manifest = latest::folder(self.store, outer).join(MANIFEST);
                manifest.symlink_metadata().is_ok()
            };
            // Who was there before the other one goes on.
            if let Some(outer) = outer.rev().find(is_taken).filter(|_| !is_taken(&name)) {
                let (name, outer) = (name.to_string(), outer.to_string());
                return Err(PipelineError::Within { name, outer });
            }
        }
        needed(self.pipeline, self.until).map(drop)
    }

    /// Says once for whom a job waits; whether it goes on waiting.
    fn waits(&self, job: &str) -> impl FnMut(&str) -> bool {
        let mut said = false;
        move |holder| {
            if !std::mem::replace(&mut said, true) {
                self.watch.event(&Event::Waiting { job, holder });
            }
            !self.stop.load(Ordering::Relaxed)
        }
    }
}

/// Brings every job up to date, in order.
///
/// # Errors
/// If a job fails, or the store cannot be used.
pub fn run(run: &Run) -> Result<Ended, PipelineError> {
    run.check()?;
    let needed = needed(run.pipeline, run.until)?;
    let shared = run.store.share(&mut run.waits("run"))?;
    // In a read-only store there is none.
    if shared.is_none() && run.stop.load(Ordering::Relaxed) {
        let job = "run".to_string();
        return Err(PipelineError::Interrupted { job });
    }
    let mut walk = Walk {
        run,
        done: Vec::new(),
        repaired: HashSet::new(),
    };
    walk.done.resize_with(run.pipeline.jobs.len(), || None);
    let mut wanted = (0..needed.len()).filter(|job| needed[*job]);
    let ended = wanted.try_for_each(|job| walk.ensure(job));
    let whole = ended.is_ok() && !needed.contains(&false);
    let reports: Vec<_> = walk.done.into_iter().flatten().collect();
    let named = name_results(run, &reports, whole);
    ended?;
    let unnamed = named.err();
    Ok(Ended { reports, unnamed })
}

/// Names of the results.
fn names<'a>(run: &Run<'a>) -> impl Iterator<Item = &'a str> {
    [run.pipeline.name.as_str()].into_iter().chain(run.also)
}

/// Points the names of the pipeline to its results.
fn name_results(run: &Run, reports: &[Report], whole: bool) -> Result<(), FileError> {
    for name in names(run) {
        for path in latest::finish(run.store, name, reports, whole)? {
            let path = path.display();
            let text = format!("a copy was in place of a link; it is kept as {path}");
            run.watch.event(&Event::Warning {
                job: "latest",
                text: &text,
            });
        }
    }
    Ok(())
}

struct Walk<'a> {
    run: &'a Run<'a>,
    done: Vec<Option<Report>>,
    /// Input files that were set aside and regenerated.
    repaired: HashSet<PathBuf>,
}

/// Result of one attempt at a job.
enum Attempt {
    Done(Box<Report>),
    /// Input `job` is damaged.
    Repair {
        job: usize,
        file: PathBuf,
        what: String,
    },
}

impl Walk<'_> {
    /// Brings job `job` up to date; repairs its inputs if they are damaged.
    fn ensure(&mut self, job: usize) -> Result<(), PipelineError> {
        loop {
            match self.attempt(job)? {
                Attempt::Done(report) => {
                    self.run.watch.event(&Event::Ended { report: &report });
                    self.done[job] = Some(*report);
                    return Ok(());
                }
                Attempt::Repair {
                    job: producer,
                    file,
                    what,
                } => {
                    self.repair(job, producer, file, what)?;
                }
            }
        }
    }

    fn attempt(&self, job: usize) -> Result<Attempt, PipelineError> {
        let run = self.run;
        let done: Vec<_> = self
            .done
            .iter()
            .map(|report| report.as_ref().map(finished))
            .collect();
        let decide = || decide(run.store, run.pipeline, job, &done);
        let decision = decide()?;
        let key = decision.key.expect("all inputs are done");
        if let Some(report) = fresh(run.store, decision) {
            discard_work(run.store, &report.folder);
            return Ok(self.shared(report));
        }
        let label = super::label(run.pipeline.jobs[job].as_ref());
        let interrupted = || PipelineError::Interrupted { job: label.clone() };
        if run.stop.load(Ordering::Relaxed) {
            return Err(interrupted());
        }
        let folder = run.store.folder(run.pipeline.jobs[job].name(), &key);
        let lock = run.store.lock(&folder, &mut run.waits(&label))?;
        let Some(_lock) = lock else {
            return Err(interrupted());
        };
        // The previous holder of the lock may have made it.
        let decision = decide()?;
        if decision.fresh.is_some() {
            let report = fresh(run.store, decision).expect("just seen");
            return Ok(self.shared(report));
        }
        let Some(remote) = run.remote else {
            return self.make(job, decision, &folder);
        };
        let inputs: Vec<_> = self.inputs(job).iter().map(Input::stamp_of).collect();
        if let Some(report) = remote.fetched(&decision, &folder, &inputs, run.watch)? {
            return Ok(Attempt::Done(Box::new(report)));
        }
        let made = self.make(job, decision, &folder)?;
        if let Attempt::Done(report) = &made {
            remote.offer(report, run.watch);
        }
        Ok(made)
    }

    /// Puts a result that was found into the remote store, if there is one that lacks it.
    fn shared(&self, report: Box<Report>) -> Attempt {
        if let Some(remote) = self.run.remote {
            remote.offer_again(&report, self.run.watch);
        }
        Attempt::Done(report)
    }

    /// Runs the stage and publishes its files. The caller holds the lock of `folder`.
    fn make(
        &self,
        job: usize,
        decision: Decision,
        folder: &Path,
    ) -> Result<Attempt, PipelineError> {
        let run = self.run;
        let stage = run.pipeline.jobs[job].as_ref();
        let label = super::label(stage);
        let settings = stage.settings();
        let inputs = self.inputs(job);
        let digests: Vec<Digest> = inputs.iter().map(|input| input.stamp.digest).collect();
        let family = key::family(stage, &settings, &digests);
        run.watch.event(&Event::Started {
            decision: &decision,
        });
        let mut context = self.context(&decision, inputs, family, folder)?;
        context.save_time()?;
        let outputs = match stage.run(&mut context) {
            Ok(outputs) => outputs,
            Err(StageError::Interrupted) => {
                context.save_time()?;
                return Err(PipelineError::Interrupted { job: label });
            }
            Err(StageError::Input { index, file, what }) => {
                let job = stage.inputs()[index];
                return Ok(Attempt::Repair { job, file, what });
            }
            Err(StageError::Failed(source)) => {
                context.teller.fail(&*source);
                return Err(PipelineError::Stage { job: label, source });
            }
        };
        let made = publish::Made {
            program: &run.program,
            threads: run.threads,
            stage,
            settings: &settings,
            family,
            decision: &decision,
            folder,
            outputs,
            context: &context,
        };
        let stamp = publish::publish(made)?;
        let (seconds, cpu_seconds) = context.clock.read();
        Ok(Attempt::Done(Box::new(Report {
            stage: decision.stage,
            body: decision.body,
            status: if context.resumed {
                Status::Resumed
            } else {
                Status::Ran
            },
            reasons: decision.reasons,
            folder: folder.to_path_buf(),
            stamp,
            seconds,
            cpu_seconds,
        })))
    }

    /// The environment of the stage of `decision`.
    fn context(
        &self,
        decision: &Decision,
        inputs: Vec<Input>,
        family: Option<Digest>,
        folder: &Path,
    ) -> Result<Context<'_>, FileError> {
        let work = folder.join(WORK);
        self.run.store.refuse_links(&work.join(OUT))?;
        let mut spent = Spent::begin(&work)?;
        spent.inputs = inputs.iter().map(|input| input.stamp_of()).collect();
        let relatives = relatives(self.run.store, &decision.stage, family)?;
        let job = [&decision.stage[..], &decision.body];
        Ok(Context {
            teller: Teller::start(&work, &self.run.pipeline.name, job),
            inputs,
            relatives,
            key: decision.key.expect("known when it runs"),
            work,
            job: decision.label(),
            stop: self.run.stop,
            watch: self.run.watch,
            resumed: false,
            notes: Vec::new(),
            clock: Clock::start(),
            spent,
        })
    }

    fn inputs(&self, job: usize) -> Vec<Input> {
        let inputs = self.run.pipeline.jobs[job].inputs().into_iter();
        let done = inputs.map(|index| self.done[index].as_ref().expect("inputs come first"));
        done.map(Input::of).collect()
    }

    /// Sets a damaged file of job `producer` aside and regenerates it.
    fn repair(
        &mut self,
        reader: usize,
        producer: usize,
        file: PathBuf,
        what: String,
    ) -> Result<(), PipelineError> {
        let run = self.run;
        let job = super::label(run.pipeline.jobs[reader].as_ref());
        if !self.repaired.insert(file.clone()) {
            return Err(PipelineError::DamagedAgain { job, file, what });
        }
        let report = self.done[producer].take().expect("it was read");
        {
            let lock = run.store.lock(&report.folder, &mut run.waits(&job))?;
            let Some(_lock) = lock else {
                return Err(PipelineError::Interrupted { job });
            };
            // Another process may have repaired it while this one waited.
            let mut outputs = report.stamp.outputs.iter();
            let wanted = outputs.find(|output| report.folder.join(&output.file) == file);
            let whole = match (wanted, content(&file)) {
                (Some(wanted), Ok(found)) => found == wanted.digest,
                (_, Err(ContentError::File(error))) => return Err(error.into()),
                _ => false,
            };
            if let (None, Some(remote)) = (wanted, run.remote) {
                // It is there as it came, so it would come again.
                remote.distrust(report.stamp.key);
            }
            if !whole {
                let kept = set_aside(&report.folder, &file)?;
                let text = format!(
                    "{} cannot be trusted: {what}; it is kept as {}, and {} runs again",
                    file.display(),
                    kept.display(),
                    report.label()
                );
                run.watch.event(&Event::Warning {
                    job: &job,
                    text: &text,
                });
            }
        }
        self.ensure(producer)
    }
}

fn finished(report: &Report) -> Done {
    Done {
        key: report.stamp.key,
        digest: report.stamp.digest,
    }
}

fn fresh(store: &Store, decision: Decision) -> Option<Box<Report>> {
    let stamp = *decision.fresh?;
    Some(Box::new(Report {
        folder: store.folder(&decision.stage, &stamp.key),
        stage: decision.stage,
        body: decision.body,
        status: Status::Fresh,
        reasons: Vec::new(),
        stamp,
        seconds: 0.0,
        cpu_seconds: 0.0,
    }))
}

/// Removes the work folder of a finished result, which is left when a run is killed right after it
/// has written the stamp.
fn discard_work(store: &Store, folder: &Path) {
    let work = folder.join(WORK);
    if work.exists()
        && let Ok(Some(_lock)) = store.lock(folder, &mut |_| false)
    {
        let _ = fs::remove_dir_all(work);
    }
}
