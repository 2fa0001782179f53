//! Nothing false in a result: clocks of references, warnings before, during and after a run.

use super::program::{Program, members};
use serde_json::Value;
use std::fs;

/// `--set` that compares with a table beside the scene.
const OWN: &str = "post.references=[{ label = \"own\", path = \"own.csv\" }]";

fn notes(objects: &[Value]) -> Vec<String> {
    let post = objects.iter().find(|object| object["stage"] == "post");
    let notes = post.expect("a run ends with post")["notes"].as_array();
    let text = |note: &Value| note.as_str().unwrap().to_string();
    notes.unwrap().iter().map(text).collect()
}

#[test]
fn a_reference_that_changes_during_a_run_is_that_of_its_key() {
    let table = "time_s,crater_depth_m\n0.001,0.0003\n0.003,0.0007\n";
    let [here, there] = [0, 1].map(|_| Program::with("own.csv", table));
    let arguments = ["run", "tiny.toml", "--json", "--set", OWN];
    let mut child = here.start(&arguments);
    here.in_flight(&mut child);
    fs::write(here.path("own.csv"), table.replace(",0.0", ",0.9")).unwrap();
    assert!(child.wait().unwrap().success());
    fs::write(here.path("own.csv"), table).unwrap();
    let found = here.call(&arguments).well().objects();
    let statuses = members(&found, "status");
    let is_fresh = |status: &String| status == "fresh";
    assert!(statuses.values().all(is_fresh), "{statuses:?}");
    let wanted = there.call(&arguments).well().objects();
    assert_eq!(here.fingerprint(&found), there.fingerprint(&wanted));
}

#[test]
fn measures_have_both_clocks() {
    let program = Program::new();
    program.run(&[]);
    let table = fs::read_to_string(program.latest("post").join("measures.csv")).unwrap();
    // The drop falls 0.5 mm from 1 m/s.
    let contact = ((1.0f64 + 2.0 * 9.81 * 0.5e-3).sqrt() - 1.0) / 9.81;
    let times = table.lines().skip(1).map(|line| {
        let cells: Vec<Option<f64>> = line.split(',').take(2).map(|c| c.parse().ok()).collect();
        (cells[0].unwrap(), cells[1])
    });
    let times: Vec<(f64, Option<f64>)> = times.collect();
    assert!(times[0].1.is_none() && times.len() > 5, "{times:?}");
    for (time, after) in times {
        let expected = (time >= contact).then_some(time - contact);
        let differ = after.zip(expected).map_or(0.0, |(a, b)| (a - b).abs());
        assert!(
            after.is_some() == expected.is_some() && differ < 1e-12,
            "{time} {after:?}"
        );
    }
}

#[test]
fn a_run_compared_with_its_own_measures_has_no_error() {
    let program = Program::new();
    program.run(&[]);
    let own = program.latest("post").join("measures.csv");
    let table = fs::read_to_string(&own).unwrap();
    fs::write(program.path("own.csv"), &table).unwrap();
    let compared = notes(&program.run(&["--set", OWN]));
    let norms: Vec<&String> = compared
        .iter()
        .filter(|note| note.contains("against own"))
        .collect();
    assert!(norms.len() > 5, "{compared:?}");
    for norm in norms {
        assert!(norm.contains("L2 0.0 %, max 0.0 %"), "{norm}");
    }
    // The same table by the other clock is another curve.
    let other = table.replacen(
        "time_s,time_after_contact_s",
        "time_after_contact_s,other",
        1,
    );
    fs::write(program.path("own.csv"), other).unwrap();
    let compared = notes(&program.run(&["--set", OWN]));
    let energy = compared
        .iter()
        .find(|note| note.starts_with("kinetic_energy_J against own"));
    assert!(!energy.unwrap().contains("L2 0.0 %"), "{energy:?}");
    // A study too.
    fs::write(program.path("own.csv"), &table).unwrap();
    // With both clocks either gives no error; times from the start taken for those from contact do.
    let contact = "clock = \"contact\"";
    for (clock, other, is_zero) in [
        ("", "time_after_contact_s", true),
        (contact, "time_after_contact_s", true),
        (contact, "other", false),
    ] {
        let study = format!(
            "title = \"own\"\npipeline = \"tiny.toml\"\n\
             [[axis]]\nname = \"seed\"\nkey = \"pack.seed\"\nvalues = [71]\n\
             [error]\ncolumn = \"kinetic_energy_J\"\nreference = \"own.csv\"\n{clock}\n"
        );
        let seed = "pack.seed=71";
        program.run(&["--set", seed]);
        let own = fs::read_to_string(program.latest("post").join("measures.csv")).unwrap();
        let own = own.replacen("time_after_contact_s", other, 1);
        fs::write(program.path("own.csv"), own).unwrap();
        fs::write(program.path("study.toml"), study).unwrap();
        program.call(&["study", "study.toml"]).well();
        let table = fs::read_to_string(program.path("artifacts/latest/study/study.csv")).unwrap();
        let mut rows = table
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let place = rows
            .next()
            .unwrap()
            .iter()
            .position(|name| *name == "error")
            .unwrap();
        let error: f64 = rows.next().unwrap()[place].parse().unwrap();
        assert_eq!(error == 0.0, is_zero, "{clock}: {error}");
    }
}

#[test]
fn a_reference_that_cannot_be_used_is_refused_before_the_run() {
    let program = Program::new();
    fs::write(program.path("own.csv"), "time_s,mass_kg\n0,1\n1,heavy\n").unwrap();
    for command in ["plan", "run"] {
        let ended = program.call(&[command, "tiny.toml", "--set", OWN]);
        ended.badly(2, &["post.references", "own.csv", "line 3", "heavy"]);
    }
    assert!(!program.path("artifacts/pack").exists());
}

