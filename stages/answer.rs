//! The figures of a run, as people and scripts get them.

use std::path::Path;

use anyhow::{Context as _, Result, bail};
use coronet::file::{changed, exists};
use coronet::measure::answer::{Answer, Figures};
use coronet::measure::series::Series;
use coronet::measure::summary::digits;
use coronet::pipeline::content::ContentError;
use coronet::pipeline::{Report, Stamp, Store, content, stamp};
use coronet::record::log;
use coronet::scene::sanity::Warning;
use serde_json::{Value, json};

use crate::fault::Untrusted;
use crate::journal::FRAMES;
use crate::post::{MEASURES, MISSED};
use crate::relax::UNREST;
use crate::table;

/// The figures of a finished evaluation in `folder`; the scene is that of the log of its frames.
pub fn read(folder: &Path, stamp: &Stamp) -> Result<Figures> {
    let measures = measures(folder, stamp)?;
    let impact = stamp.inputs.iter().find(|input| input.stage == "impact");
    let impact = impact.context("its stamp names no impact")?;
    let log = store_of(folder)?.folder(&impact.stage, &impact.key);
    let log = log.join(FRAMES);
    if !exists(&log)? {
        bail!(untrusted(&log, "it is missing"));
    }
    let scene = log::info(&log)?.scene(&log)?;
    Ok(Figures::new(&scene, measures))
}

/// The measures of an evaluation in `folder`.
///
/// # Errors
/// If they cannot be read, or are not those that were written.
pub fn measures(folder: &Path, stamp: &Stamp) -> Result<Series> {
    let path = folder.join(MEASURES);
    let mut outputs = stamp.outputs.iter();
    let output = outputs.find(|output| output.file == MEASURES);
    let output = output.context("its stamp names no measures")?;
    match content::content(&path) {
        Ok(found) if found == output.digest => Ok(Series::read(&path)?),
        Ok(_) => bail!(untrusted(&path, "it was changed after it was written")),
        Err(ContentError::Damaged(what)) => bail!(untrusted(&path, &what)),
        Err(ContentError::File(error)) => Err(error.into()),
    }
}

/// That a file of a result is not as it was written.
fn untrusted(path: &Path, what: &str) -> Untrusted {
    Untrusted(format!(
        "{}: {what}; `coronet verify` sets aside what is damaged, and the next run makes it again",
        path.display()
    ))
}

/// SI, with times from the start and from contact.
pub fn json(figures: &Figures) -> Value {
    let object = |answer: &Answer| {
        json!({
            "name": answer.name,
            "value": answer.value,
            "unit": answer.quantity.si(),
            "time_s": answer.time,
            "time_after_contact_s": figures.after_contact(answer),
        })
    };
    figures.answers.iter().map(object).collect()
}

/// Name, value and time, one a line.
pub fn lines(figures: &Figures) -> Vec<String> {
    let row = |answer: &Answer| {
        let when = answer.when(figures.contact).unwrap_or_default();
        vec![answer.name.to_string(), answer.text(), when]
    };
    let rows: Vec<_> = figures.answers.iter().map(row).collect();
    let mut lines = table::lines(&rows, &[1]);
    let timed = figures.answers.iter().any(|answer| answer.time.is_some());
    if timed && figures.contact > 0.0 {
        lines.push(format!(
            "times count from contact, {} ms after the start",
            digits(1e3 * figures.contact)
        ));
    }
    lines
}

/// The store that a folder of a result is in.
pub fn store_of(folder: &Path) -> Result<Store> {
    let path = folder.canonicalize();
    let path = path.with_context(|| format!("cannot find {}", folder.display()))?;
    let root = path.ancestors().nth(2).unwrap_or(Path::new("."));
    Ok(Store::new(root))
}

/// The figures of a result that has some: of an evaluation, or of an impact the newest evaluation.
/// An error says why there are none.
pub fn of_result(folder: &Path, stamp: &Stamp) -> Result<Option<Figures>> {
    match stamp.stage.as_str() {
        "post" => read(folder, stamp).map(Some),
        "impact" => {
            let stamps = store_of(folder)?.stamps("post")?;
            let of_this = |post: &Stamp| post.inputs.iter().any(|input| input.key == stamp.key);
            let mut mine = Vec::new();
            for (folder, post) in stamps.iter().filter(|(_, post)| of_this(post)) {
                mine.push((changed(&folder.join(stamp::FILE))?, folder, post));
            }
            let newest = mine.into_iter().max_by_key(|(written, ..)| *written);
            newest
                .map(|(_, folder, post)| read(folder, post))
                .transpose()
        }
        _ => Ok(None),
    }
}

/// Whether a note of a stage is told as a warning too: of a relaxation while it runs, of an
/// evaluation at the end ([`warnings`]).
pub fn is_warned(stage: &str, note: &str) -> bool {
    match stage {
        "relax" => note.starts_with(UNREST),
        // A loss begins with the key that it is about; bodies not at rest are told by name.
        "post" => {
            let is_restless = note.starts_with("body `") && note.contains(UNREST);
            note.starts_with(MISSED) || note.starts_with('`') || is_restless
        }
        _ => false,
    }
}

/// What a user should know of a run before the figures are believed.
pub fn warnings(reports: &[Report], figures: Option<&Figures>) -> Vec<String> {
    let mut warnings = Vec::new();
    for report in reports {
        let notes = report.stamp.notes.iter();
        let restless = notes.filter(|note| report.stage == "relax" && note.starts_with(UNREST));
        warnings.extend(restless.map(|note| format!("{}: {note}", report.label())));
    }
    let post = reports.iter().find(|report| report.stage == "post");
    let missed = post.into_iter().flat_map(|post| &post.stamp.notes);
    warnings.extend(missed.filter(|note| note.starts_with(MISSED)).cloned());
    let doubts = figures.into_iter().flat_map(|figures| &figures.warnings);
    warnings.extend(doubts.map(Warning::to_string));
    warnings
}
