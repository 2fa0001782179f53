//! What a job asks for, and its script.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::record::atomic::{create_folder, write_file};
use coronet::scene::file;
use schemars::JsonSchema;
use serde::Deserialize;

use super::record;
use super::state::Known;
use crate::arguments::{On, StudyArguments};
use crate::fault::Usage;
use crate::print::quoted;

/// Folder of the output of the tasks.
pub const LOGS: &str = "logs";

/// The script that the batch system runs. Slurm keeps a copy; HyperQueue reads it when a task
/// starts, so that each of its jobs has its own.
const SCRIPT: &str = "job";

/// The longest time is this many forecasts, and at least this many minutes.
const TIMES: f64 = 3.0;
const MINUTES: f64 = 10.0;

/// The memory is this many forecasts, and so much for the program itself, MB.
const MEMORIES: f64 = 1.5;
const PROGRAM_MB: f64 = 300.0;

/// Time before the longest time at which Slurm tells a point to stop, s.
const NOTICE: u32 = 60;

/// Times that Slurm starts a point again by itself.
const RESTARTS: u32 = 10;

/// Largest size of a profile, bytes.
const LONGEST: u64 = 1 << 20;

/// A profile: what the jobs of a cluster need. Options of the command line come first.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct Profile {
    partition: Option<String>,
    account: Option<String>,
    time: Option<String>,
    memory: Option<String>,
    cores: Option<u16>,
    /// More options of `sbatch` or of `hq submit`, one a string.
    options: Vec<String>,
    /// Lines of shell before the program, as `module load ...`.
    setup: Vec<String>,
}

/// A job that is not submitted yet.
pub struct Job {
    pub points: Vec<usize>,
    name: String,
    profile: Profile,
    time: String,
    memory_mb: u64,
    cores: u16,
    /// At most so many points at once.
    at_once: Option<u16>,
    /// The command of a task, without the number of its point.
    command: String,
    folder: PathBuf,
}

impl Job {
    /// A job for these points; `folder`: of its script.
    pub fn new(
        points: &[usize],
        known: &[Known],
        arguments: &StudyArguments,
        folder: &Path,
    ) -> Result<Job> {
        let options = &arguments.batch;
        let mut profile = profile(arguments)?;
        let given = |option: &Option<String>, own: &mut Option<String>| {
            option.clone().or_else(|| own.take())
        };
        profile.partition = given(&options.partition, &mut profile.partition);
        let on_slurm = options.on == On::Slurm;
        if !on_slurm && (profile.partition.is_some() || profile.account.is_some()) {
            bail!(Usage(
                "HyperQueue has no partitions and accounts".to_string()
            ));
        }
        if !on_slurm && arguments.jobs.is_some() {
            let what =
                "--jobs: HyperQueue runs as many points at once as its workers have cores for";
            bail!(Usage(what.to_string()));
        }
        let cores = options.cores.or(profile.cores).unwrap_or(1);
        let needs = || points.iter().map(|point| &known[point - 1]);
        let seconds = needs().map(|known| known.seconds).fold(0.0, f64::max);
        let minutes = (TIMES * seconds / f64::from(cores) / 60.0)
            .max(MINUTES)
            .ceil();
        let memory = needs().map(|known| known.memory).fold(0.0, f64::max);
        let time = given(&options.time, &mut profile.time);
        let memory_mb = match given(&options.memory, &mut profile.memory) {
            Some(text) => megabytes(&text)?,
            None => (MEMORIES * memory / 1e6 + PROGRAM_MB).ceil() as u64,
        };
        let stem = arguments.study.file_stem().unwrap_or_default();
        Ok(Job {
            points: points.to_vec(),
            name: format!("coronet-{}", stem.to_string_lossy()),
            time: time.unwrap_or_else(|| match on_slurm {
                true => format!("{minutes}"),
                false => format!("{minutes}m"),
            }),
            profile,
            memory_mb,
            cores,
            at_once: arguments.jobs,
            command: command(arguments, cores)?,
            folder: std::path::absolute(folder)?,
        })
    }

    /// Writes the script and makes the folder of the output.
    pub fn write(&self, on: On) -> Result<PathBuf> {
        create_folder(&self.folder.join(LOGS))?;
        let (name, text) = match on {
            On::Slurm => (format!("{SCRIPT}.sh"), self.slurm()),
            _ => {
                let number = record::jobs(&self.folder)?.len() + 1;
                (format!("{SCRIPT}-{number}.sh"), self.hq())
            }
        };
        let path = self.folder.join(name);
        write_file(&path, text.as_bytes())?;
        Ok(path)
    }

    fn array(&self) -> String {
        let points: Vec<String> = self.points.iter().map(usize::to_string).collect();
        points.join(",")
    }

    fn logs(&self, name: &str) -> String {
        self.folder.join(LOGS).join(name).display().to_string()
    }

