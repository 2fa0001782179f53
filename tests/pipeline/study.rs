//! `coronet study` from outside.

use super::program::Program;
use std::fs;
use std::thread::sleep;
use std::time::Duration;

const STUDY: &str = r#"
title = "Depth of a tiny crater"
pipeline = "tiny.toml"
set = ["impact.end=2 ms", "post.panels=[]"]

[[axis]]
name = "spacing"
key = "pack.spacing"
values = ["0.6 mm", "0.4 mm", "0.3 mm"]

[[axis]]
name = "speed of sound"
points = [
    { label = "adaptive" },
    { label = "constant", set = ["method.wcsph.sound_speed=constant"] },
]

[error]
column = "kinetic_energy_J"
finest = true
"#;

fn program() -> Program {
    Program::with("study.toml", STUDY)
}

/// The table without its costs and without who is on the front, which hangs on them.
fn results(program: &Program) -> Vec<Vec<String>> {
    let path = program.path("artifacts/latest/study/study.csv");
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().map(|line| line.split(',').map(str::to_string));
    let rows = rows.map(Iterator::collect::<Vec<String>>);
    rows.map(|row| row[..row.len() - 4].to_vec()).collect()
}

/// A column of the table.
fn column(results: &[Vec<String>], name: &str) -> Vec<String> {
    let place = results[0].iter().position(|found| found == name).unwrap();
    results[1..].iter().map(|row| row[place].clone()).collect()
}

/// Twelve points, killed five times.
#[test]
fn a_killed_study_goes_on_to_the_same_table() {
    let seeds = "[[axis]]\nname = \"seed\"\nkey = \"pack.seed\"\nvalues = [1, 2]\n\n[error]";
    let study = STUDY.replace("[error]", seeds);
    let twelve = || {
        let program = program();
        fs::write(program.path("study.toml"), &study).unwrap();
        program
    };
    let whole = twelve();
    let said = whole.call(&["study", "study.toml"]).well();
    let expected = results(&whole);
    assert_eq!(expected.len(), 1 + 12);
    assert_eq!(expected[0][1..4], ["spacing", "speed of sound", "seed"]);
    // The finest point is what the others are measured against.
    let errors = column(&expected, "error");
    assert_eq!(errors.iter().filter(|error| error.is_empty()).count(), 1);
    for group in ["adaptive, 1", "constant, 2"] {
        let line = said.out.lines().find(|line| line.starts_with(group));
        assert!(
            line.is_some_and(|l| l.contains("time ~ N^")),
            "{}",
            said.out
        );
    }
    assert!(
        whole
            .path("artifacts/latest/study/error-against-time.svg")
            .is_file()
    );

    let cut = twelve();
    for wait in [300, 900, 1700, 2500, 2500] {
        let mut child = cut.command(&["study", "study.toml"]).spawn().unwrap();
        sleep(Duration::from_millis(wait));
        let _ = child.kill();
        child.wait().unwrap();
    }
    cut.call(&["study", "study.toml", "--jobs", "2", "--into", "tables"])
        .well();
    assert_eq!(results(&cut), expected);
    let read = |name: &str| fs::read_to_string(cut.path(name)).unwrap();
    let (head, table) = (
        read("tables/study.csv"),
        read("artifacts/latest/study/study.csv"),
    );
    let head = head.strip_suffix(&table).unwrap();
    assert!(cut.path("tables/study.svg").is_file());
    for start in [
        "version: coronet ",
        "flow: ",
        "machine: ",
        "date: 2",
        "command: coronet study",
    ] {
        assert!(head.contains(&format!("# {start}")), "{head}");
    }
    // Nothing is left to do.
    let again = cut.call(&["study", "study.toml"]).well();
    assert_eq!(again.err.matches("fresh").count(), 12, "{}", again.err);
}

