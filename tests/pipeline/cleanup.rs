//! A clean-up removes what is known to be garbage, and nothing else.

use std::fs;
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime};

use coronet::pipeline::store::LATEST;
use coronet::pipeline::sweep::{self, Options, Swept};
use coronet::pipeline::*;

use crate::laboratory::{FILE, Lab, go, pipeline, store, words};

/// Removes what the options let it.
fn clean(store: &Store, options: &Options) -> Result<Swept, PipelineError> {
    let planned = sweep::plan(store, options)?;
    let approved: Vec<_> = planned.removed.into_iter().map(|(path, ..)| path).collect();
    sweep::sweep(store, options, &approved)
}

/// Finished results of any age.
fn all_ages() -> Options {
    Options {
        older_than: Some(Duration::ZERO),
        ..Options::default()
    }
}

#[test]
fn a_clean_up_keeps_finished_results_and_those_that_names_reach() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let old = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    let new = go(&store, &pipeline(&lab, 2, 0)).unwrap();
    assert!(
        clean(&store, &Options::default())
            .unwrap()
            .removed
            .is_empty()
    );
    let aged = Options {
        older_than: Some(Duration::from_secs(3600)),
        ..Options::default()
    };
    assert!(clean(&store, &aged).unwrap().removed.is_empty());
    assert_eq!(sweep::plan(&store, &all_ages()).unwrap().removed.len(), 2);
    assert!(old[0].folder.exists());
    // A pipeline that is named keeps its results, too.
    let planned = plan(&store, &pipeline(&lab, 1, 0)).unwrap();
    let with_plan = Options {
        planned: vec![("old".into(), planned)],
        ..all_ages()
    };
    assert!(clean(&store, &with_plan).unwrap().removed.is_empty());
    assert_eq!(clean(&store, &all_ages()).unwrap().removed.len(), 2);
    assert!(!old[0].folder.exists() && !old[2].folder.exists());
    assert_eq!(
        words(&go(&store, &pipeline(&lab, 2, 0)).unwrap()),
        ["fresh"; 3]
    );
    let link = store.root().join(LATEST).join("toy/grow-drop");
    assert_eq!(
        link.canonicalize().unwrap(),
        new[0].folder.canonicalize().unwrap()
    );
    let forget = Options {
        forgotten: vec!["toy".into()],
        ..Options::default()
    };
    assert_eq!(clean(&store, &forget).unwrap().removed.len(), 3);
    assert!(clean(&store, &forget).is_err());
}

#[test]
fn a_clean_up_without_any_name_needs_to_be_told() {
    let (_folder, store) = store();
    go(&store, &pipeline(&Lab::default(), 1, 0)).unwrap();
    fs::remove_dir_all(store.root().join(LATEST)).unwrap();
    let error = clean(&store, &all_ages()).unwrap_err();
    assert!(matches!(error, PipelineError::NoNames { .. }), "{error}");
    let told = Options {
        without_names: true,
        ..all_ages()
    };
    assert_eq!(clean(&store, &told).unwrap().removed.len(), 3);
}

#[test]
fn a_clean_up_holds_stopped_runs_and_what_they_read() {
    let (_folder, store) = store();
    let lab = Lab::default();
    lab.interrupt.store(true, Ordering::Relaxed);
    go(&store, &pipeline(&lab, 1, 0)).unwrap_err();
    // Another run of the same name ends meanwhile.
    lab.interrupt.store(false, Ordering::Relaxed);
    go(&store, &pipeline(&lab, 2, 0)).unwrap();
    assert!(clean(&store, &all_ages()).unwrap().removed.is_empty());
    let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&reports), ["fresh", "fresh", "resumed"]);
}

#[test]
fn a_clean_up_refuses_while_a_pipeline_runs() {
    let (_folder, store) = store();
    go(&store, &pipeline(&Lab::default(), 1, 0)).unwrap();
    let running = store.share(&mut |_| false).unwrap();
    let error = clean(&store, &all_ages()).unwrap_err();
    assert!(matches!(error, PipelineError::Busy { .. }), "{error}");
    drop(running);
    clean(&store, &all_ages()).unwrap();
}

#[test]
fn a_clean_up_removes_nothing_from_a_folder_that_is_in_use_or_not_known() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let old = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    go(&store, &pipeline(&lab, 2, 0)).unwrap();
    // As by a process that could not open the lock of the store.
    let lock = store.lock(&old[0].folder, &mut |_| false).unwrap().unwrap();
    let foreign = store.root().join("grow").join("ab".repeat(32));
    fs::create_dir(&foreign).unwrap();
    fs::write(foreign.join("config.json"), "{}").unwrap();
    let swept = clean(&store, &all_ages()).unwrap();
    assert_eq!(swept.removed.len(), 1);
    assert!(old[0].folder.exists() && foreign.join("config.json").exists());
    drop(lock);
    assert_eq!(clean(&store, &all_ages()).unwrap().removed.len(), 1);
}

#[test]
fn a_clean_up_outside_a_store_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let foreign = folder.path().join("containers").join("ab".repeat(32));
    fs::create_dir_all(&foreign).unwrap();
    let error = clean(&Store::new(folder.path()), &all_ages()).unwrap_err();
    assert!(matches!(error, PipelineError::NotAStore { .. }), "{error}");
    assert!(foreign.exists());
}

/// What comes after a damaged result has no key, and may still be what the file is about.
#[test]
fn a_clean_up_keeps_what_may_come_after_a_damaged_result() {
    let (_folder, store) = store();
    let lab = Lab::default();
    let old = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    go(&store, &pipeline(&lab, 2, 0)).unwrap();
    fs::remove_file(old[0].folder.join(FILE)).unwrap();
    let planned = plan(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert!(planned[2].key.is_none());
    let options = Options {
        planned: vec![("old".into(), planned)],
        ..all_ages()
    };
    assert!(clean(&store, &options).unwrap().removed.is_empty());
    let reports = go(&store, &pipeline(&lab, 1, 0)).unwrap();
    assert_eq!(words(&reports), ["ran", "fresh", "fresh"]);
}

#[test]
fn a_clean_up_leaves_what_is_being_written_beside_names() {
    let (_folder, store) = store();
    go(&store, &pipeline(&Lab::default(), 1, 0)).unwrap();
    let folder = store.root().join(LATEST).join("study");
    fs::create_dir(&folder).unwrap();
    let [young, old] = [1, 2].map(|k| folder.join(format!(".figures.md.1.{k}.coronet-tmp")));
    fs::write(&young, "half").unwrap();
    let file = fs::File::create(&old).unwrap();
    let hours = Duration::from_secs(2 * 3600);
    file.set_modified(SystemTime::now() - hours).unwrap();
    clean(&store, &Options::default()).unwrap();
    assert!(young.exists() && !old.exists());
}
