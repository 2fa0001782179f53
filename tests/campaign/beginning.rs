//! Stores from which commands start, and the calls that a command makes from there.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::place::{Expected, Files, GC, PLAN, Place, RUN, VERIFY};
use crate::trace::{Action, Call, End, Watch};

/// A command and the files that it starts from.
pub struct Beginning {
    pub name: &'static str,
    pub command: &'static [&'static str],
    pub files: Files,
    /// What the undisturbed command prints, and the names that it leaves.
    pub out: String,
    pub names: Vec<PathBuf>,
}

/// The beginnings of all campaigns, and what an undisturbed run leaves.
pub struct Beginnings {
    pub all: Vec<Beginning>,
    pub expected: Expected,
}

/// A call by what it is about, so that it is found again though threads take turns: name, path
/// from the folder of the run, and how many of that name and path came before.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Name {
    pub call: String,
    pub before: usize,
}

/// Gives calls their names.
#[derive(Default)]
pub struct Namer {
    seen: HashMap<String, usize>,
}

impl Namer {
    pub fn name(&mut self, call: &Call, folder: &Path) -> Name {
        let path = call.path.strip_prefix(folder).unwrap_or(&call.path);
        let call = format!("{} {}", call.name, without_chance(path, call.process));
        let count = self.seen.entry(call.clone()).or_default();
        *count += 1;
        Name {
            call,
            before: *count - 1,
        }
    }
}

/// A path without what differs from run to run: the process and the count in temporary names, and
/// steps, for checkpoints in flight are written by the clock.
fn without_chance(path: &Path, process: i32) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = match name.split_once(&format!(".{process}")) {
        Some((before, _)) if name.starts_with('.') => format!("{before}.(temporary)"),
        _ if name.len() == KEY => name.into_owned(),
        _ => name.replace(|c: char| c.is_ascii_digit(), ""),
    };
    path.with_file_name(name).display().to_string()
}

/// Digits of a key.
const KEY: usize = 64;

/// Lists calls.
struct List<'a> {
    folder: &'a Path,
    namer: Namer,
    names: Vec<Name>,
}

impl Watch for List<'_> {
    fn before(&mut self, call: &Call) -> Action {
        self.names.push(self.namer.name(call, self.folder));
        Action::Pass
    }
}

/// Does something at the call of one name.
pub struct At<'a> {
    folder: &'a Path,
    name: &'a Name,
    namer: Namer,
    /// The error, or none to kill the program.
    error: Option<i32>,
    /// Whether all later calls fail, too.
    stays: bool,
    /// Whether the call came.
    pub reached: bool,
}

impl<'a> At<'a> {
    pub fn fail(folder: &'a Path, name: &'a Name, error: i32) -> Self {
        At {
            folder,
            name,
            namer: Namer::default(),
            error: Some(error),
            stays: false,
            reached: false,
        }
    }

    /// From this call on, all fail.
    pub fn fail_from(folder: &'a Path, name: &'a Name, error: i32) -> Self {
        let stays = true;
        At {
            stays,
            ..At::fail(folder, name, error)
        }
    }

    pub fn kill(folder: &'a Path, name: &'a Name) -> Self {
        let error = None;
        At {
            error,
            ..At::fail(folder, name, 0)
        }
    }
}

impl Watch for At<'_> {
    fn before(&mut self, call: &Call) -> Action {
        let here = self.namer.name(call, self.folder) == *self.name;
        self.reached |= here;
        if !(here || self.stays && self.reached) {
            return Action::Pass;
        }
        match self.error {
            Some(error) => Action::Fail(error),
            None => Action::Kill,
        }
    }
}

impl Beginning {
    fn new(name: &'static str, command: &'static [&'static str], files: &Files) -> Self {
        let place = Place::of(files);
        let ended = place.call(command);
        assert_eq!(
            ended.end,
            End::Code(0),
            "{name}: {}{}",
            ended.out,
            ended.err
        );
        Beginning {
            name,
            command,
            files: files.clone(),
            out: ended.out,
            names: place.files().into_keys().collect(),
        }
    }

    /// The calls of the undisturbed command, in order.
    pub fn calls(&self) -> Vec<Name> {
        let place = Place::of(&self.files);
        let folder = place.path();
        let mut list = List {
            folder: &folder,
            namer: Namer::default(),
            names: Vec::new(),
        };
        let ended = place.watched(self.command, &mut list);
        assert_eq!(ended.end, End::Code(0), "{}: {}", self.name, ended.err);
        list.names
    }

    /// Whether it is the command that makes everything.
    pub fn runs(&self) -> bool {
        self.command == RUN
    }
}

impl Beginnings {
    pub fn new() -> Self {
        let place = Place::new();
        let ended = place.call(RUN);
        assert_eq!(ended.end, End::Code(0), "{}{}", ended.out, ended.err);
        let expected = Expected {
            digests: ended.digests(),
            latest: place.latest(),
        };
        assert_eq!(expected.digests.len(), 6, "{expected:?}");
        assert_eq!(expected.latest.len(), 6, "{expected:?}");
        let lacks = place.lacks(&ended, &expected);
        assert_eq!(lacks, None);
        let finished = place.files();
        let beginning = Beginning::new;
        let all = vec![
            beginning("run, from nothing", RUN, &Place::new().files()),
            beginning("run, after a kill", RUN, &half_finished()),
            beginning("run, all finished", RUN, &finished),
            beginning("plan", PLAN, &finished),
            beginning("verify", VERIFY, &finished),
            beginning("gc", GC, &with_garbage()),
        ];
        Beginnings { all, expected }
    }
}

/// A store whose impact was killed with checkpoints in flight.
fn half_finished() -> Files {
    let place = Place::new();
    let folder = place.path();
    let mut killer = KillInFlight { checkpoints: 0 };
    let ended = place.watched(RUN, &mut killer);
    assert!(matches!(ended.end, End::Signal(_)), "{ended:?}");
    let files = place.files();
    let in_flight = |path: &&std::path::PathBuf| {
        path.to_string_lossy().contains("/work/")
            && path.extension().is_some_and(|e| e == "checkpoint")
    };
    let count = files.keys().filter(in_flight).count();
    assert!(
        count >= 2,
        "{count} checkpoints in flight in {}",
        folder.display()
    );
    files
}

/// Kills the program when it gives the third checkpoint in flight of the impact its name.
struct KillInFlight {
    checkpoints: usize,
}

impl Watch for KillInFlight {
    fn before(&mut self, call: &Call) -> Action {
        let to = call.to.as_ref().map(|to| to.to_string_lossy());
        let of_impact = to.is_some_and(|to| {
            call.name.starts_with("rename")
                && to.contains("/impact/")
                && to.contains("/work/")
                && to.ends_with(".checkpoint")
        });
        self.checkpoints += usize::from(of_impact);
        match self.checkpoints {
            0..3 => Action::Pass,
            _ => Action::Kill,
        }
    }
}

/// A finished store with results that no pipeline reaches any more.
fn with_garbage() -> Files {
    let place = Place::new();
    let other = [RUN, &["--set", "pack.spacing=0.5 mm", "--until", "pack"]].concat();
    for command in [other.as_slice(), RUN] {
        let ended = place.call(command);
        assert_eq!(ended.end, End::Code(0), "{}{}", ended.out, ended.err);
    }
    place.files()
}
