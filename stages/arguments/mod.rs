//! Arguments of the command line.

mod cluster;
mod output;
mod parse;

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};

pub use cluster::{BatchArguments, On, PushArguments, RemoteArguments};
pub use output::{ExportArguments, Format, Material, RenderArguments};

use crate::command::{export, render};

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a stage failed for another reason
  2    wrong arguments, a mistake in the pipeline file, or no such file, name or run
  3    the physics went wrong (diverged); the last good checkpoint is kept
  4    results cannot be trusted: damaged files (verify), or one key with two results
  5    files cannot be read or written: no space, no permission, read-only, an error of the disk;
       nothing is set aside or removed. Standard output counts, unless its reader has gone
  6    in use by another process (gc)
  130  stopped by Ctrl-C or a termination signal after a checkpoint; the same command continues";

/// Output of `--version` after the name of the program.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("CORONET_BUILD"), ")");

/// Drop impact on a pool, a wall or another drop, with particles, as a resumable pipeline.
#[derive(Debug, Parser)]
#[command(version = VERSION, after_help = EXIT_CODES, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Bring all results of a pipeline up to date, continuing where an earlier run ended
    #[command(after_help = EXIT_CODES)]
    Run(RunArguments),
    /// Run a table of settings over one store; write the cost of accuracy in time
    #[command(after_help = EXIT_CODES)]
    Study(StudyArguments),
    /// Name the cheapest settings of a study that meet an error, as a command
    #[command(after_help = EXIT_CODES)]
    Tune(TuneArguments),
    /// Show what would run, why, and about how long it would take
    Plan(PlanArguments),
    /// Put finished results into a remote store
    #[command(after_help = EXIT_CODES)]
    Push(PushArguments),
    /// Bring the results of a pipeline from a remote store; make nothing
    #[command(after_help = EXIT_CODES)]
    Pull(RunArguments),
    /// Hash all finished results again; set damaged files aside, so that `run` regenerates them
    Verify(StoreArguments),
    /// Remove unused results; finished ones only by age or name
    #[command(after_help = EXIT_CODES)]
    Gc(SweepArguments),
    /// List the runs of a store: their progress, their figures, the settings in which they differ
    List(StoreArguments),
    /// Compare two runs: settings that differ, figures, curves
    Diff(DiffArguments),
    /// Show the jobs in progress and the interrupted ones, from another terminal
    Status(StatusArguments),
    /// Show the content of a checkpoint, a log or a result
    Show(ShowArguments),
    /// Write a checkpoint or the frames of a run in a format for other programs
    #[command(after_help = export::EXAMPLES)]
    Export(ExportArguments),
    /// Draw the liquid surface of a run: a picture, a film, or a mesh
    #[command(after_help = render::EXAMPLES)]
    Render(RenderArguments),
    /// Save the complete frames of a log that was cut off or damaged
    Recover(RecoverArguments),
    /// Write a commented scene to start from
    Init(InitArguments),
    /// Print the JSON schema of pipeline files or of study files, for editors
    Schema(SchemaArguments),
    /// Print the completions of the commands for a shell
    #[command(after_help = "As in: coronet completions bash > \
                            ~/.local/share/bash-completion/completions/coronet")]
    Completions(CompletionsArguments),
    /// Write the manual pages into a folder
    Man(ManArguments),
}

#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Kind of file
    #[arg(value_enum, default_value_t)]
    pub of: FileKind,
    /// Print a page of all settings of a pipeline file in Markdown, in place of the JSON schema
    #[arg(long)]
    pub markdown: bool,
}

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct ManArguments {
    #[arg(default_value = ".")]
    pub folder: PathBuf,
}

/// Files that have a schema.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum FileKind {
    #[default]
    Pipeline,
    Study,
}

impl Command {
    /// Whether the output of the command, or of processes that it starts, is JSON.
    pub fn writes_json(&self) -> bool {
        match self {
            Command::Run(arguments) | Command::Pull(arguments) => arguments.store.json,
            Command::Push(arguments) => arguments.store.json,
            Command::Plan(arguments) => arguments.store.json,
            Command::Verify(arguments) => arguments.json,
            Command::Gc(arguments) => arguments.store.json,
            Command::List(arguments) => arguments.json,
            Command::Diff(arguments) => arguments.store.json,
            Command::Status(arguments) => arguments.store.json,
            Command::Show(arguments) => arguments.json,
            Command::Export(arguments) => arguments.store.json,
            Command::Recover(arguments) => arguments.json,
            Command::Render(arguments) => arguments.store.json,
            Command::Study(_) | Command::Tune(_) => true,
            Command::Init(_) | Command::Schema(_) | Command::Completions(_) | Command::Man(_) => {
                false
            }
        }
    }
}

