//! The program under test, in a folder of its own.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

/// The scene of these tests.
pub const TINY: &str = include_str!("tiny.toml");

/// A folder with a pipeline file and a store, and the program to run there.
pub struct Program {
    pub folder: TempDir,
}

/// What a run ended with.
pub struct Ended {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Ended {
    /// The JSON objects of standard output.
    pub fn objects(&self) -> Vec<Value> {
        let parse = |line: &str| serde_json::from_str(line).expect(line);
        self.out.lines().map(parse).collect()
    }

    /// Fails unless the program ended well.
    pub fn well(self) -> Self {
        assert_eq!(self.code, Some(0), "{}{}", self.out, self.err);
        self
    }

    /// Fails unless the program ended with `code` and an explanation that names all of `words`,
    /// without a panic.
    pub fn badly(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self.no_panic();
        for word in words {
            assert!(self.err.contains(word), "no {word:?} in: {}", self.err);
        }
    }

    pub fn no_panic(&self) {
        assert!(!self.err.contains("panicked"), "{}", self.err);
    }
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        Ended {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// Has a command hear the signals that whoever started these tests may have had ignored.
pub fn hearing(command: &mut Command) -> &mut Command {
    let hear = || {
        for signal in [libc::SIGINT, libc::SIGHUP, libc::SIGTERM] {
            // SAFETY: sets a disposition of the new process, which runs nothing of its own yet.
            if unsafe { libc::signal(signal, libc::SIG_DFL) } == libc::SIG_ERR {
                return Err(std::io::Error::last_os_error());
            }
        }
        Ok(())
    };
    // SAFETY: `hear` only makes system calls.
    unsafe { command.pre_exec(hear) }
}

/// The program; `CORONET` names another build, behind what emulates its processor.
fn program() -> Command {
    let Ok(other) = std::env::var("CORONET") else {
        return Command::new(env!("CARGO_BIN_EXE_coronet"));
    };
    let mut words = other.split(' ');
    let mut command = Command::new(words.next().unwrap());
    command.args(words);
    command
}

impl Program {
    /// With [`TINY`] as `tiny.toml`.
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("tiny.toml"), TINY).unwrap();
        Program { folder }
    }

    /// With one more file.
    pub fn with(name: &str, text: &str) -> Self {
        let program = Program::new();
        fs::write(program.path(name), text).unwrap();
        program
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = program();
        command.current_dir(self.folder.path()).args(arguments);
        command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    pub fn call(&self, arguments: &[&str]) -> Ended {
        self.command(arguments).output().unwrap().into()
    }

    pub fn start(&self, arguments: &[&str]) -> Child {
        hearing(&mut self.command(arguments)).spawn().unwrap()
    }

    /// `coronet run tiny.toml --json` with more arguments; must end well.
    pub fn run(&self, more: &[&str]) -> Vec<Value> {
        let arguments = [&["run", "tiny.toml", "--json"], more].concat();
        self.call(&arguments).well().objects()
    }

    /// `coronet plan tiny.toml --json` with more arguments.
    pub fn plan(&self, more: &[&str]) -> Vec<Value> {
        let arguments = [&["plan", "tiny.toml", "--json"], more].concat();
        self.call(&arguments).well().objects()
    }

    /// Waits until the impact of a running `child` has written a checkpoint in flight; returns the
    /// work folder.
    pub fn in_flight(&self, child: &mut Child) -> PathBuf {
        let is_checkpoint = |path: PathBuf| path.extension().is_some_and(|e| e == "checkpoint");
        let list = |folder: PathBuf| fs::read_dir(folder).into_iter().flatten().flatten();
        loop {
            for entry in list(self.path("artifacts/impact")) {
                let work = entry.path().join("work");
                if list(work.clone()).any(|entry| is_checkpoint(entry.path())) {
                    return work.canonicalize().unwrap();
                }
            }
            assert!(
                child.try_wait().unwrap().is_none(),
                "it ended without a checkpoint"
            );
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Folder of the newest result of that name: `impact`, `pack-drop`.
    pub fn latest(&self, name: &str) -> PathBuf {
        let link = self.path("artifacts/latest/tiny").join(name);
        link.canonicalize()
            .unwrap_or_else(|error| panic!("{}: {error}", link.display()))
    }
}

/// Copies a file that will be executed, by another process: what this one has open for writing
/// while another test starts a program cannot be executed until that has started.
pub fn install(from: &Path, to: &Path) {
    let mut command = Command::new("install");
    let done = command.args(["-m", "755"]).arg(from).arg(to).status();
    assert!(done.unwrap().success(), "{}", to.display());
}

/// `relax drop` or `impact`, from an object of a run or a plan.
pub fn label(object: &Value) -> String {
    let part = |name: &str| object[name].as_str().unwrap_or_default();
    format!("{} {}", part("stage"), part("body"))
        .trim()
        .to_string()
}

/// One member of each job's object, by label; the last object of a job counts.
pub fn members(objects: &[Value], member: &str) -> BTreeMap<String, String> {
    let jobs = objects.iter().filter(|object| object["stage"].is_string());
    let text = |value: &Value| value.as_str().map_or(value.to_string(), str::to_string);
    jobs.map(|object| (label(object), text(&object[member])))
        .collect()
}

/// What must not depend on kills, threads or detours: digest of every result, of state, frames and
/// of the measures.
pub fn fingerprint(objects: &[Value]) -> BTreeMap<String, String> {
    let mut all = members(objects, "digest");
    let summary = objects.last().expect("a run prints a summary");
    for name in ["state", "frames", "measures"] {
        let path = summary[name]
            .as_str()
            .unwrap_or_else(|| panic!("no {name}: {summary}"));
        all.insert(name.to_string(), content(Path::new(path)));
    }
    all
}

/// Digest of what a file holds. Paths in the program's output are relative to its folder, so the
/// caller resolves them, see [`Program::fingerprint`].
fn content(path: &Path) -> String {
    let digest = coronet::pipeline::content::content(path);
    digest
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .to_string()
}

impl Program {
    /// [`fingerprint`] of a run in this folder.
    pub fn fingerprint(&self, objects: &[Value]) -> BTreeMap<String, String> {
        let mut objects = objects.to_vec();
        let summary = objects.last_mut().expect("a run prints a summary");
        for name in ["state", "frames", "measures"] {
            if let Some(path) = summary[name].as_str() {
                summary[name] = Value::from(self.path(path).display().to_string());
            }
        }
        fingerprint(&objects)
    }
}
