//! `coronet verify`: compares stored results with their stamps.

use anyhow::{Context as _, Result, bail};
use coronet::pipeline::Store;
use coronet::pipeline::verify::{self, Finding, Problem};
use serde_json::json;

use crate::arguments::StoreArguments;
use crate::fault::{Unreadable, Untrusted, Usage};
use crate::print::{counted, out, size};

pub fn verify(arguments: &StoreArguments) -> Result<()> {
    let store = existing(&arguments.artifacts)?;
    let mut stages = store.stages()?.into_iter();
    let has_results = stages.any(|stage| store.folders(&stage).is_ok_and(|all| !all.is_empty()));
    if !has_results && !store.is_marked()? {
        let path = store.root().display();
        bail!(Usage(format!(
            "{path} is not a store of results; name one with --artifacts"
        )));
    }
    let findings = verify::verify(&store, &mut |finding| {
        print_finding(finding, arguments.json)
    })?;
    let problems: Vec<&Problem> = findings.iter().flat_map(|found| &found.problems).collect();
    let bytes: u64 = findings.iter().map(|finding| finding.bytes).sum();
    let (results, count) = (findings.len(), problems.len());
    if arguments.json {
        out!(
            "{}",
            json!({"results": results, "bytes": bytes, "problems": count})
        );
    } else {
        let (results, count) = (counted(results, "result"), counted(count, "problem"));
        out!("{results}, {}, {count}", size(bytes));
    }
    let damaged = problems.iter().filter(|problem| problem.damaged).count();
    if damaged > 0 {
        let text = format!("damaged files: {damaged}; `coronet run` regenerates them");
        bail!(Untrusted(text));
    }
    if count > 0 {
        bail!(Unreadable(format!(
            "files that cannot be read: {count}; they are not changed"
        )));
    }
    if results == 0 {
        let path = store.root().display();
        bail!(Usage(format!(
            "{path} contains no finished result, so nothing was verified"
        )));
    }
    Ok(())
}

/// The store at a path; fails if there is none.
pub fn existing(path: &std::path::Path) -> Result<Store> {
    match path.metadata() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let path = path.display();
            bail!(Usage(format!(
                "there is no store at {path}; name it with --artifacts"
            )))
        }
        other => other.with_context(|| format!("cannot examine {}", path.display()))?,
    };
    Ok(Store::new(path))
}

fn print_finding(finding: &Finding, json: bool) {
    if json {
        let problem = |problem: &Problem| {
            let kept = problem.kept.as_ref().map(|kept| kept.to_string_lossy());
            json!({"file": problem.file.to_string_lossy(), "what": problem.what,
                "damaged": problem.damaged, "kept": kept})
        };
        let problems: Vec<_> = finding.problems.iter().map(problem).collect();
        let object = json!({
            "folder": finding.folder.to_string_lossy(),
            "result": finding.label,
            "bytes": finding.bytes,
            "problems": problems,
        });
        return out!("{object}");
    }
    let word = if finding.problems.is_empty() {
        "good"
    } else {
        "bad"
    };
    out!("{word:5} {:20} {}", finding.label, finding.folder.display());
    for problem in &finding.problems {
        out!("      {}: {}", problem.file.display(), problem.what);
        if let Some(kept) = &problem.kept {
            out!("      kept as {}", kept.display());
        }
    }
}