#[derive(Debug, Args)]
pub struct PipelineArguments {
    /// The pipeline file
    #[arg(default_value = "pipeline.toml")]
    pub pipeline: PathBuf,
    /// Override a setting, as `--set body.drop.velocity="2.42 m/s"`; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

#[derive(Debug, Args)]
pub struct StoreArguments {
    /// Folder of all results
    #[arg(long, value_name = "DIR", default_value = "artifacts")]
    pub artifacts: PathBuf,
    /// One JSON object per line on standard output, for scripts
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct RunArguments {
    #[command(flatten)]
    pub pipeline: PipelineArguments,
    #[command(flatten)]
    pub store: StoreArguments,
    /// Name of the results under `latest/` [default: that of the file; with --set the results also
    /// keep a name of their own, as `pipeline,body.drop.velocity=2.42_m_s`]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Run only this stage and the stages that it needs
    #[arg(long, value_name = "STAGE")]
    pub until: Option<String>,
    /// Threads; results do not depend on their number [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub remote: RemoteArguments,
    /// Show the impact while it runs to Foxglove and Lichtblick, at a WebSocket of this machine or
    /// at another address, as `--live=0.0.0.0:8765`
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true,
          default_missing_value = crate::live::ADDRESS)]
    pub live: Option<String>,
    /// Stop after a checkpoint when standard input ends: a study holds it open
    #[arg(long, hide = true)]
    pub stop_at_end_of_input: bool,
}

#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The study file (see `scenes/study/`)
    pub study: PathBuf,
    #[command(flatten)]
    pub store: StoreArguments,
    /// Points to run in parallel [default: one, which gets all cores; on a cluster all]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    #[command(flatten)]
    pub remote: RemoteArguments,
    #[command(flatten)]
    pub batch: BatchArguments,
    /// Also write table and plots into this folder, the table with lines that give its origin
    #[arg(long, value_name = "DIR")]
    pub into: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct TuneArguments {
    /// The study file; points that have not run yet run first
    pub study: PathBuf,
    /// Largest error
    #[arg(long, value_name = "PART", default_value = "5 %")]
    pub error: String,
    /// Run the chosen settings and compare
    #[arg(long)]
    pub check: bool,
    /// Write a pipeline file with the chosen settings; paths in it stay as they were
    #[arg(long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub store: StoreArguments,
    /// Points to run in parallel; they share the cores
    #[arg(long, default_value_t = 1, value_parser = value_parser!(u16).range(1..))]
    pub jobs: u16,
    #[command(flatten)]
    pub remote: RemoteArguments,
}

#[derive(Debug, Args)]
pub struct PlanArguments {
    #[command(flatten)]
    pub pipeline: PipelineArguments,
    /// Also forecast a run on so many processes of MPI, each with the threads of this one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub ranks: Option<u32>,
    #[command(flatten)]
    pub store: StoreArguments,
}

#[derive(Debug, Args)]
pub struct SweepArguments {
    /// Pipeline files whose results also stay, besides those in `artifacts/latest/`
    pub pipelines: Vec<PathBuf>,
    /// Remove finished results that are older than this and that no name in `latest/` reaches,
    /// as `30days` or `12h`; without it, finished results stay
    #[arg(long, value_name = "AGE", value_parser = humantime::parse_duration)]
    pub older_than: Option<Duration>,
    /// With --older-than: also stopped runs of that age that have checkpoints
    #[arg(long, requires = "older_than")]
    pub unfinished: bool,
    /// Forget this name, or all points of this study, and remove the results that only they reach;
    /// repeatable
    #[arg(long, value_name = "NAME")]
    pub forget: Vec<String>,
    /// Continue even if no name in `latest/` reaches a result
    #[arg(long)]
    pub without_names: bool,
    /// Only show what would be removed
    #[arg(long)]
    pub dry_run: bool,
    /// Remove without the question that is asked on a terminal
    #[arg(long, short)]
    pub yes: bool,
    #[command(flatten)]
    pub store: StoreArguments,
}

#[derive(Debug, Args)]
pub struct DiffArguments {
    /// A name in `latest/`, or the folder of a result or of a pipeline's latest results
    pub first: String,
    /// Another one
    pub second: String,
    #[command(flatten)]
    pub store: StoreArguments,
}

#[derive(Debug, Args)]
pub struct StatusArguments {
    /// Show them again and again until no job is under way: every second on a terminal
    #[arg(long)]
    pub watch: bool,
    #[command(flatten)]
    pub store: StoreArguments,
}

#[derive(Debug, Args)]
pub struct InitArguments {
    /// Name of the scene, see --list
    #[arg(default_value = "default")]
    pub name: String,
    /// The new file [default: `pipeline.toml` for the default scene, else `NAME.toml`]
    pub path: Option<PathBuf>,
    /// List the scenes that there are
    #[arg(long)]
    pub list: bool,
}

#[derive(Debug, Args)]
pub struct ShowArguments {
    /// A name in `latest/`, a checkpoint, a log, or the folder of a result or of a run
    #[arg(value_name = "RUN")]
    pub path: PathBuf,
    /// Folder of all results
    #[arg(long, value_name = "DIR", default_value = "artifacts")]
    pub artifacts: PathBuf,
    /// One JSON object on standard output for each result, for scripts
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct RecoverArguments {
    /// The log
    pub log: PathBuf,
    /// The new log; a file of that name is replaced only if it is empty or a log of Coronet
    /// [default: `<log>-recovered.mcap` beside it]
    pub output: Option<PathBuf>,
    /// One JSON object on standard output, for scripts
    #[arg(long)]
    pub json: bool,
}