#[test]
fn mistakes_are_named_before_anything_runs() {
    let cases = [
        ("finest = true", "finest = true\nvalue = 1.0", "exactly one"),
        (
            "key = \"pack.spacing\"",
            "key = \"pack.spaing\"",
            "pack.spacing",
        ),
        ("column =", "colum =", "colum"),
        ("values =", "points = []\nvalue =", "value"),
        // Such an axis would lie about its points.
        (
            "method.wcsph.sound_speed=constant",
            "pack.spacing=0.5 mm",
            "pack.spacing",
        ),
        (
            "name = \"speed of sound\"",
            "name = \"spacing\"",
            "two columns",
        ),
        (
            "finest = true",
            "finest = true\nfrom = \"2 ms\"\nto = \"1 ms\"",
            "is after `to`",
        ),
    ];
    for (old, new, word) in cases {
        let program = program();
        fs::write(program.path("study.toml"), STUDY.replace(old, new)).unwrap();
        program
            .call(&["study", "study.toml"])
            .badly(2, &["study.toml", word]);
        assert!(!program.path("artifacts").exists());
    }
}

/// A point that fails is told in the table and takes no other with it.
#[test]
fn a_point_may_fail() {
    let program = program();
    let study = STUDY.replace("\"0.6 mm\", ", "").replace(
        "set = [\"method.wcsph.sound_speed=constant\"]",
        "set = [\"method.wcsph.reference_speed=0.01 m/s\"]",
    );
    fs::write(program.path("study.toml"), study).unwrap();
    program.call(&["study", "study.toml"]).well();
    let states = column(&results(&program), "status");
    assert_eq!(states, ["done", "diverged", "done", "diverged"]);
}

/// So that a script sees it.
#[test]
fn a_study_without_a_point_that_ended_well_fails() {
    let program = program();
    let study = STUDY.replace("\"0.6 mm\", \"0.4 mm\", ", "").replace(
        "set = [\"impact.end=2 ms\"",
        "set = [\"method.wcsph.reference_speed=0.01 m/s\", \"impact.end=2 ms\"",
    );
    fs::write(program.path("study.toml"), study).unwrap();
    let ended = program.call(&["study", "study.toml"]);
    ended.badly(3, &["every point failed", "diverged"]);
    assert_eq!(column(&results(&program), "status"), ["diverged"; 2]);
}

/// Seeds that only repeat are one group, of which the worst counts; what it costs is a choice.
#[test]
fn what_repeats_and_what_costs_is_said_in_the_study() {
    let program = program();
    let seeds = "[[axis]]\nname = \"seed\"\nkey = \"pack.seed\"\nvalues = [1, 2]\nrepeat = true\n";
    let start = STUDY.find("[[axis]]\nname = \"speed of sound\"").unwrap();
    let end = STUDY.find("[error]").unwrap();
    let study = format!("{}{seeds}\n{}", &STUDY[..start], &STUDY[end..]);
    let study = study.replace("finest = true", "value = 1.0");
    let text = study.replacen("title", "cost = \"memory\"\ntitle", 1);
    fs::write(program.path("study.toml"), text).unwrap();
    let said = program.call(&["study", "study.toml"]).well();
    assert!(said.out.contains("all: error"), "{}", said.out);
    assert!(said.out.contains("memory ~ N^"), "{}", said.out);
    let found = program.path("artifacts/latest/study/study.csv");
    let found = fs::read_to_string(found).unwrap();
    let memory = found
        .lines()
        .skip(1)
        .map(|line| line.rsplit(',').next().unwrap());
    let memory: Vec<f64> = memory.map(|cell| cell.parse().unwrap()).collect();
    assert_eq!(memory.len(), 6);
    assert!(
        memory.iter().all(|m| (5.0..500.0).contains(m)),
        "{memory:?}"
    );
    let on_front = found
        .lines()
        .skip(1)
        .map(|line| line.rsplit(',').nth(3).unwrap());
    let on_front: Vec<&str> = on_front.collect();
    let front = |pair: &[&str]| pair.iter().filter(|on| **on == "true").count();
    assert!(on_front.contains(&"true"), "{on_front:?}");
    assert!(
        on_front.chunks(2).all(|pair| front(pair) <= 1),
        "{on_front:?}"
    );
    let plot = program.path("artifacts/latest/study/error-against-time.svg");
    let plot = fs::read_to_string(plot).unwrap();
    assert!(plot.contains("memory of the impact (MB)"));
    // The worst of each spacing is joined to the next, the other is a small ring; a group without a
    // name has no legend.
    assert_eq!(plot.matches("r=\"3\"").count(), 3, "{plot}");
    assert_eq!(plot.matches("r=\"1.8\"").count(), 3, "{plot}");
    fs::write(
        program.path("study.toml"),
        study.replacen("title", "cost = \"money\"\ntitle", 1),
    )
    .unwrap();
    program
        .call(&["study", "study.toml"])
        .badly(2, &["study.toml", "money"]);
}