#[test]
fn nonsense_is_told_before_the_run() {
    let program = Program::new();
    let quiet = program.call(&["plan", "tiny.toml"]).well();
    assert!(!quiet.err.contains("warning"), "{}", quiet.err);
    let sets = ["--set", "liquid.density=1", "--until", "pack"];
    for arguments in [
        &["plan", "tiny.toml", "--set", "liquid.density=1"][..],
        &["plan", "tiny.toml", "--json", "--set", "liquid.density=1"],
        &[&["run", "tiny.toml"][..], &sets].concat(),
    ] {
        let told = program.call(arguments).well();
        let line = told
            .err
            .lines()
            .find(|line| line.starts_with("warning: `liquid.density` = "));
        assert!(line.is_some(), "{arguments:?}: {}", told.err);
    }
}

#[test]
fn a_body_that_did_not_come_to_rest_is_in_the_report() {
    let program = Program::new();
    let sets = [
        "--set",
        "relax.time=0.01 ms",
        "--set",
        "relax.kinetic_energy=1e-12",
    ];
    let first = program
        .call(&[&["run", "tiny.toml"][..], &sets].concat())
        .well();
    assert!(
        first.err.contains("warning: relax pool: not at rest"),
        "{}",
        first.err
    );
    // Only there, not beside the stage too.
    assert!(!first.out.contains("not at rest"), "{}", first.out);
    // Also where the relaxation is an earlier run's.
    let more = ["--set", "body.drop.velocity=1.1 m/s"];
    let second = program
        .call(&[&["run", "tiny.toml"][..], &sets, &more].concat())
        .well();
    assert!(
        second.err.contains("warning: relax pool: not at rest"),
        "{}",
        second.err
    );
    let page = fs::read_to_string(program.latest("post").join("report.html")).unwrap();
    assert!(page.contains("body <code>pool</code> begins the impact not at rest"));
}

#[test]
fn liquid_that_left_the_box_is_told_on_the_way_and_at_the_end() {
    let program = Program::new();
    // Its drop is thrown out through the top.
    let sets = ["--set", "body.drop.velocity=-2 m/s"];
    let told = program
        .call(&[&["run", "tiny.toml"][..], &sets].concat())
        .well();
    let starts = [
        "warning: `body.drop.velocity` = ",
        "warning: `mass_removed_kg` = ",
    ];
    for start in starts {
        assert!(
            told.err.lines().any(|line| line.starts_with(start)),
            "{}",
            told.err
        );
    }
    assert!(!told.out.contains("`mass_removed_kg`"), "{}", told.out);
    let on_the_way = |line: &str| {
        line.starts_with("warning: impact: ") && line.contains("of the liquid has left the box")
    };
    assert!(told.err.lines().any(on_the_way), "{}", told.err);
    let page = fs::read_to_string(program.latest("post").join("report.html")).unwrap();
    assert!(page.contains("<b>Warning:</b> <code>mass_removed_kg</code> = "));
}

#[test]
fn a_plan_forecasts_ranks() {
    let program = Program::new();
    let plan = |more: &[&str]| program.plan(&[&["--set", "pack.spacing=0.05 mm"], more].concat());
    let shared = |ranks: &str| plan(&["--ranks", ranks]).pop().unwrap();
    let (two, four) = (shared("2"), shared("4"));
    assert_eq!((&two["ranks"], &four["ranks"]), (&2.into(), &4.into()));
    let memory = |plan: &Value, rank: usize| plan["memory_bytes"][rank].as_f64().unwrap();
    let alone = plan(&[]).into_iter().find(|job| job["stage"] == "impact");
    let alone = alone.unwrap()["memory_bytes"].as_f64().unwrap();
    assert!(alone > memory(&two, 1) && memory(&two, 1) > memory(&four, 1));
    assert!(memory(&four, 0) > memory(&four, 1));
    let seconds = |plan: &Value| plan["seconds"].as_f64().unwrap();
    assert!(seconds(&two) > seconds(&four));
    let few = program.call(&["plan", "tiny.toml", "--ranks", "99"]).well();
    let wanted = ["on 99 ranks", "can have particles"];
    assert!(
        wanted.iter().all(|words| few.out.contains(words)),
        "{}",
        few.out
    );
    let paper = ["--set", "method.name=isph", "--set", "method.preset=paper"];
    program
        .call(&[&["plan", "tiny.toml", "--ranks", "2"], &paper[..]].concat())
        .badly(2, &["several processes", "effects.tension.form"]);
    // Too much for any machine, but not for many.
    let much = ["plan", "tiny.toml", "--set", "pack.spacing=0.5 um"];
    program
        .call(&much)
        .badly(2, &["of memory", "coronet plan --ranks"]);
    program
        .call(&[&much[..], &["--ranks", "1000"]].concat())
        .well();
}

#[test]
fn a_reference_that_counts_from_a_contact_waits_for_one() {
    let table = "\"time_after_contact_s\",\"crater_depth_m\"\n0.001,0.0003\n0.003,0.0007\n";
    let program = Program::with("own.csv", table);
    let early = [
        "run",
        "tiny.toml",
        "--json",
        "--set",
        OWN,
        "--set",
        "impact.end=0.3 ms",
    ];
    let told = notes(&program.call(&early).well().objects()).join(" ");
    assert!(told.contains("Nothing of the reference own"), "{told}");
    let whole = ["run", "tiny.toml", "--json", "--set", OWN];
    let told = notes(&program.call(&whole).well().objects()).join(" ");
    assert!(!told.contains("Nothing of the reference own"), "{told}");
}
