//! A folder with the smallest scene and a store, the program to run there, and what must hold.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::trace::{self, Action, Call, End, Watch};

pub const SCENE: &str = include_str!("smallest.toml");
/// The command that makes everything; on one thread, so that calls come in about the same order.
pub const RUN: &[&str] = &["run", "smallest.toml", "--json", "--threads", "1"];
pub const VERIFY: &[&str] = &["verify", "--json"];
/// Removes all that no name reaches.
pub const GC: &[&str] = &["gc", "--json", "--yes", "--older-than", "0s"];
pub const PLAN: &[&str] = &["plan", "smallest.toml", "--json"];

/// No command takes longer, unless it hangs.
const LIMIT: Duration = Duration::from_secs(30);

/// A folder for one run of the program.
pub struct Place {
    folder: TempDir,
}

/// How a run ended and what it printed.
#[derive(Debug)]
pub struct Ended {
    pub end: End,
    pub out: String,
    pub err: String,
}

/// What a store must hold: the digest of each result, the names under `latest/` and where they
/// lead.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Expected {
    pub digests: BTreeMap<String, String>,
    pub latest: BTreeMap<PathBuf, PathBuf>,
}

/// Bytes of files, by path; of a link, where it leads.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Lets every call pass.
pub struct Unwatched;

impl Watch for Unwatched {
    fn before(&mut self, _call: &Call) -> Action {
        Action::Pass
    }
}

impl Place {
    /// With the scene and nothing else.
    pub fn new() -> Self {
        let folder = match Path::new("/dev/shm").is_dir() {
            true => TempDir::new_in("/dev/shm"),
            false => TempDir::new(),
        };
        let folder = folder.expect("a folder for temporary files");
        for inside in ["run", "output"] {
            fs::create_dir(folder.path().join(inside)).expect("it is new");
        }
        let place = Place { folder };
        fs::write(place.path().join("smallest.toml"), SCENE).expect("there is space");
        place
    }

    /// With the files of another place.
    pub fn of(files: &Files) -> Self {
        let place = Place::new();
        write(&place.path(), files);
        place
    }

    /// Where the program runs.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join("run")
    }

    pub fn store(&self) -> PathBuf {
        self.path().join("artifacts")
    }

    /// Runs the program under `watch`.
    pub fn watched(&self, arguments: &[&str], watch: &mut dyn Watch) -> Ended {
        let output = |name: &str| self.folder.path().join("output").join(name);
        let file = |name: &str| fs::File::create(output(name)).expect("there is space");
        let mut command = Command::new(env!("CARGO_BIN_EXE_coronet"));
        command.current_dir(self.path()).args(arguments);
        command.stdin(Stdio::null());
        command.stdout(file("out")).stderr(file("err"));
        let end = trace::run(command, &self.path(), LIMIT, watch);
        let text = |name: &str| {
            let bytes = fs::read(output(name)).expect("it was made above");
            String::from_utf8_lossy(&bytes).into_owned()
        };
        Ended {
            end,
            out: text("out"),
            err: text("err"),
        }
    }

    pub fn call(&self, arguments: &[&str]) -> Ended {
        self.watched(arguments, &mut Unwatched)
    }

    /// All files below the folder of the run.
    pub fn files(&self) -> Files {
        let mut files = Files::new();
        read(&self.path(), &self.path(), &mut files);
        files
    }

    /// Where the names under `latest/` lead, from there.
    pub fn latest(&self) -> BTreeMap<PathBuf, PathBuf> {
        let folder = self.store().join("latest/smallest");
        let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
        let links = entries.filter(|entry| entry.path().is_symlink());
        let leads = links.filter_map(|entry| {
            let to = fs::canonicalize(entry.path()).ok()?;
            let to = to.strip_prefix(self.path()).ok()?.to_path_buf();
            Some((PathBuf::from(entry.file_name()), to))
        });
        leads.collect()
    }

    /// Whether a run that ended with success did its work.
    pub fn lacks(&self, ended: &Ended, expected: &Expected) -> Option<String> {
        let digests = ended.digests();
        if digests != expected.digests {
            return Some(format!("other digests: {digests:?}"));
        }
        let latest = self.latest();
        if latest != expected.latest {
            return Some(differences(&expected.latest, &latest));
        }
        let verified = self.call(VERIFY);
        (verified.end != End::Code(0)).then(|| format!("verify: {}{}", verified.out, verified.err))
    }

    /// Names of files that were set aside as damaged.
    pub fn set_aside(&self) -> Vec<PathBuf> {
        let bad = |path: &PathBuf| {
            let name = path.file_name().and_then(OsStr::to_str);
            name.is_some_and(|name| name.contains(".bad-"))
        };
        self.files().into_keys().filter(bad).collect()
    }
}

