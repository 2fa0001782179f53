//! One point of a study: a run of this program in its own process, so that points run in parallel
//! and a failure does not affect other points.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Context as _, Result, bail};
use coronet::file::FileError;
use coronet::measure::kind::contact_time;
use coronet::measure::series::Series;
use coronet::pipeline::Stamp;
use coronet::scene::{Scene, file};
use serde_json::Value;

use crate::fault::{self, Stopped, Unreadable, Untrusted, Usage};
use crate::print::note;

/// Time between two checks for a request to stop.
const POLL: Duration = Duration::from_millis(20);

/// Largest size of a scene file, bytes, as where it is loaded.
const LONGEST: u64 = 16 << 20;

/// A run of a study.
#[derive(Clone)]
pub struct Trial {
    /// Name of its results under `latest/`.
    pub name: String,
    pub pipeline: PathBuf,
    /// Text of the scene file when the study began.
    pub source: Vec<u8>,
    pub sets: Vec<String>,
    /// Case and labels, for messages.
    pub title: String,
    /// Number of its case in the study.
    pub case: Option<usize>,
    /// Label on each axis.
    pub labels: Vec<String>,
    /// Which axes only repeat a point.
    pub repeats: Vec<bool>,
    /// Name of its method; empty for a scene that must be rejected.
    pub method: &'static str,
    /// Particle spacing, m, and number of particles; NaN for such a scene.
    pub spacing: f64,
    pub count: f64,
}

/// Content of a scene file, of which a point is made.
pub fn source(path: &Path) -> Result<Vec<u8>, FileError> {
    coronet::file::read(path, LONGEST)
}

/// Where results are kept.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    pub artifacts: &'a Path,
    /// URL of the remote store.
    pub remote: Option<&'a str>,
}

/// Result of the run.
pub enum Outcome {
    Done {
        measures: Series,
        /// The log of the impact.
        frames: PathBuf,
        /// Times of the impact, all attempts, s.
        cpu_seconds: f64,
        wall_seconds: f64,
        memory_bytes: Option<u64>,
        /// `fresh` if nothing had to run, `fetched` if that came from a remote store, or `ran`.
        did: &'static str,
        made: Box<Made>,
        /// What makes its figures doubtful.
        warnings: Vec<String>,
    },
    Failed {
        /// [`reason`].
        why: String,
        /// Exit code.
        code: u8,
        /// Folder of the checkpoints and frames so far.
        work: Option<PathBuf>,
    },
}

/// Which program computed a point, where and when.
pub struct Made {
    pub program: String,
    /// Version of the impact.
    pub version: u32,
    /// Versions of the parts that it used, as `isph 2`.
    pub parts: Vec<String>,
    /// Processor, cores and system.
    pub machine: String,
    /// UTC, as `2026-11-26`.
    pub date: String,
}

impl Made {
    fn of(stamp: &Stamp) -> Made {
        let here = &stamp.machine;
        let parts = stamp.settings.iter().filter_map(|setting| {
            let name = setting.name.strip_prefix("version.")?;
            Some(format!("{name} {}", setting.value))
        });
        Made {
            program: stamp.program.clone(),
            version: stamp.version,
            parts: parts.collect(),
            machine: format!("{}, {} cores, {}", here.processor, here.cores, here.system),
            date: stamp.started.chars().take(10).collect(),
        }
    }
}

impl Outcome {
    /// The result in one word, for tables.
    pub fn status(&self) -> &'static str {
        match self {
            Outcome::Done { .. } => "done",
            Outcome::Failed {
                code: fault::DIVERGED,
                ..
            } => "diverged",
            Outcome::Failed { .. } => "failed",
        }
    }

    /// Which program computed a finished point.
    pub fn made(&self) -> Option<&Made> {
        match self {
            Outcome::Done { made, .. } => Some(made),
            Outcome::Failed { .. } => None,
        }
    }

    /// What makes the figures of a finished point doubtful.
    pub fn warnings(&self) -> &[String] {
        match self {
            Outcome::Done { warnings, .. } => warnings,
            Outcome::Failed { .. } => &[],
        }
    }

    /// The data of a finished point.
    pub fn measures(&self) -> Option<&Series> {
        match self {
            Outcome::Done { measures, .. } => Some(measures),
            Outcome::Failed { .. } => None,
        }
    }
}

