//! What a run came to, and the runs of a store: `run`, `show`, `list`, `diff`, `status`, `init`.

use std::fs;
use std::path::Path;

use coronet::measure::series::Series;
use serde_json::Value;

use crate::program::{Ended, Program};

/// Stops a child at its next checkpoint, as Ctrl-C does.
fn interrupt(child: std::process::Child) -> Ended {
    let id = libc::pid_t::try_from(child.id()).unwrap();
    // SAFETY: sends a signal to a child that has not been waited for.
    assert_eq!(unsafe { libc::kill(id, libc::SIGINT) }, 0);
    Ended::from(child.wait_with_output().unwrap())
}

/// The figure of that name, of a list of figures in JSON.
fn figure<'a>(figures: &'a Value, name: &str) -> &'a Value {
    let all = figures.as_array().unwrap_or_else(|| panic!("{figures}"));
    let found = all.iter().find(|figure| figure["name"] == name);
    found.unwrap_or_else(|| panic!("no {name} in {figures}"))
}

fn has(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "no {word:?} in:\n{text}");
    }
}

#[test]
fn a_run_ends_with_its_figures_and_show_begins_with_them() {
    let program = Program::new();
    let objects = program.run(&[]);
    let summary = objects.last().unwrap();
    let depth = figure(&summary["figures"], "largest crater depth");
    let table = Series::read(&program.latest("post").join("measures.csv")).unwrap();
    let (value, time) = table.maximum("crater_depth_m").unwrap();
    assert_eq!(depth["value"].as_f64().unwrap(), value);
    assert_eq!(depth["time_s"].as_f64().unwrap(), time);
    assert_eq!(depth["unit"], "m");
    // It falls 0.5 mm from 1 m/s.
    let contact = (f64::sqrt(1.0 + 2.0 * 9.81 * 0.5e-3) - 1.0) / 9.81;
    let after = depth["time_after_contact_s"].as_f64().unwrap();
    assert!((time - contact - after).abs() < 1e-12);
    let diameter = figure(&summary["figures"], "crater diameter then");
    assert_eq!(diameter["time_s"], depth["time_s"]);
    assert_eq!(figure(&summary["figures"], "mass lost")["value"], 0.0);
    let unexplained = figure(&summary["figures"], "energy unexplained");
    assert!(
        unexplained["value"].as_f64().unwrap() < 0.02,
        "{unexplained}"
    );
    assert_eq!(summary["missing"], Value::Null);

    let shown = |path: &str| program.call(&["show", path, "--json"]).well().objects();
    for name in ["post", "impact"] {
        let facts = shown(&format!("artifacts/latest/tiny/{name}"));
        assert_eq!(facts[0]["figures"], summary["figures"], "{name}");
    }
    assert_eq!(
        shown("artifacts/latest/tiny/pack-drop")[0]["figures"],
        Value::Null
    );

    let told = program.call(&["run", "tiny.toml"]).well().out;
    let line = format!("{:.2} ms", 1e3 * after);
    has(
        &told,
        &[
            "largest crater depth",
            " mm  at ",
            &line,
            "mass lost",
            "0 %",
        ],
    );
    let head = program
        .call(&["show", "artifacts/latest/tiny/post"])
        .well()
        .out;
    let place = head.find("largest crater depth").expect("figures");
    assert!(place < head.find("settings").unwrap(), "{head}");
    // The page tells the same.
    let page = fs::read_to_string(program.latest("post").join("report.html")).unwrap();
    has(
        &page,
        &["largest crater depth", &line, "energy unexplained"],
    );

    // Without its log there are no figures, but all else.
    fs::remove_file(program.latest("impact").join("frames.mcap")).unwrap();
    let shown = program.call(&["show", "artifacts/latest/tiny/post"]);
    shown.badly(4, &["no figures", "frames.mcap: it is missing"]);
    has(&shown.out, &["settings"]);
}

#[test]
fn a_run_that_was_cut_says_what_is_missing_and_how_to_go_on() {
    let program = Program::new();
    let cut = [
        "run",
        "tiny.toml",
        "--until",
        "relax",
        "--set",
        "title=A drop",
    ];
    let ended = program.call(&cut).well();
    has(
        &ended.out,
        &["missing  calibrate, impact, post", "go on    "],
    );
    let command = ended.out.lines().find(|line| line.starts_with("go on"));
    has(command.unwrap(), &["run tiny.toml --set 'title=A drop'"]);
    assert!(!command.unwrap().contains("until"));
    let json = program.run(&["--until=relax"]);
    let summary = json.last().unwrap();
    assert_eq!(summary["missing"].as_array().unwrap().len(), 3);
    assert!(summary["figures"].is_null() && summary["report"].is_null());
    let list = program.call(&["list", "--json"]).well().objects();
    assert_eq!(
        (&list[0]["state"], &list[0]["job"]),
        (&"unfinished".into(), &"impact".into())
    );

    let mut child = program.start(&["run", "tiny.toml", "--set", "impact.end=30 ms"]);
    program.in_flight(&mut child);
    let ended = interrupt(child);
    ended.badly(
        130,
        &[
            "missing  impact (goes on from an unfinished run), post",
            "go on    ",
        ],
    );
}