    /// The script for `sbatch`. A point stops after a checkpoint when its time is nearly over, and
    /// Slurm then starts it again; also one that was killed. One that was cancelled stays so.
    fn slurm(&self) -> String {
        let limit = self
            .at_once
            .map_or(String::new(), |most| format!("%{most}"));
        // Slurm fills in what begins with one %.
        let logs = self.logs("").replace('%', "%%");
        let mut options = vec![
            format!("--job-name={}", quoted(&self.name)),
            format!("--array={}{limit}", self.array()),
            format!("--output={}", quoted(&format!("{logs}%a.txt"))),
            "--open-mode=append".to_string(),
            "--requeue".to_string(),
            format!("--signal=B:USR1@{NOTICE}"),
            "--ntasks=1".to_string(),
            format!("--cpus-per-task={}", self.cores),
            format!("--mem={}M", self.memory_mb),
            format!("--time={}", self.time),
        ];
        let profile = &self.profile;
        options.extend(
            profile
                .partition
                .iter()
                .map(|name| format!("--partition={name}")),
        );
        options.extend(
            profile
                .account
                .iter()
                .map(|name| format!("--account={name}")),
        );
        options.extend(profile.options.iter().cloned());
        let options: String = options.iter().map(|o| format!("#SBATCH {o}\n")).collect();
        format!(
            "#!/bin/bash\n{options}\n{}\
             again=yes\n\
             asked=\n\
             trap 'asked=yes; kill -TERM \"$point\"' USR1\n\
             trap 'asked=yes; again=no' TERM\n\
             {} --point \"$SLURM_ARRAY_TASK_ID\" &\n\
             point=$!\n\
             wait \"$point\"; code=$?\n\
             while [ \"$asked\" ]; do asked=; wait \"$point\"; code=$?; done\n\
             case $again-$code in yes-130 | yes-137)\n    \
                 if [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt {RESTARTS} ]; then\n        \
                     scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID\"\n    \
                 fi\n\
             esac\n\
             exit $code\n",
            self.setup(),
            self.command,
        )
    }

    /// The script for `hq submit`, which starts points of a lost worker again by itself.
    fn hq(&self) -> String {
        let (setup, command) = (self.setup(), &self.command);
        format!("#!/bin/bash\n{setup}exec {command} --point \"$HQ_TASK_ID\"\n")
    }

    /// Options of `hq submit`.
    pub fn hq_options(&self) -> Vec<String> {
        let mut options = vec![
            format!("--name={}", self.name),
            format!("--array={}", self.array()),
            format!("--cpus={}", self.cores),
            format!("--resource=mem={}", self.memory_mb),
            format!("--time-limit={}", self.time),
            format!("--stdout={}", self.logs("%{TASK_ID}.txt")),
            format!("--stderr={}", self.logs("%{TASK_ID}.err.txt")),
        ];
        options.extend(self.profile.options.iter().cloned());
        options
    }

    fn setup(&self) -> String {
        let lines = self.profile.setup.iter();
        lines.map(|line| format!("{line}\n")).collect()
    }
}

fn read(path: &Path) -> Result<Profile> {
    let bytes = match coronet::file::read(path, LONGEST) {
        Err(error) if error.is_not_found() => bail!(Usage(error.to_string())),
        other => other?,
    };
    let text = String::from_utf8(bytes).map_err(|error| {
        let path = path.display();
        Usage(format!("{path}: {error}"))
    })?;
    Ok(file::parse(&text, path)?)
}

/// The command of a task; it starts in the folder of this command.
fn command(arguments: &StudyArguments, cores: u16) -> Result<String> {
    let program = std::env::current_exe().context("cannot find this program")?;
    let text = |path: &Path| path.display().to_string();
    let mut words = vec![text(&program), "study".to_string(), text(&arguments.study)];
    let mut add = |option: &str, value: String| words.extend([option.to_string(), value]);
    add("--artifacts", text(&arguments.store.artifacts));
    add("--cores", cores.to_string());
    if let Some(url) = arguments.remote.url() {
        add("--remote", url.to_string());
    }
    let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    Ok(words.join(" "))
}

/// The file of `--profile`.
fn profile(arguments: &StudyArguments) -> Result<Profile> {
    let path = arguments.batch.profile.as_deref();
    path.map_or_else(|| Ok(Profile::default()), read)
}

/// Memory of a job that an option or the profile states, bytes.
pub fn memory_asked(arguments: &StudyArguments) -> Result<Option<f64>> {
    let stated = profile(arguments)?.memory;
    let text = arguments.batch.memory.clone().or(stated);
    let bytes = |text: String| Ok(1e6 * megabytes(&text)? as f64);
    text.map(bytes).transpose()
}

/// MB of a size as `800M` or `4G`.
fn megabytes(text: &str) -> Result<u64> {
    let split = text.trim_end_matches(char::is_alphabetic);
    let factor = match &text[split.len()..] {
        "" | "M" | "MB" => Some(1),
        "G" | "GB" => Some(1000),
        "T" | "TB" => Some(1_000_000),
        _ => None,
    };
    let number = split.parse::<u64>().ok();
    let size = number
        .zip(factor)
        .and_then(|(number, factor)| number.checked_mul(factor));
    size.filter(|size| *size > 0).ok_or_else(|| {
        let what = format!("memory {text:?} is not a size; write `800M` or `4G`");
        Usage(what).into()
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn sizes_have_units() {
        assert_eq!(super::megabytes("800M").unwrap(), 800);
        assert_eq!(super::megabytes("4G").unwrap(), 4000);
        assert_eq!(super::megabytes("700").unwrap(), 700);
        for wrong in ["", "G", "4 K", "-1G", "0", "20000000000000000T"] {
            assert!(super::megabytes(wrong).is_err(), "{wrong}");
        }
    }
}