/// How the line begins in which a program tells that it has no memory, before hints.
const NO_MEMORY: &str = "memory allocation of ";

/// The last line that says something of what a program wrote of its failure. Of a panic, whose last
/// lines are hints: its place and its first line.
fn reason(complaint: &str) -> Option<String> {
    if let Some(line) = complaint.lines().find(|line| line.starts_with(NO_MEMORY)) {
        return Some(line.to_string());
    }
    let mut lines = complaint
        .lines()
        .skip_while(|line| !line.contains("panicked at"));
    match (lines.next(), lines.next()) {
        (Some(place), Some(words)) => Some(format!("{place} {words}")),
        _ => {
            let mut lines = complaint.lines().map(str::trim);
            let last = lines.rfind(|line| !line.is_empty())?;
            Some(last.trim_start_matches("error: ").to_string())
        }
    }
}

/// The signal that has ended a program.
#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_status: ExitStatus) -> Option<i32> {
    None
}

/// Whether a signal asks a program to stop, and so says nothing about its work.
fn is_request(signal: i32) -> bool {
    #[cfg(unix)]
    return [libc::SIGINT, libc::SIGTERM, libc::SIGHUP].contains(&signal);
    #[cfg(not(unix))]
    return signal == 0;
}

impl Trial {
    /// Warns of each column in `needed` that its measures lack.
    pub fn warn_of_missing(&self, needed: &[&str], outcome: &Result<Outcome>) {
        let Some(measures) = outcome.as_ref().ok().and_then(Outcome::measures) else {
            return;
        };
        for column in needed {
            if measures.column(column).is_none() {
                note!("warning: {} does not measure `{column}`", self.title);
            }
        }
    }

    pub fn scene(&self) -> Result<Scene> {
        Ok(file::load(&self.pipeline, &self.sets)?.scene)
    }

    /// Time of contact of its drop, s; zero without one.
    pub fn contact(&self) -> Result<f64> {
        Ok(contact_time(&self.scene()?))
    }

    /// An error if the scene file is another one by now: points would be of two scenes.
    fn check_source(&self) -> Result<()> {
        if source(&self.pipeline)? == self.source {
            return Ok(());
        }
        let path = self.pipeline.display();
        bail!(Usage(format!(
            "{path} has changed since the study began, which needs one scene for all points; give \
             the command again"
        )))
    }

    /// Brings the point up to date.
    ///
    /// # Errors
    /// If its scene file has changed, if the program cannot be started or its answer not be read,
    /// if it could not read or write a file or trust one, which says nothing about the point, or if
    /// it was stopped, by a signal that asks for that or because `stop` was set.
    pub fn run(&self, place: Place, threads: usize, stop: &AtomicBool) -> Result<Outcome> {
        self.check_source()?;
        let outcome = self.attempt(place, threads, stop)?;
        self.check_source()?;
        Ok(outcome)
    }

