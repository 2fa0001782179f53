//! One store for several: races and clean-ups.

use std::fs;
use std::time::{Duration, SystemTime};

use crate::program::{Ended, Program, TINY, members};

#[test]
fn two_runs_at_once_share_one_store() {
    let alone = Program::new();
    let expected = alone.fingerprint(&alone.run(&[]));
    let program = Program::new();
    let arguments = ["run", "tiny.toml", "--json"];
    let children: Vec<_> = (0..2).map(|_| program.start(&arguments)).collect();
    let ended: Vec<_> = children
        .into_iter()
        .map(|child| Ended::from(child.wait_with_output().unwrap()))
        .collect();
    assert!(
        ended
            .iter()
            .any(|ended| ended.err.contains("waiting for process"))
    );
    let mut made = 0;
    for ended in ended {
        let objects = ended.well().objects();
        assert_eq!(program.fingerprint(&objects), expected);
        made += members(&objects, "status")
            .values()
            .filter(|status| *status == "ran")
            .count();
    }
    assert_eq!(made, 7, "each result is made once");
}

#[test]
fn a_clean_up_keeps_what_the_newest_runs_reach() {
    let program = Program::new();
    program.run(&[]);
    let old = program.latest("impact");
    program.run(&["--set", "body.drop.velocity=1.2 m/s"]);
    fs::write(
        program.path("other.toml"),
        TINY.replace("1 m/s\"\ncolour", "1.4 m/s\"\ncolour"),
    )
    .unwrap();
    program.call(&["run", "other.toml"]).well();
    let removed = |arguments: &[&str]| {
        let objects = program.call(arguments).well().objects();
        objects.iter().filter(|o| !o["removed"].is_null()).count()
    };
    assert_eq!(removed(&["gc", "--json"]), 0);
    let all = ["gc", "--json", "--older-than", "0s"];
    assert_eq!(removed(&[&all[..], &["--dry-run"]].concat()), 2);
    assert!(old.exists());
    assert_eq!(removed(&all), 2);
    assert!(!old.exists());
    for (file, set) in [
        ("tiny.toml", "body.drop.velocity=1.2 m/s"),
        ("other.toml", "title=A tiny drop"),
    ] {
        let arguments = ["run", file, "--json", "--set", set];
        let statuses = members(&program.call(&arguments).well().objects(), "status");
        assert!(
            statuses.values().all(|status| status == "fresh"),
            "{file}: {statuses:?}"
        );
    }
    program.call(&["gc", "--forget", "other"]).well();
    program.call(&["verify"]).well();
    let statuses = members(
        &program.run(&["--set", "body.drop.velocity=1.2 m/s"]),
        "status",
    );
    assert!(
        statuses.values().all(|status| status == "fresh"),
        "{statuses:?}"
    );
}

#[test]
fn what_has_gone_from_a_remote_store_is_put_again() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    let shared = tempfile::tempdir().unwrap();
    let url = format!("file://{}", shared.path().display());
    let push = || program.call(&["push", "--remote", &url]).well().out;
    push();
    let mut files = fs::read_dir(shared.path().join("files")).unwrap();
    fs::remove_file(files.next().unwrap().unwrap().path()).unwrap();
    assert!(push().contains("1 result put"));
    assert!(push().contains("0 results put"));
    // A run puts what it finds, too.
    fs::remove_dir_all(shared.path()).unwrap();
    fs::create_dir(shared.path()).unwrap();
    program.run(&["--until", "pack", "--remote", &url]);
    assert!(push().contains("0 results put"));
}

#[test]
fn mistakes_in_remote_stores_are_named() {
    let program = Program::new();
    let run = |url: &str| program.call(&["run", "tiny.toml", "--remote", url]);
    run("ftp://a/b").badly(2, &["ftp://a/b", "file:///", "s3://"]);
    run("file://here").badly(2, &["file://here", "absolute"]);
    program.call(&["pull", "tiny.toml"]).badly(2, &["--remote"]);
    assert!(!program.path("artifacts").exists());
    #[cfg(not(feature = "remote"))]
    run("s3://bucket").badly(2, &["--features remote"]);
    program.run(&["--until", "pack"]);
    let own = format!("file://{}", program.path("artifacts").display());
    run(&own).badly(2, &["store of this machine"]);
    let gone = ["push", "--remote", "file:///nowhere/at/all"];
    program.call(&gone).badly(5, &["there is no folder"]);
    // A run goes on without.
    let ended = run("file:///nowhere/at/all").well();
    assert!(ended.err.contains("there is no folder"), "{}", ended.err);
}

#[test]
fn a_push_removes_what_a_killed_one_has_left_and_a_pull_plans_no_work() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    let shared = tempfile::tempdir().unwrap();
    let url = format!("file://{}", shared.path().display());
    program.call(&["push", "--remote", &url]).well();
    let left = |folder: &str, days: u64| {
        let path = shared.path().join(folder).join(".a.1.0.coronet-tmp");
        let file = fs::File::create(&path).unwrap();
        let age = Duration::from_secs(days * 24 * 3600);
        file.set_modified(SystemTime::now() - age).unwrap();
        path
    };
    let [old, young] = [left("files", 2), left("results/pack", 0)];
    program.call(&["push", "--remote", &url]).well();
    assert!(!old.exists() && young.exists());
    let pull = ["pull", "tiny.toml", "--until", "pack", "--remote", &url];
    let said = Program::new().call(&pull).well().out;
    assert!(said.contains("fetched"), "{said}");
    assert!(
        !said.contains("Plan") && !said.contains("Run with"),
        "{said}"
    );
}
