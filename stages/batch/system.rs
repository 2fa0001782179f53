//! The commands of the batch systems.

use std::io::ErrorKind;
use std::process::Command;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use super::job::Job;
use crate::arguments::On;
use crate::fault::Usage;

/// States of Slurm in which a task has ended.
const ENDED: &[&str] = &[
    "BOOT_FAIL",
    "CANCELLED",
    "COMPLETED",
    "DEADLINE",
    "FAILED",
    "NODE_FAIL",
    "OUT_OF_MEMORY",
    "PREEMPTED",
    "REVOKED",
    "TIMEOUT",
];

/// A task that has not ended.
pub struct Task {
    pub job: String,
    pub point: usize,
    pub runs: bool,
}

impl From<On> for String {
    fn from(on: On) -> String {
        match on {
            On::Local => "local",
            On::Slurm => "slurm",
            On::Hq => "hq",
        }
        .to_string()
    }
}

/// Submits a job and returns its number.
pub fn submit(on: On, job: &Job) -> Result<String> {
    let script = job.write(on)?.display().to_string();
    let said = match on {
        On::Local => bail!(Usage("--on local submits nothing".to_string())),
        On::Slurm => call("sbatch", &["--parsable", &script])?,
        On::Hq => {
            let mut words = vec!["--output-mode", "quiet", "submit"];
            let options = job.hq_options();
            words.extend(options.iter().map(String::as_str));
            words.extend(["--", "bash", &script]);
            call("hq", &words)?
        }
    };
    // Slurm adds the name of the cluster, if there are several.
    let number = said.trim().split(';').next().unwrap_or_default();
    if number.is_empty() || !number.bytes().all(|byte| byte.is_ascii_digit()) {
        bail!("the number of the job is missing in the answer {said:?}");
    }
    Ok(number.to_string())
}

/// Identity of the server of HyperQueue, each of which numbers its jobs from 1.
pub fn server(on: On) -> Result<Option<String>> {
    if on != On::Hq {
        return Ok(None);
    }
    let said = call("hq", &["--output-mode", "json", "server", "info"])?;
    let info: Value = serde_json::from_str(&said).context("cannot read the answer of hq")?;
    let uid = info["server_uid"].as_str().map(str::to_string);
    uid.map(Some)
        .context("hq does not tell the identity of its server")
}

/// The tasks of these jobs that have not ended.
pub fn active(on: On, jobs: &[String]) -> Result<Vec<Task>> {
    if jobs.is_empty() {
        return Ok(Vec::new());
    }
    match on {
        On::Local => Ok(Vec::new()),
        // A job that the system has forgotten is not an error, if all jobs are asked for.
        On::Slurm => {
            let format = "--format=%F %K %T";
            let said = call(
                "squeue",
                &["--me", "--noheader", "--array", "--states=all", format],
            )?;
            Ok(said
                .lines()
                .filter_map(|line| slurm_task(line, jobs))
                .collect())
        }
        On::Hq => {
            let mut tasks = Vec::new();
            for job in jobs {
                tasks.extend(hq_tasks(job)?);
            }
            Ok(tasks)
        }
    }
}

/// A line of `squeue`: job, task, state.
fn slurm_task(line: &str, jobs: &[String]) -> Option<Task> {
    let mut words = line.split_whitespace();
    let (job, point, state) = (words.next()?, words.next()?, words.next()?);
    let counts = jobs.iter().any(|known| known == job) && !ENDED.contains(&state);
    counts.then_some(Task {
        job: job.to_string(),
        point: point.parse().ok()?,
        runs: !["PENDING", "REQUEUED", "REQUEUE_FED", "REQUEUE_HOLD"].contains(&state),
    })
}

/// The tasks of a job of HyperQueue; none if its server does not know it, as after a new start.
fn hq_tasks(job: &str) -> Result<Vec<Task>> {
    let said = call("hq", &["--output-mode", "json", "task", "list", job])?;
    let all: Value = serde_json::from_str(&said).context("cannot read the answer of hq")?;
    let tasks = all[job].as_array().into_iter().flatten();
    let task = |task: &Value| {
        let state = task["state"].as_str()?;
        ["waiting", "running"].contains(&state).then_some(Task {
            job: job.to_string(),
            point: task["id"].as_u64()? as usize,
            runs: state == "running",
        })
    };
    Ok(tasks.filter_map(task).collect())
}

/// Stops a job.
pub fn cancel(on: On, job: &str) -> Result<()> {
    match on {
        On::Local => Ok(()),
        On::Slurm => call("scancel", &[job]).map(drop),
        On::Hq => call("hq", &["job", "cancel", job]).map(drop),
    }
}

/// Standard output of a command.
fn call(program: &str, words: &[&str]) -> Result<String> {
    let output = match Command::new(program).args(words).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => bail!(Usage(format!(
            "there is no command `{program}` here; is this a machine from which jobs are submitted?"
        ))),
        other => other.with_context(|| format!("cannot start {program}"))?,
    };
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let said = match said.trim() {
            "" => String::from_utf8_lossy(&output.stdout),
            _ => said,
        };
        bail!("`{program} {}` failed: {}", words.join(" "), said.trim());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