#[test]
fn what_makes_figures_doubtful_is_told_at_the_end() {
    let program = Program::new();
    let sets = [
        "relax.time=0.2 ms",
        "box.x=open",
        "impact.end=2 ms",
        "post.panels=[]",
    ];
    let mut arguments = vec!["run", "tiny.toml", "--json"];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    let first = program.call(&arguments).well();
    // Nothing runs, and it is still told.
    let ended = program.call(&arguments).well();
    let [first, ended] = [first.objects(), ended.objects()];
    let warnings = &ended.last().unwrap()["warnings"];
    assert_eq!(&first.last().unwrap()["warnings"], warnings);
    has(
        &warnings.to_string(),
        &["relax drop: not at rest", "of the liquid left the box"],
    );
    arguments.retain(|word| *word != "--json");
    let told = program.call(&arguments).well();
    has(
        &told.err,
        &[
            "warning: relax drop: not at rest",
            "warning: ",
            "left the box",
        ],
    );
}

#[test]
fn runs_are_listed_with_what_tells_them_apart_and_compared() {
    let program = Program::new();
    let empty = program.call(&["list"]).well();
    has(&empty.out, &["there are no runs in artifacts"]);
    assert!(program.call(&["list", "--json"]).well().out.is_empty());
    program.run(&["--name", "tiny", "--set", "post.panels=[]"]);
    let faster = ["--name", "loop/fast", "--set", "body.drop.velocity=1.2 m/s"];
    program.run(&[&faster[..], &["--set", "post.panels=[]"]].concat());

    let list = program.call(&["list", "--json"]).well().objects();
    let names: Vec<&str> = list
        .iter()
        .map(|run| run["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["loop/fast", "tiny"], "the newest first");
    for run in &list {
        assert_eq!(run["state"], "finished");
        let settings = run["settings"].as_object().unwrap();
        assert_eq!(settings.len(), 1, "{settings:?}");
        assert!(run["bytes"].as_u64().unwrap() > 10_000);
        figure(&run["figures"], "largest crater depth");
    }
    assert_eq!(list[0]["settings"]["body.drop.velocity"], "1.2 m/s");
    let text = program.call(&["list"]).well().out;
    has(
        &text,
        &[
            "body.drop.velocity",
            "1.2 m/s",
            "crater depth",
            "finished",
            "loop/fast",
        ],
    );
    assert_eq!(text.lines().count(), 3, "{text}");
    the_two_are_compared(&program);
}

fn the_two_are_compared(program: &Program) {
    let diff = program
        .call(&["diff", "tiny", "loop/fast", "--json"])
        .well()
        .objects();
    let settings = diff[0]["settings"].as_array().unwrap();
    assert_eq!(settings.len(), 1, "{settings:?}");
    assert_eq!(settings[0]["first"], "1 m/s");
    assert_eq!(settings[0]["second"], "1.2 m/s");
    let depth = figure(&diff[0]["figures"], "largest crater depth");
    let of = |side: &str| depth[side].as_f64().unwrap();
    assert!((of("second") - of("first") - of("difference")).abs() < 1e-15);
    assert!((of("difference") / of("first") - of("relative")).abs() < 1e-12);
    let curves = diff[0]["curves"].as_array().unwrap();
    let kinetic = curves
        .iter()
        .find(|curve| curve["column"] == "kinetic_energy_J");
    let part = kinetic.unwrap()["over_range"].as_f64().unwrap();
    assert!(part > 0.1 && part <= 1.0, "{part}");
    let folder = "artifacts/latest/loop/fast";
    let text = program.call(&["diff", "tiny", folder]).well().out;
    has(
        &text,
        &[
            "body.drop.velocity",
            "largest crater depth",
            "kinetic_energy_J",
            "%",
        ],
    );

    let same = program
        .call(&["diff", "tiny", "artifacts/latest/tiny/post"])
        .well()
        .out;
    has(&same, &["no setting differs", "0.00 %"]);
    program
        .call(&["diff", "tiny", "no\u{1b}ne"])
        .badly(2, &["no\\u{1b}ne", "loop/fast, tiny"]);
    program
        .call(&["diff", "tiny", "tiny.toml"])
        .badly(2, &["tiny.toml"]);
}

/// Work folders of the store that hold a file of progress.
fn progress_files(program: &Program) -> Vec<std::path::PathBuf> {
    let list = |path: &Path| fs::read_dir(path).into_iter().flatten().flatten();
    let stages = list(&program.path("artifacts"));
    let folders = stages.flat_map(|stage| list(&stage.path()).collect::<Vec<_>>());
    let files = folders.map(|folder| folder.path().join("work/progress.json"));
    files.filter(|path| path.exists()).collect()
}

#[test]
fn a_running_and_an_interrupted_job_are_seen_from_outside() {
    let program = Program::new();
    let status = || program.call(&["status", "--json"]).well().objects();
    let nothing = program.call(&["status"]).well();
    has(&nothing.out, &["no job in artifacts"]);
    assert!(status().is_empty());

    let mut child = program.start(&["run", "tiny.toml", "--set", "impact.end=60 ms"]);
    let id = child.id();
    let work = program.in_flight(&mut child);
    let running = loop {
        let jobs = status();
        if jobs
            .first()
            .is_some_and(|job| job["fraction"].as_f64() > Some(0.0))
        {
            break jobs;
        }
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended unseen: {jobs:?}"
        );
    };
    let job = &running[0];
    assert_eq!(running.len(), 1, "{running:?}");
    assert_eq!(
        (&job["state"], &job["stage"]),
        (&"running".into(), &"impact".into())
    );
    assert_eq!(
        (&job["name"], &job["process"]),
        (&"tiny".into(), &id.into())
    );
    assert!(job["fraction"].as_f64().unwrap() < 1.0 && job["speed"].as_f64().unwrap() > 0.0);
    assert!(job["checkpoint_age_s"].as_f64().unwrap() < 60.0);
    has(job["text"].as_str().unwrap(), &["t = ", "of 60.000 ms"]);
    let text = program.call(&["status"]).well().out;
    has(
        &text,
        &[
            "impact",
            "tiny",
            "%",
            "particle-steps/s",
            &format!("process {id} on"),
        ],
    );
    let list = program.call(&["list", "--json"]).well().objects();
    assert_eq!(
        (&list[0]["name"], &list[0]["state"]),
        (&"tiny".into(), &"running".into())
    );
    program.call(&["verify"]).well();

    interrupt(child).badly(130, &["impact"]);
    let jobs = status();
    assert_eq!(jobs[0]["state"], "interrupted");
    assert!(jobs[0]["left_s"].is_null() && jobs[0]["holder"].is_null());
    assert_eq!(progress_files(&program), [work.join("progress.json")]);
    let list = program.call(&["list"]).well().out;
    has(&list, &["tiny", "unfinished: impact"]);

    the_file_does_no_harm(&program, &work);
}

/// Neither cleaning nor hashing minds the file of progress in `work`, nor one that is damaged.
fn the_file_does_no_harm(program: &Program, work: &Path) {
    for text in [None, Some("{\"pipeline\": 3}"), Some("")] {
        if let Some(text) = text {
            fs::write(work.join("progress.json"), text).unwrap();
        }
        program.call(&["gc", "--yes"]).well();
        program.call(&["verify"]).well();
        assert!(work.exists());
        let jobs = program.call(&["status", "--json"]).well().objects();
        assert_eq!(jobs[0]["stage"], "impact");
        program.call(&["list"]).well();
    }
    program.run(&["--set", "impact.end=3 ms"]);
    let all = ["gc", "--yes", "--older-than", "0s", "--unfinished"];
    program.call(&all).well();
    assert!(!work.exists() && progress_files(program).is_empty());
}

#[test]
fn a_scene_to_begin_with_is_one_that_the_program_accepts() {
    let program = Program::new();
    let list = program.call(&["init", "--list"]).well().out;
    let names: Vec<&str> = list
        .lines()
        .filter_map(|l| l.split_whitespace().next())
        .collect();
    assert!(names.len() >= 4 && names.contains(&"tiny"), "{list}");
    has(&list, &["A small drop on a shallow pool"]);
    for name in names {
        let path = format!("{name}-scene.toml");
        let wrote = program.call(&["init", name, &path]).well();
        has(&wrote.out, &[&path, "coronet run"]);
        let plan = program.call(&["plan", &path]).well();
        has(&plan.out, &["impact", "post"]);
        let text = fs::read_to_string(program.path(&path)).unwrap();
        assert!(
            text.starts_with('#') && !text.contains("#:schema"),
            "{path}"
        );
    }
    // The default is where `coronet run` looks for it.
    program.call(&["init"]).well();
    program.call(&["plan"]).well();
    let before = fs::read(program.path("tiny.toml")).unwrap();
    let ended = program.call(&["init", "tiny"]);
    ended.badly(2, &["tiny.toml", "exists already", "another path"]);
    assert_eq!(fs::read(program.path("tiny.toml")).unwrap(), before);
    program
        .call(&["init", "none"])
        .badly(2, &["none", "default", "tiny"]);
    program.call(&["init", "tiny", "new/folder/x.toml"]).well();
    program.call(&["plan", "new/folder/x.toml"]).well();
    program
        .call(&["init", "tiny", "tiny.toml/x.toml"])
        .badly(5, &["tiny.toml"]);
}

#[test]
fn the_version_names_what_it_was_built_from() {
    let version = Program::new().call(&["--version"]).well().out;
    let expected = format!("coronet {} (", env!("CARGO_PKG_VERSION"));
    assert!(
        version.starts_with(&expected) && version.contains("rustc"),
        "{version}"
    );
}
