//! The program: reads a pipeline file, brings its stages up to date, shows what was made.

mod arguments;
mod calibrate;
mod cost;
mod fault;
mod figures;
mod finding;
mod flight;
mod forecast;
mod impact;
mod inspect;
mod jobs;
mod journal;
mod keep;
mod pace;
mod pack;
mod plan;
mod points;
mod post;
mod probe;
mod promise;
mod relax;
mod run;
mod settings;
mod study;
mod target;
mod trial;
mod tune;
mod verdict;
mod watch;

use std::io::ErrorKind;
use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::Parser;

/// Name, version, commit and compiler, for stamps and logs; in no key and no digest.
pub const PROGRAM: &str = concat!(
    "coronet ",
    env!("CARGO_PKG_VERSION"),
    " (",
    env!("CORONET_BUILD"),
    ")"
);

/// File of a packed or relaxed body.
pub const BODY: &str = "body.checkpoint";

fn main() -> ExitCode {
    coronet::pipeline::machine::map_large_arrays();
    let done = match Arguments::parse().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Study(arguments) => study::study(&arguments),
        Command::Tune(arguments) => tune::tune(&arguments),
        Command::Plan(arguments) => plan::plan(&arguments),
        Command::Verify(arguments) => keep::verify(&arguments),
        Command::Gc(arguments) => keep::sweep(&arguments),
        Command::Show(arguments) => inspect::show(&arguments),
        Command::Export(arguments) => inspect::export(&arguments),
        Command::Recover(arguments) => inspect::recover(&arguments),
        Command::Schema => inspect::schema(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever reads our output has seen enough: `coronet show ... | head`.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", text(&error));
            ExitCode::from(fault::exit_code(&error))
        }
    }
}

/// The chain of causes, without those that their parent tells already.
fn text(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(|cause| cause.to_string()) {
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.downcast_ref::<std::io::Error>();
    io.is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
