//! `coronet verify` and `coronet gc`: care of the store.

use std::io::Write as _;

use anyhow::Result;
use coronet::pipeline::verify::Finding;
use coronet::pipeline::{self, Store, sweep, verify};
use coronet::scene::file;
use serde_json::json;

use crate::arguments::{StoreArguments, SweepArguments};
use crate::fault::Untrusted;
use crate::jobs;

pub fn verify(arguments: &StoreArguments) -> Result<()> {
    let store = Store::new(&arguments.artifacts);
    let mut printed = Ok(());
    let findings = verify::verify(&store, &mut |finding| {
        if printed.is_ok() {
            printed = print_finding(finding, arguments.json);
        }
    });
    printed?;
    let problems = findings
        .iter()
        .map(|finding| finding.problems.len())
        .sum::<usize>();
    let bytes: u64 = findings.iter().map(|finding| finding.bytes).sum();
    let mut out = std::io::stdout().lock();
    if arguments.json {
        let results = findings.len();
        let object = json!({"results": results, "bytes": bytes, "problems": problems});
        writeln!(out, "{object}")?;
    } else {
        writeln!(
            out,
            "{} results, {}, {problems} problems",
            findings.len(),
            size(bytes)
        )?;
    }
    if problems > 0 {
        let text = format!("{problems} files cannot be trusted; `coronet run` makes them anew");
        return Err(Untrusted(text).into());
    }
    Ok(())
}

fn print_finding(finding: &Finding, json: bool) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    if json {
        let problem = |problem: &verify::Problem| {
            let verify::Problem { file, what, kept } = problem;
            json!({"file": file, "what": what, "kept": kept})
        };
        let problems: Vec<_> = finding.problems.iter().map(problem).collect();
        let object = json!({
            "folder": finding.folder,
            "result": finding.label,
            "bytes": finding.bytes,
            "problems": problems,
        });
        return writeln!(out, "{object}");
    }
    let word = if finding.problems.is_empty() {
        "good"
    } else {
        "bad"
    };
    writeln!(
        out,
        "{word:5} {:20} {}",
        finding.label,
        finding.folder.display()
    )?;
    for problem in &finding.problems {
        writeln!(out, "      {}: {}", problem.file.display(), problem.what)?;
        if let Some(kept) = &problem.kept {
            writeln!(out, "      kept as {}", kept.display())?;
        }
    }
    Ok(())
}

pub fn sweep(arguments: &SweepArguments) -> Result<()> {
    let store = Store::new(&arguments.store.artifacts);
    let mut planned = Vec::new();
    for path in &arguments.pipelines {
        let loaded = file::load(path, &[])?;
        let pipeline = jobs::pipeline(&loaded)?;
        planned.push((
            path.display().to_string(),
            pipeline::plan(&store, &pipeline),
        ));
    }
    let swept = sweep::sweep(&store, &planned, &arguments.forget, arguments.dry_run)?;
    let bytes: u64 = swept.removed.iter().map(|(_, _, bytes)| bytes).sum();
    let mut out = std::io::stdout().lock();
    if arguments.store.json {
        for (folder, holders) in &swept.kept {
            writeln!(out, "{}", json!({"kept": folder, "by": holders}))?;
        }
        for (folder, label, bytes) in &swept.removed {
            let object = json!({"removed": folder, "result": label, "bytes": bytes,
                "dry_run": arguments.dry_run});
            writeln!(out, "{object}")?;
        }
        return Ok(());
    }
    for (folder, holders) in &swept.kept {
        writeln!(
            out,
            "keep    {} (for {})",
            folder.display(),
            holders.join(", ")
        )?;
    }
    let word = if arguments.dry_run {
        "would remove"
    } else {
        "removed"
    };
    for (folder, label, bytes) in &swept.removed {
        writeln!(
            out,
            "{word} {} ({label}, {})",
            folder.display(),
            size(*bytes)
        )?;
    }
    writeln!(
        out,
        "{word} {} results, {}",
        swept.removed.len(),
        size(bytes)
    )?;
    Ok(())
}

/// Bytes for people.
pub fn size(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e3 => format!("{b} B"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b if b < 1e12 => format!("{:.2} GB", b / 1e9),
        b => format!("{:.2} TB", b / 1e12),
    }
}
