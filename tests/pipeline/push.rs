//! `--remote`, `push` and `pull` of the program.

use std::fs;
use std::path::Path;

use coronet::pipeline::Stamp;

use crate::program::{Program, members};
use crate::remote::change;

/// Leaves the first bytes of each file in a folder.
fn cut_short(folder: &Path) {
    for entry in fs::read_dir(folder).unwrap() {
        change(&entry.unwrap().path(), |bytes| bytes.truncate(10));
    }
}

#[test]
fn the_program_shares_results() {
    let shared = tempfile::tempdir().unwrap();
    let url = format!("file://{}", shared.path().display());
    let first = Program::new();
    let made = first.run(&["--remote", &url]);
    let second = Program::new();
    let fetched = second.run(&["--remote", &url]);
    let statuses = members(&fetched, "status");
    assert!(
        statuses.values().all(|status| status == "fetched"),
        "{statuses:?}"
    );
    assert_eq!(second.fingerprint(&fetched), first.fingerprint(&made));
    second.call(&["verify"]).well();

    // What a store has is put there by command, and comes by command.
    let shared = tempfile::tempdir().unwrap();
    let url = format!("file://{}", shared.path().display());
    let third = Program::new();
    let pull = ["pull", "tiny.toml", "--json"];
    let pull = || {
        third
            .command(&pull)
            .env("CORONET_REMOTE", &url)
            .output()
            .unwrap()
    };
    let ended = crate::program::Ended::from(pull());
    ended.badly(1, &["does not have this result", "run --remote"]);
    let said = first.call(&["push", "--remote", &url]).well();
    assert!(said.out.contains("7 results put"), "{}", said.out);
    let said = first.call(&["push", "tiny", "--remote", &url]).well();
    assert!(said.out.contains("7 were there"), "{}", said.out);
    cut_short(&shared.path().join("files"));
    let said = first.call(&["push", "--remote", &url]).well();
    assert!(said.out.contains("7 results put"), "{}", said.out);
    let ended = crate::program::Ended::from(pull()).well();
    assert_eq!(
        third.fingerprint(&ended.objects()),
        first.fingerprint(&made)
    );
    let fresh = members(&third.run(&[]), "status");
    assert!(fresh.values().all(|status| status == "fresh"), "{fresh:?}");

    // Stamps that are wrong here stay here.
    let shared = tempfile::tempdir().unwrap();
    let url = format!("file://{}", shared.path().display());
    let drop = first.latest("pack-drop");
    let mut stamp = Stamp::read(&drop).unwrap().unwrap();
    stamp.settings.pop();
    stamp.write(&drop).unwrap();
    change(&first.latest("calibrate").join("stamp.json"), |bytes| {
        bytes.truncate(9)
    });
    let ended = first.call(&["push", "--remote", &url]);
    ended.badly(
        4,
        &["pack drop", "contradicts itself", "calibrate", "2 results"],
    );
    assert!(ended.out.contains("5 results put"), "{}", ended.out);
}
