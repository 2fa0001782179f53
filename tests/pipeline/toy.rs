//! What must hold whatever the stages do, checked on a toy pipeline.

use std::cell::RefCell;
use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};

use coronet::pipeline::content::set_aside;
use coronet::pipeline::*;
use coronet::record::Digest;

use crate::laboratory::{FILE, Lab, Notes, damage, go, grow, pipeline, store, watched, words};

#[test]
fn second_run_is_fresh_and_a_change_reaches_only_what_reads_it() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&first), ["ran"; 3]);
    assert_eq!(first[0].reasons, ["never ran"]);
    let second = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&second), ["fresh"; 3]);
    assert_eq!(lab.calls.load(Ordering::Relaxed), 3);

    let changed = pipeline(&lab, 2, 0);
    let planned: Vec<_> = plan(&store, &changed)
        .unwrap()
        .iter()
        .map(|d| d.reasons.clone())
        .collect();
    assert_eq!(planned[0], ["grow.size 1 m -> 2 m"]);
    assert!(planned[1].is_empty());
    assert_eq!(planned[2], ["grow drop is stale"]);
    let third = go(&store, &changed).unwrap();
    assert_eq!(words(&third), ["ran", "fresh", "ran"]);
    assert_eq!(third[0].reasons, planned[0]);
    let (old, new) = (first[0].stamp.digest.short(), third[0].stamp.digest.short());
    assert_eq!(
        third[2].reasons,
        [format!("result of grow drop {old} -> {new}")]
    );
}

#[test]
fn a_rerun_with_the_same_result_stops_there() {
    let (_folder, store) = store();
    let lab = Lab::default();
    go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let mut changed = pipeline(&lab, 1, 0);
    changed.jobs[0] = grow(&lab, "drop", 1, 5);
    let reports = go(&store, &changed).unwrap();
    assert_eq!(words(&reports), ["ran", "fresh", "fresh"]);
    assert_eq!(reports[0].reasons, ["grow.idle 0 m -> 5 m"]);
    lab.version.store(1, Ordering::Relaxed);
    let mut changed = pipeline(&lab, 1, 0);
    changed.jobs[0] = grow(&lab, "drop", 1, 5);
    let reports = go(&store, &changed).unwrap();
    assert_eq!(words(&reports), ["ran", "ran", "fresh"]);
    assert_eq!(reports[1].reasons, ["grow.VERSION 1 -> 2"]);
}

/// Flips a bit at `place`, then asks for something new that reads the file.
fn repaired_after_damage_at(place: impl Fn(usize) -> usize) -> Vec<String> {
    let (_folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let file = first[1].folder.join(FILE);
    let mut bytes = fs::read(&file).unwrap();
    let place = place(bytes.len());
    bytes[place] ^= 1;
    fs::write(&file, &bytes).unwrap();
    let notes = Notes::default();
    let reports = watched(&store, &pipeline(&lab, 1, 9), &notes).unwrap();
    assert_eq!(reports[1].stamp.digest, first[1].stamp.digest);
    let kept = file.with_file_name(format!("{FILE}.bad-1"));
    assert_eq!(fs::read(kept).unwrap(), bytes);
    assert_eq!(
        words(&go(&store, &pipeline(&lab, 1, 9)).unwrap()),
        ["fresh"; 3]
    );
    notes.0.into_inner().unwrap()
}

#[test]
fn damage_in_a_header_is_seen_at_a_glance() {
    assert!(repaired_after_damage_at(|_| 60).is_empty());
}

#[test]
fn damage_in_an_array_is_seen_on_reading() {
    let warnings = repaired_after_damage_at(|length| length - 6);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("cannot be trusted"), "{warnings:?}");
}

#[test]
fn verification_finds_what_a_quick_look_does_not() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let page = first[2].folder.join("page.txt");
    damage(&page);
    assert_eq!(
        words(&go(&store, &pipeline(&lab, 1, 0)).unwrap()),
        ["fresh"; 3]
    );
    let findings = coronet::pipeline::verify::verify(&store, &mut |_| {}).unwrap();
    let problems: Vec<_> = findings
        .iter()
        .flat_map(|finding| &finding.problems)
        .collect();
    assert_eq!(problems.len(), 1);
    assert_eq!(problems[0].file, page);
    let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&reports), ["fresh", "fresh", "ran"]);
    assert!(
        reports[2].reasons[0].contains("page.txt.bad-1"),
        "{:?}",
        reports[2].reasons
    );
}

#[test]
fn a_damaged_stamp_is_a_reason_to_run_again() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let path = first[0].folder.join("stamp.json");
    let text = fs::read_to_string(&path).unwrap();
    let cases = [
        text.replace("\"threads\": 1", "\"threads\": 2"),
        text[..text.len() / 2].to_string(),
        String::new(),
        "{}".to_string(),
        format!("{text}\n"),
        "[".repeat(100_000),
        text.replace("\"stamp\": 1", "\"stamp\": 2"),
    ];
    for case in cases {
        assert_ne!(case, text);
        fs::write(&path, case).unwrap();
        let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
        assert_eq!(words(&reports), ["ran", "fresh", "fresh"]);
        assert!(
            reports[0].reasons[0].contains("not a valid stamp"),
            "{:?}",
            reports[0].reasons
        );
    }
}

