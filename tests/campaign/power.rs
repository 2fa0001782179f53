//! The power fails: the disk holds what was synced and any part of the rest. The same command then
//! gives what an undisturbed one gives.

use crate::beginning::{Beginning, Beginnings};
use crate::disk::{Kept, Recorder};
use crate::place::{Expected, Place, RUN};
use crate::report::{Report, side_by_side};
use crate::trace::End;

/// What is kept of names and of data.
const STATES: [[Kept; 2]; 6] = [
    [Kept::Nothing, Kept::Nothing],
    [Kept::Everything, Kept::Nothing],
    [Kept::Everything, Kept::Part],
    [Kept::Everything, Kept::Zeros],
    [Kept::Part, Kept::Any],
    [Kept::Part, Kept::Any],
];

/// A disk after a power cut.
struct Cut {
    acts: usize,
    names: Kept,
    data: Kept,
    seed: u64,
}

/// Every `stride`-th state; panics with a table of what went wrong.
pub fn campaign(stride: usize) {
    let beginnings = Beginnings::new();
    let mut report = Report::new("power cuts");
    for beginning in beginnings.all.iter().filter(|each| each.command == RUN) {
        let recorder = record(beginning);
        let cuts = (0..=recorder.len()).flat_map(|acts| {
            let cut = move |(number, [names, data]): (usize, [Kept; 2])| Cut {
                acts,
                names,
                data,
                seed: (acts * STATES.len() + number) as u64,
            };
            STATES.into_iter().enumerate().map(cut)
        });
        let cuts: Vec<_> = cuts.step_by(stride).collect();
        let expected = &beginnings.expected;
        let found = side_by_side(&cuts, |cut| check(&recorder, cut, expected));
        report.count(beginning.name, recorder.len(), cuts.len());
        for (cut, problem) in cuts.iter().zip(found) {
            let Cut {
                acts, names, data, ..
            } = cut;
            let place = format!("after {acts} acts, of names {names:?}, of data {data:?}");
            report.add(beginning.name, &place, problem);
        }
        report.add(beginning.name, "at the end", durable(&recorder, expected));
    }
    report.end();
}

fn record(beginning: &Beginning) -> Recorder {
    let place = Place::of(&beginning.files);
    let mut recorder = Recorder::new(&place.path(), &place.files());
    let ended = place.watched(beginning.command, &mut recorder);
    assert_eq!(ended.end, End::Code(0), "{}", ended.err);
    let everything = recorder.power_cut(recorder.len(), Kept::Everything, Kept::Everything, 0);
    let differs = crate::place::lost(&everything, &place.files());
    assert_eq!(differs, None, "the record is not what happened");
    assert_eq!(everything.len(), place.files().len());
    recorder
}

fn check(recorder: &Recorder, cut: &Cut, expected: &Expected) -> Result<(), String> {
    let files = recorder.power_cut(cut.acts, cut.names, cut.data, cut.seed);
    let place = Place::of(&files);
    let ended = place.call(RUN);
    if let Some(what) = ended.misbehaves() {
        return Err(what);
    }
    if ended.end != End::Code(0) {
        return Err(format!("it ends with {:?}: {}", ended.end, ended.err));
    }
    match place.lacks(&ended, expected) {
        Some(what) => Err(what),
        None => Ok(()),
    }
}

/// What a run that ended with success made is on the disk, even if the power fails at once.
fn durable(recorder: &Recorder, expected: &Expected) -> Result<(), String> {
    let files = recorder.power_cut(recorder.len(), Kept::Nothing, Kept::Nothing, 0);
    let place = Place::of(&files);
    let ended = place.call(RUN);
    let again = ended.out.matches("\"status\":\"ran\"").count();
    match again {
        0 if ended.digests() == expected.digests => Ok(()),
        _ => Err(format!("{again} results of a successful run are lost")),
    }
}
