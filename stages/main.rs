//! The program: reads a pipeline file, brings its stages up to date, shows the results.

mod answer;
mod arguments;
mod batch;
mod body;
mod calibrate;
mod command;
mod fault;
mod flight;
mod forecast;
mod impact;
mod jobs;
mod journal;
mod live;
mod pace;
mod pack;
mod post;
mod print;
mod probe;
mod ranks;
mod relax;
mod remote;
mod runs;
mod settings;
mod signals;
mod stop;
mod study;
mod table;
mod watch;

use std::process::ExitCode;

use anyhow::Result;
use arguments::{Arguments, Command};
use clap::parser::ValueSource;
use clap::{ArgMatches, CommandFactory as _, FromArgMatches as _};

/// Name, version, commit and compiler, for stamps and logs; in no key and no digest.
pub const PROGRAM: &str = concat!(
    "coronet ",
    env!("CARGO_PKG_VERSION"),
    " (",
    env!("CORONET_BUILD"),
    ")"
);

fn main() -> ExitCode {
    coronet::pipeline::machine::map_large_arrays();
    let parsed = Arguments::command().try_get_matches().and_then(|found| {
        let arguments = Arguments::from_arg_matches(&found)?;
        Ok((arguments, found))
    });
    let (arguments, found) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return help(&error),
    };
    let done = signals::leave_sizes_to_writers()
        .and_then(|()| check(&arguments.command, &found))
        .and_then(|()| ranks::join())
        .and_then(|()| obey(&arguments.command));
    ranks::leave();
    let code = match &done {
        Ok(()) => 0,
        Err(error) => {
            print::note!("error: {}", text(error));
            fault::exit_code(error)
        }
    };
    match print::failure() {
        Some(error) if code == 0 => {
            print::note!("error: cannot write to standard output: {error}");
            ExitCode::from(fault::FILES)
        }
        _ => ExitCode::from(code),
    }
}

/// Prints a help text, or the mistake in the arguments.
fn help(error: &clap::Error) -> ExitCode {
    match (error.print(), error.use_stderr()) {
        (_, true) => ExitCode::from(fault::USAGE),
        (Err(failed), _) if failed.kind() != std::io::ErrorKind::BrokenPipe => {
            ExitCode::from(fault::FILES)
        }
        _ => ExitCode::SUCCESS,
    }
}

fn obey(command: &Command) -> Result<()> {
    let runs = matches!(command, Command::Run(_));
    if ranks::world().is_some() && !runs {
        return Err(fault::Usage(
            "mpirun: several processes can only share `coronet run`".to_string(),
        )
        .into());
    }
    match command {
        Command::Run(arguments) => command::run::run(arguments),
        Command::Push(arguments) => command::push::push(arguments),
        Command::Pull(arguments) => command::run::pull(arguments),
        Command::Study(arguments) => command::study::study(arguments),
        Command::Tune(arguments) => command::tune::tune(arguments),
        Command::Plan(arguments) => command::plan::plan(arguments),
        Command::Verify(arguments) => command::verify::verify(arguments),
        Command::Gc(arguments) => command::gc::sweep(arguments),
        Command::List(arguments) => command::list::list(arguments),
        Command::Diff(arguments) => command::diff::diff(arguments),
        Command::Status(arguments) => command::status::status(arguments),
        Command::Init(arguments) => command::init::init(arguments),
        Command::Show(arguments) => command::show::show(arguments),
        Command::Export(arguments) => command::export::export(arguments),
        Command::Render(arguments) => command::render::render(arguments),
        Command::Recover(arguments) => command::recover::recover(arguments),
        Command::Schema(arguments) => command::schema::schema(arguments),
        Command::Completions(arguments) => command::completions::completions(arguments.shell),
        Command::Man(arguments) => command::man::pages(&arguments.folder),
    }
}

/// JSON is UTF-8, and so are the answers of the points of a study: other paths cannot be used
/// there. What a rendered file does not show must not be asked for.
fn check(command: &Command, found: &ArgMatches) -> Result<()> {
    let odd = std::env::args_os().find(|argument| argument.to_str().is_none());
    if let Some(argument) = odd.filter(|_| command.writes_json()) {
        let text = format!(
            "{argument:?} is not UTF-8, which JSON and studies need; rename it, or leave out --json"
        );
        return Err(fault::Usage(text).into());
    }
    let given = |name: &str| {
        let (_, found) = found.subcommand().expect("a command was found");
        found.value_source(name) == Some(ValueSource::CommandLine)
    };
    match command {
        Command::Render(arguments) => command::render::check(arguments, given),
        _ => Ok(()),
    }
}

/// The chain of causes, without those that their parent contains already.
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