#[test]
fn another_result_for_the_same_key_is_an_error_and_both_are_kept() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    set_aside(&first[0].folder, &first[0].folder.join(FILE)).unwrap();
    lab.drift.store(3, Ordering::Relaxed);
    let error = go(&store, &pipeline(&lab, 1, 0)).unwrap_err();
    let PipelineError::Nondeterministic { folder, other, .. } = &error else {
        panic!("{error}");
    };
    assert!(folder.join(format!("{FILE}.bad-1")).exists());
    assert!(other.join(FILE).exists() && other.join("stamp.json").exists());
    assert!(error.to_string().contains("both are kept"));
    // Without the drift the first result comes back.
    lab.drift.store(0, Ordering::Relaxed);
    let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&reports), ["ran", "fresh", "fresh"]);
}

#[test]
fn an_interrupted_stage_is_planned_and_reported_as_resumed() {
    let (_folder, store) = store();
    let lab = Lab::default();
    lab.interrupt.store(true, Ordering::Relaxed);
    let error = go(&store, &pipeline(&lab, 1, 0)).unwrap_err();
    assert!(
        matches!(error, PipelineError::Interrupted { .. }),
        "{error}"
    );
    lab.interrupt.store(false, Ordering::Relaxed);
    let planned = plan(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(planned[2].word(), "resumes");
    let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&reports), ["fresh", "fresh", "resumed"]);
    assert_eq!(reports[2].stamp.resumptions, 1);
    assert!(!reports[2].folder.join("work").exists());
    let planned = plan(&store, &pipeline(&lab, 1, 5)).unwrap();
    assert_eq!(
        planned[2].start.as_deref(),
        Some("the result for sum.end = 0 m")
    );
    let reports = go(&store, &pipeline(&lab, 1, 5)).unwrap();
    assert_eq!(words(&reports), ["fresh", "fresh", "resumed"]);
}

#[test]
fn two_runs_at_once_share_the_work() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let reports = RefCell::new(Vec::new());
    std::thread::scope(|scope| {
        let both: Vec<_> = (0..2)
            .map(|_| scope.spawn(|| go(&store, &pipeline(&lab, 1, 0)).unwrap()))
            .collect();
        for thread in both {
            reports.borrow_mut().push(thread.join().unwrap());
        }
    });
    assert_eq!(lab.calls.load(Ordering::Relaxed), 3);
    let reports = reports.into_inner();
    for (a, b) in reports[0].iter().zip(&reports[1]) {
        assert_eq!(a.stamp, b.stamp);
    }
}

#[test]
fn a_stamp_that_contradicts_itself_is_not_used() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let other = first[1].stamp.digest;
    let spoil: [fn(&mut Stamp, Digest); 4] = [
        |stamp, other| stamp.digest = other,
        |stamp, _| stamp.settings[0].canonical = "00".into(),
        |stamp, _| stamp.version += 1,
        |stamp, other| stamp.family = Some(other),
    ];
    for spoil in spoil {
        let mut stamp = first[0].stamp.clone();
        spoil(&mut stamp, other);
        stamp.write(&first[0].folder).unwrap();
        let findings = verify::verify(&store, &mut |_| {}).unwrap();
        let problems = findings.iter().flat_map(|finding| &finding.problems);
        assert_eq!(problems.count(), 1);
        let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
        assert_eq!(words(&reports), ["ran", "fresh", "fresh"]);
        assert_eq!(reports[0].stamp.digest, first[0].stamp.digest);
    }
}

#[test]
fn stamps_and_manifests_that_lead_out_of_the_store_are_refused() {
    let (folder, store) = store();
    let lab = Lab::default();
    let first = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let victim = folder.path().join("victim");
    fs::write(&victim, "precious").unwrap();
    for name in [
        "../../../victim",
        "/etc/passwd",
        "a/../../b",
        "",
        "a\n",
        ".",
    ] {
        let mut stamp = first[0].stamp.clone();
        stamp.outputs[1].file = name.into();
        stamp.write(&first[0].folder).unwrap();
        verify::verify(&store, &mut |_| {}).unwrap();
        let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
        assert_eq!(words(&reports), ["ran", "fresh", "fresh"], "{name:?}");
        assert_eq!(fs::read(&victim).unwrap(), b"precious");
    }
    for name in ["..", "a/../b", "/a", "a//b", ".hidden", "", "a\u{7}"] {
        let mut named = pipeline(&lab, 1, 0);
        named.name = name.into();
        let error = go(&store, &named).unwrap_err();
        assert!(matches!(error, PipelineError::Name { .. }), "{error}");
    }
}

#[test]
fn an_unknown_last_stage_is_refused_with_the_known_ones() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let error = run(&Run {
        store: &store,
        pipeline: &pipeline(&lab, 1, 0),
        also: None,
        until: Some("som"),
        stop: &AtomicBool::new(false),
        watch: &Silent,
        remote: None,
        threads: 1,
        program: "toy".into(),
    });
    assert!(error.unwrap_err().to_string().contains("grow, sum"));
}
