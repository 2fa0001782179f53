//! The program is killed before each file-system call of a command: the same command then gives
//! what an undisturbed one gives.

use crate::beginning::{At, Beginning, Beginnings, Name};
use crate::place::{self, Expected, Place, RUN};
use crate::report::{MISSED, Report, side_by_side};
use crate::trace::End;

/// Before every `stride`-th call; panics with a table of what went wrong.
pub fn campaign(stride: usize) {
    let beginnings = Beginnings::new();
    let mut report = Report::new("kills");
    for beginning in &beginnings.all {
        let calls = beginning.calls();
        let chosen: Vec<_> = calls.iter().step_by(stride).collect();
        let found = side_by_side(&chosen, |call| check(beginning, call, &beginnings.expected));
        report.count(beginning.name, calls.len(), chosen.len());
        for (Name { call, before }, problem) in chosen.into_iter().zip(found) {
            report.add(beginning.name, &format!("{call} #{before}"), problem);
        }
    }
    report.end();
}

fn check(beginning: &Beginning, call: &Name, expected: &Expected) -> Result<(), String> {
    let place = Place::of(&beginning.files);
    let folder = place.path();
    let mut watch = At::kill(&folder, call);
    let ended = place.watched(beginning.command, &mut watch);
    if !matches!(ended.end, End::Signal(_)) {
        return Err(MISSED.to_string());
    }
    if beginning.command != crate::place::GC {
        let good = place::finished(&beginning.files);
        if let Some(what) = place::lost(&good, &place.files()) {
            return Err(format!("lost: {what}"));
        }
    }
    let again = place.call(RUN);
    if let Some(what) = again.misbehaves() {
        return Err(format!("afterwards, {what}"));
    }
    if again.end != End::Code(0) {
        return Err(format!(
            "afterwards, run ends with {:?}: {}",
            again.end, again.err
        ));
    }
    if let Some(path) = place.set_aside().first() {
        return Err(format!("set aside: {}", path.display()));
    }
    match place.lacks(&again, expected) {
        Some(what) => Err(format!("afterwards, {what}")),
        None => Ok(()),
    }
}