    fn attempt(&self, place: Place, threads: usize, stop: &AtomicBool) -> Result<Outcome> {
        let program = std::env::current_exe().context("cannot find this program")?;
        let mut command = Command::new(program);
        command.arg("run").arg(&self.pipeline).arg("--json");
        command.arg("--name").arg(&self.name);
        command.arg("--artifacts").arg(place.artifacts);
        if let Some(url) = place.remote {
            command.arg("--remote").arg(url);
        }
        command.arg("--threads").arg(threads.to_string());
        command.arg("--stop-at-end-of-input");
        for set in &self.sets {
            command.arg("--set").arg(set);
        }
        let ended = output(&mut command, stop)
            .with_context(|| format!("cannot start point {}", self.name))?;
        let complaint = String::from_utf8_lossy(&ended.stderr);
        if !ended.status.success() {
            let (signal, last) = (signal(ended.status), reason(&complaint));
            let why = match (signal, last) {
                (Some(signal), Some(last)) => format!("killed by signal {signal}: {last}"),
                (Some(signal), None) => format!("killed by signal {signal}"),
                (None, last) => last.unwrap_or("it does not say why".to_string()),
            };
            let code = match (ended.status.code(), signal) {
                (Some(code), _) => code as u8,
                (None, Some(signal)) => fault::KILLED + signal as u8,
                (None, None) => fault::FAILED,
            };
            let name = &self.name;
            let is_asked = |signal| is_request(signal) || stop.load(Ordering::Relaxed);
            if signal.is_some_and(is_asked) || code == fault::INTERRUPTED {
                bail!(Stopped(format!("point {name} was stopped: {why}")));
            }
            match code {
                fault::FILES => bail!(Unreadable(format!("point {name}: {why}"))),
                fault::UNTRUSTED => bail!(Untrusted(format!("point {name}: {why}"))),
                _ => {}
            }
            let answer = String::from_utf8_lossy(&ended.stdout);
            let lines = answer
                .lines()
                .filter_map(|line| serde_json::from_str(line).ok());
            let mut kept =
                lines.filter_map(|line: Value| Some(PathBuf::from(line["kept"].as_str()?)));
            let work = kept.next();
            return Ok(Outcome::Failed { why, code, work });
        }
        self.read(&String::from_utf8_lossy(&ended.stdout))
    }

    fn read(&self, out: &str) -> Result<Outcome> {
        let lines: Vec<Value> = out
            .lines()
            .map(serde_json::from_str)
            .collect::<Result<_, _>>()
            .with_context(|| format!("cannot read the answer of point {}", self.name))?;
        let stages = || lines.iter().filter(|line| line["stage"].is_string());
        let impact = stages().find(|line| line["stage"] == "impact");
        let folder = impact.and_then(|line| line["folder"].as_str());
        let path = |name: &str| lines.last().and_then(|line| line[name].as_str());
        let (Some(folder), Some(table), Some(log)) = (folder, path("measures"), path("frames"))
        else {
            bail!("point {} reports neither impact nor measures", self.name);
        };
        let stamp = Stamp::read(Path::new(folder))?.context("the impact has no stamp")?;
        Ok(Outcome::Done {
            measures: Series::read(Path::new(table))?,
            frames: PathBuf::from(log),
            cpu_seconds: stamp.cpu_seconds,
            wall_seconds: stamp.wall_seconds,
            memory_bytes: stamp.memory_bytes,
            did: did(stages().filter_map(|line| line["status"].as_str())),
            made: Box::new(Made::of(&stamp)),
            warnings: lines
                .last()
                .and_then(|line| line["warnings"].as_array())
                .into_iter()
                .flatten()
                .filter_map(|text| Some(text.as_str()?.to_string()))
                .collect(),
        })
    }
}

/// What a run did, from what its stages did.
fn did<'a>(stages: impl Iterator<Item = &'a str>) -> &'static str {
    let rank = |word| match word {
        "fresh" => 0,
        "fetched" => 1,
        _ => 2,
    };
    ["fresh", "fetched", "ran"][stages.map(rank).max().unwrap_or(0)]
}

/// Output of a command that runs until it ends or `stop` is set. Its standard input ends with this
/// process, so that the command then stops, too.
fn output(command: &mut Command, stop: &AtomicBool) -> std::io::Result<Output> {
    command.stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn()?;
    let input = child.stdin.take();
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(Ordering::Relaxed) && !ended.load(Ordering::Relaxed) {
                std::thread::sleep(POLL);
            }
            drop(input);
        });
        let output = child.wait_with_output();
        ended.store(true, Ordering::Relaxed);
        output
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_reason_is_the_line_that_tells_it() {
        let reason = |text| super::reason(text).unwrap();
        assert_eq!(reason("warning: a\nerror: b\n\n"), "b");
        let abort = "memory allocation of 9 bytes failed\nnote: run with RUST_BACKTRACE=1\n";
        assert_eq!(reason(abort), "memory allocation of 9 bytes failed");
        let panic = "thread 'main' panicked at a.rs:1:\nb\nnote: c\n";
        assert_eq!(reason(panic), "thread 'main' panicked at a.rs:1: b");
        assert_eq!(super::reason("\n"), None);
    }
}