impl Ended {
    /// Digest of each result, from the objects of `run --json`.
    pub fn digests(&self) -> BTreeMap<String, String> {
        let objects = self
            .out
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok());
        let digest = |object: Value| {
            let text = |name: &str| object[name].as_str().map(str::to_string);
            Some((
                format!("{} {}", text("stage")?, text("body")?),
                text("digest")?,
            ))
        };
        objects.filter_map(digest).collect()
    }

    /// What the program must never do, however the calls end.
    pub fn misbehaves(&self) -> Option<String> {
        match self.end {
            End::Hang => Some("it hangs".to_string()),
            End::Signal(signal) => Some(format!("it dies of signal {signal}")),
            End::Code(_) if self.err.contains("panicked") => Some(format!("panic: {}", self.err)),
            _ => None,
        }
    }
}

/// How the names under `latest/` differ.
fn differences(
    expected: &BTreeMap<PathBuf, PathBuf>,
    found: &BTreeMap<PathBuf, PathBuf>,
) -> String {
    let lacks = expected
        .iter()
        .any(|(name, to)| found.get(name) != Some(to));
    match lacks {
        true => "latest/ lacks names".to_string(),
        false => "latest/ has other names".to_string(),
    }
}

/// Files that belong to finished results: those below a folder with a stamp.
pub fn finished(files: &Files) -> Files {
    let stamps = files.keys().filter(|path| path.ends_with("stamp.json"));
    let folders: Vec<_> = stamps.filter_map(|path| path.parent()).collect();
    let belongs = |path: &Path| {
        let outside = path.components().any(|part| part.as_os_str() == "work");
        !outside && !path.ends_with("lock") && folders.iter().any(|f| path.starts_with(f))
    };
    let files = files.iter().filter(|(path, _)| belongs(path));
    files
        .map(|(path, bytes)| (path.clone(), bytes.clone()))
        .collect()
}

/// The first of `files` that is not, or not the same, among `found`.
pub fn lost(files: &Files, found: &Files) -> Option<String> {
    files
        .iter()
        .find_map(|(path, bytes)| match found.get(path) {
            Some(found) if found == bytes => None,
            Some(_) => Some(format!("{} has changed", path.display())),
            None => Some(format!("{} is gone", path.display())),
        })
}

fn read(root: &Path, folder: &Path, files: &mut Files) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = path.strip_prefix(root).expect("below it").to_path_buf();
        let kind = entry.file_type().expect("it is there");
        if kind.is_dir() {
            read(root, &path, files);
        } else if kind.is_symlink() {
            let to = fs::read_link(&path).expect("it is there");
            files.insert(name, [b"-> ", to.as_os_str().as_encoded_bytes()].concat());
        } else {
            files.insert(name, fs::read(&path).expect("it can be read"));
        }
    }
}

fn write(root: &Path, files: &Files) {
    for (name, bytes) in files {
        let path = root.join(name);
        fs::create_dir_all(path.parent().expect("below the root")).expect("there is space");
        match bytes.strip_prefix(b"-> ") {
            Some(to) => {
                let to = std::str::from_utf8(to).expect("plain names");
                std::os::unix::fs::symlink(to, &path).expect("there is space");
            }
            None => fs::write(&path, bytes).expect("there is space"),
        }
    }
}