#[test]
fn a_study_is_looked_at_before_it_runs() {
    let program = program();
    let look = ["study", "study.toml", "--look"];
    let said = program.call(&look).well().out;
    assert!(said.contains("missing  about"), "{said}");
    assert!(said.contains("6 missing; about"), "{said}");
    assert!(!program.path("artifacts/latest/study").exists());
    program.call(&["study", "study.toml"]).well();
    let said = program.call(&look).well().out;
    assert!(
        said.trim_end()
            .ends_with("6 done, 0 failed, 0 running, 0 waiting, 0 missing")
    );
    for option in ["--wait", "--cancel", "--time=1:00", "--cores=2"] {
        let name = option.split('=').next().unwrap();
        program
            .call(&["study", "study.toml", option])
            .badly(2, &["--on slurm", name]);
    }
}

#[test]
fn a_study_keeps_to_the_scene_with_which_it_began() {
    let program = program();
    let mut child = program.start(&["study", "study.toml", "--jobs", "1"]);
    while !program.path("artifacts/impact").exists() {
        sleep(Duration::from_millis(2));
    }
    let path = program.path("tiny.toml");
    let scene = fs::read_to_string(&path).unwrap();
    fs::write(&path, scene.replace("1000 kg/m^3", "2000 kg/m^3")).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(2));
    assert!(!program.path("artifacts/latest/study/study.csv").exists());
    fs::write(&path, scene).unwrap();
    program.call(&["study", "study.toml"]).well();
}

#[test]
fn files_of_a_user_stay_as_they_are() {
    let program = program();
    let into = ["study", "study.toml", "--into", "here"];
    fs::create_dir(program.path("here")).unwrap();
    for name in ["study.csv", "study-depth.svg"] {
        let path = program.path("here").join(name);
        fs::write(&path, "time_s,crater_depth_m\n").unwrap();
        program.call(&into).badly(2, &[name, "stays as it is"]);
        fs::remove_file(path).unwrap();
    }
    assert!(!program.path("artifacts").exists());
    for _ in 0..2 {
        program.call(&into).well();
    }
    let tune = [
        "tune",
        "study.toml",
        "--error",
        "50 %",
        "--output",
        "study.toml",
    ];
    program.call(&tune).badly(2, &["study.toml exists already"]);
}

/// The later axis would overwrite what the label of the other says.
#[test]
fn an_axis_of_a_table_and_one_of_its_keys_are_refused() {
    let program = program();
    let table = "{ label = \"5\", set = ['effects.gravity={ acceleration = \"5 m/s^2\" }'] }";
    let axes = format!(
        "[[axis]]\nname = \"pull\"\nkey = \"effects.gravity.acceleration\"\nvalues = [1, 9]\n\n\
         [[axis]]\nname = \"table\"\npoints = [{table}]\n\n[error]"
    );
    fs::write(program.path("study.toml"), STUDY.replace("[error]", &axes)).unwrap();
    let words = [
        "`effects.gravity`",
        "`effects.gravity.acceleration`",
        "join",
    ];
    program.call(&["study", "study.toml"]).badly(2, &words);
}

#[test]
fn an_axis_has_no_name_of_a_column() {
    let program = program();
    for name in ["error", "particles", "wall_s"] {
        let study = STUDY.replace("name = \"spacing\"", &format!("name = \"{name}\""));
        fs::write(program.path("study.toml"), study).unwrap();
        let said = program.call(&["study", "study.toml"]);
        said.badly(2, &["two columns of the table", name, "rename"]);
    }
}
