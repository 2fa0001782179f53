//! `impact.stop_when`: what a scene may ask for, and what is in a key.

use std::path::Path;

use coronet::scene::file;
use coronet::scene::key::{Setting, settings};
use coronet::scene::{Scene, StopWhen};

use crate::scene_error::holds;
use crate::scene_file::{SMALL, small};

/// `SMALL` without its pool, the drop where it was.
fn lone() -> String {
    let drop = "sphere = { diameter = \"2 mm\", centre = [\"4 mm\", \"4 mm\", \"3 mm\"] }";
    let text = SMALL.replace("[body.pool]\nlayer = { depth = \"2 mm\" }\n", "");
    let above = "sphere = { diameter = \"2 mm\", gap = \"0.4 mm\", above = \"pool\" }";
    assert!(text.contains(above));
    text.replace(above, drop)
}

fn read(text: &str, sets: &[&str]) -> Result<Scene, String> {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    let read = file::read(text, Path::new("small.toml"), &sets);
    read.map(|loaded| loaded.scene)
        .map_err(|error| error.to_string())
}

fn refused(text: &str, sets: &[&str], parts: &[&str]) {
    holds(&read(text, sets).expect_err("refused"), parts);
}

#[test]
fn a_condition_that_the_scene_cannot_meet_is_refused_with_its_place() {
    let written = "end = \"5 ms\"\nstop_when = [\"rest\", \"crater-deepest\"]";
    refused(
        &lone().replace("end = \"5 ms\"", written),
        &[],
        &[
            "small.toml:20:22: `impact.stop_when[1]` = \"crater-deepest\"",
            "no body of the scene is a pool",
            "remove this word, or add a pool",
        ],
    );
    let word = |word: &str| format!("impact.stop_when=['{word}']");
    refused(
        &lone(),
        &[&word("level-crossed")],
        &["--set impact.stop_when=", "level-crossed", "pool"],
    );
    let rebound = word("rebound");
    refused(
        SMALL,
        &[&rebound],
        &["`impact.stop_when[0]` = \"rebound\"", "several bodies"],
    );
    refused(
        &lone(),
        &[&rebound, "box.z='open'"],
        &["the floor", "box.z"],
    );
    let gravity = "[effects.gravity]\nacceleration = \"9.81 m/s^2\"\n";
    let floats = lone().replace(gravity, "");
    refused(
        &floats,
        &[&rebound, "body.drop.velocity=[0, 0, 0]"],
        &["nothing moves the drop", "velocity"],
    );
    refused(
        SMALL,
        &["impact.stop_when=['deepest']"],
        &[
            "is not known",
            "crater-deepest",
            "level-crossed",
            "rebound",
            "rest",
        ],
    );
    refused(
        SMALL,
        &["impact.stop_when=rest"],
        &["write an array of one of"],
    );

    for (text, sets) in [
        (
            SMALL.to_string(),
            "['crater-deepest', 'level-crossed', 'rest']",
        ),
        (lone(), "['rebound', 'rest']"),
    ] {
        read(&text, &[&format!("impact.stop_when={sets}")]).unwrap();
    }
    let quarter = ["impact.stop_when=['rebound']", "box.symmetry='quarter'"];
    read(&lone(), &quarter).unwrap();
}

fn impact(sets: &[&str]) -> Vec<Setting> {
    let scene = small(sets).scene;
    settings(&scene.impact_input(), &scene).unwrap()
}

#[test]
fn only_a_run_with_conditions_has_them_in_its_key() {
    let named = |list: &[Setting]| {
        let mut settings = list.iter();
        let found = settings.find(|setting| setting.name == "impact.stop_when");
        found.map(|setting| setting.value.clone())
    };
    assert_eq!(named(&impact(&[])), None);
    assert_eq!(impact(&["impact.stop_when=[]"]), impact(&[]));
    let both = impact(&["impact.stop_when=['crater-deepest', 'rest']"]);
    assert_eq!(named(&both).unwrap(), "[crater-deepest, rest]");
    assert_eq!(both.len(), impact(&[]).len() + 1);
    // The order of a list does not count, nor does a word that is there twice.
    assert_eq!(
        impact(&["impact.stop_when=['rest', 'crater-deepest', 'rest']"]),
        both
    );
    for scene in [
        small(&[]).scene,
        small(&["impact.stop_when=['rest']"]).scene,
    ] {
        let post = scene.post_input(Path::new("")).unwrap();
        assert_eq!(named(&settings(&post, &scene).unwrap()), None);
    }
    let words = StopWhen::ALL.map(|condition| serde_json::to_value(condition).unwrap());
    assert_eq!(words, StopWhen::ALL.map(|condition| condition.word()));
}
