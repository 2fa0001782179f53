//! Each file-system call of a command fails, with each error: nothing good is lost, success means
//! that the work was done, failure has code 5 and a message, and the same command then succeeds.

use crate::beginning::{At, Beginning, Beginnings, Name};
use crate::place::{self, Ended, Expected, Place, RUN};
use crate::report::{MISSED, Report, side_by_side};
use crate::trace::End;

const ERRORS: [(i32, &str); 4] = [
    (libc::EIO, "EIO"),
    (libc::ENOSPC, "ENOSPC"),
    (libc::EMFILE, "EMFILE"),
    (libc::EACCES, "EACCES"),
];

/// Exit code of a failure of files.
const FILES: End = End::Code(5);
const DONE: End = End::Code(0);

/// Calls whose failures were once handled wrongly: the mark of a new store, and the folder of a
/// stage. Each sample has them.
const WRONG: [&str; 3] = [
    "rename artifacts/.store.json.(temporary)",
    "write artifacts/.store.json.(temporary)",
    "statx artifacts/pack",
];

/// A call that fails.
struct Fault<'a> {
    beginning: &'a Beginning,
    call: &'a Name,
    error: (i32, &'static str),
    /// All later ones, too.
    stays: bool,
}

/// Every `stride`-th fault; panics with a table of what went wrong.
pub fn campaign(stride: usize) {
    let beginnings = Beginnings::new();
    let mut report = Report::new("failed calls");
    for beginning in &beginnings.all {
        let calls = beginning.calls();
        let mut faults = Vec::new();
        for call in &calls {
            for error in ERRORS {
                let once = Fault {
                    beginning,
                    call,
                    error,
                    stays: false,
                };
                faults.push(once);
            }
            // A disk that is gone stays so.
            faults.push(Fault {
                beginning,
                call,
                error: ERRORS[0],
                stays: true,
            });
        }
        let places = faults.iter().enumerate();
        let chosen = places.filter(|(at, fault)| at % stride == 0 || fault.went_wrong());
        let chosen: Vec<_> = chosen.map(|(_, fault)| fault).collect();
        let found = side_by_side(&chosen, |fault| fault.check(&beginnings.expected));
        report.count(beginning.name, calls.len(), chosen.len());
        for (fault, problem) in chosen.iter().zip(found) {
            report.add(beginning.name, &fault.title(), problem);
        }
    }
    report.end();
}

impl Fault<'_> {
    fn title(&self) -> String {
        let onwards = if self.stays { " and all later" } else { "" };
        let Name { call, before } = self.call;
        format!("{} {call} #{before}{onwards}", self.error.1)
    }

    fn went_wrong(&self) -> bool {
        self.call.before == 0 && WRONG.contains(&&self.call.call[..])
    }

    fn check(&self, expected: &Expected) -> Result<(), String> {
        let place = Place::of(&self.beginning.files);
        let folder = place.path();
        let mut watch = match self.stays {
            false => At::fail(&folder, self.call, self.error.0),
            true => At::fail_from(&folder, self.call, self.error.0),
        };
        let ended = place.watched(self.beginning.command, &mut watch);
        if !watch.reached {
            return Err(MISSED.to_string());
        }
        self.judge(&place, &ended, expected)?;
        if !self.beginning.runs() && self.beginning.name != "gc" {
            return Ok(());
        }
        let again = place.call(RUN);
        if again.end != DONE {
            let (end, err) = (again.end, last_line(&again.err));
            return Err(format!("afterwards, run ends with {end:?}: {err}"));
        }
        match place.lacks(&again, expected) {
            Some(what) => Err(format!("afterwards, {what}")),
            None => Ok(()),
        }
    }

    /// What a command that ended with success did not do.
    fn lacks(&self, place: &Place, ended: &Ended, expected: &Expected) -> Option<String> {
        let Beginning { out, names, .. } = self.beginning;
        match self.beginning.name {
            "gc" => {
                let left: Vec<_> = place.files().into_keys().collect();
                (left != *names).then(|| "not all is removed".to_string())
            }
            "plan" | "verify" => {
                (ended.out != *out).then(|| "it prints something else".to_string())
            }
            _ => place.lacks(ended, expected),
        }
    }

    /// What the faulty run did and left.
    fn judge(&self, place: &Place, ended: &Ended, expected: &Expected) -> Result<(), String> {
        if let Some(what) = ended.misbehaves() {
            return Err(what);
        }
        let aside = place.set_aside();
        if let Some(path) = aside.first() {
            return Err(format!("set aside: {}", path.display()));
        }
        let good = match self.beginning.name {
            "gc" => wanted(&self.beginning.files, expected),
            _ => place::finished(&self.beginning.files),
        };
        if let Some(what) = place::lost(&good, &place.files()) {
            return Err(format!("lost: {what}"));
        }
        if ended.end == DONE {
            return match self.lacks(place, ended, expected) {
                Some(what) => Err(format!("success without the work: {what}")),
                None => Ok(()),
            };
        }
        if ended.end != FILES {
            let (end, err) = (ended.end, last_line(&ended.err));
            return Err(format!("wrong end {end:?}: {err}"));
        }
        match ended.err.trim().is_empty() {
            true => Err("no message".to_string()),
            false => Ok(()),
        }
    }
}

/// Files of the results that `latest/` leads to.
fn wanted(files: &place::Files, expected: &Expected) -> place::Files {
    let finished = place::finished(files).into_iter();
    let leads = |path: &std::path::Path| expected.latest.values().any(|to| path.starts_with(to));
    finished.filter(|(path, _)| leads(path)).collect()
}

fn last_line(text: &str) -> &str {
    text.lines().last().unwrap_or_default()
}
