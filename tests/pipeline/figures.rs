//! `coronet study` with figures and curves, from outside.

use super::program::Program;
use std::fs;

const STUDY: &str = r#"
title = "A tiny crater"
pipeline = "tiny.toml"
set = ["impact.end=2 ms", "frames.interval=0.1 ms", "post.panels=[]"]

[[axis]]
name = "method"
key = "method.name"
values = ["wcsph", "isph"]

[[axis]]
name = "seed"
key = "pack.seed"
values = [71, 72]

[[figure]]
name = "fastest"
column = "speed_max_m_s"

[[figure]]
name = "when"
column = "speed_max_m_s"
of = "when"

[[figure]]
name = "energy of a kilogram"
column = "kinetic_energy_J"
of = "mean"
over = "mass_kg"
from = "0.45 ms"

[[figure]]
name = "mass at 0.3 ms over that of a table"
column = "mass_kg"
at = "0.3 ms"
reference = "table.csv"
clock = "contact"

[[figure]]
name = "never"
column = "kinetic_energy_J"
of = "mean"
from = "1 s"

[[curves]]
column = "speed_max_m_s"
each = "method"
reference = "table.csv"
"#;

/// Heavier by 1 kg in a second.
const TABLE: &str = "time_s,mass_kg,speed_max_m_s\n0,1,3\n1,2,3\n";

fn program(study: &str) -> Program {
    let program = Program::with("study.toml", study);
    fs::write(program.path("table.csv"), TABLE).unwrap();
    program
}

/// Of the tiny drop, which falls 0.5 mm from 1 m/s, s: t + g t^2 / 2 is the gap.
fn contact() -> f64 {
    (f64::sqrt(1.0 + 2.0 * 9.81 * 0.5e-3) - 1.0) / 9.81
}

/// Columns of a table by name; blanks are `None`.
fn column(table: &str, name: &str) -> Vec<Option<f64>> {
    let mut lines = table.lines().map(|line| line.split(','));
    let place = lines.next().unwrap().position(|head| head == name);
    let place = place.expect(name);
    lines
        .map(|mut row| row.nth(place).unwrap().parse().ok())
        .collect()
}

#[test]
fn figures_are_those_of_the_measures() {
    let of_isph = "[[figure]]\nname = \"iterations\"\ncolumn = \"pressure_iterations\"\n";
    let program = program(&(STUDY.to_string() + of_isph));
    // Of a form that the study had before.
    let old = program.path("artifacts/latest/study/promises.md");
    fs::create_dir_all(old.parent().unwrap()).unwrap();
    fs::write(&old, "old").unwrap();
    let said = program.call(&["study", "study.toml"]).well();
    let warning = "warning: wcsph, 71 does not measure `pressure_iterations`";
    assert!(said.err.contains(warning), "{}", said.err);
    assert!(
        said.out.contains("| method | seed | fastest | when |"),
        "{}",
        said.out
    );
    assert!(!old.exists());
    let read = |name: &str| fs::read_to_string(program.path(&format!("artifacts/latest/{name}")));
    let table = read("study/figures.csv").unwrap();
    let found = |name: &str| column(&table, name);
    for point in 0..4 {
        let measures = read(&format!("study-0{}/post/measures.csv", point + 1)).unwrap();
        let of = |name: &str| column(&measures, name).into_iter().map(Option::unwrap);
        let fastest = of("speed_max_m_s").fold(0.0, f64::max);
        assert_eq!(found("fastest")[point], Some(fastest));
        let when = of("speed_max_m_s")
            .position(|speed| speed == fastest)
            .unwrap();
        let when = of("time_s").nth(when).unwrap() - contact();
        assert!((found("when")[point].unwrap() - when).abs() < 1e-12);
        let late: Vec<bool> = of("time_s")
            .map(|time| time >= contact() + 0.45e-3)
            .collect();
        let mean = |name: &str| {
            let kept: Vec<f64> = of(name)
                .zip(&late)
                .filter(|(_, l)| **l)
                .map(|(v, _)| v)
                .collect();
            assert!(kept.len() > 1 && kept.len() < late.len());
            kept.iter().sum::<f64>() / kept.len() as f64
        };
        let energy = mean("kinetic_energy_J") / mean("mass_kg");
        let told = found("energy of a kilogram")[point].unwrap();
        assert!((told / energy - 1.0).abs() < 1e-12, "{told} {energy}");
        let mass = of("mass_kg").next().unwrap() / 1.0003;
        let told = found("mass at 0.3 ms over that of a table")[point].unwrap();
        assert!((told / mass - 1.0).abs() < 1e-9, "{told} {mass}");
        assert_eq!(found("never")[point], None);
        assert_eq!(found("iterations")[point].is_some(), point >= 2);
    }
    let page = read("study/figures.md").unwrap();
    assert_eq!(page.matches("| - |").count(), 4, "{page}");
    // One plot a method, one curve a seed.
    for method in ["wcsph", "isph"] {
        let plot = read(&format!("study/speed-max-{method}.svg")).unwrap();
        for seed in ["71", "72"] {
            assert!(plot.contains(&format!("aria-label=\"{seed}\"")), "{plot}");
        }
        for text in ["reference", "time after contact (ms)", "speed max (m/s)"] {
            assert!(plot.contains(&format!("aria-label=\"{text}\"")), "{plot}");
        }
        let pdf = program.path(&format!("artifacts/latest/study/speed-max-{method}.pdf"));
        assert!(fs::read(pdf).unwrap().starts_with(b"%PDF-1."));
    }
    let again = program.call(&["study", "study.toml"]).well();
    assert_eq!(again.err.matches("fresh").count(), 4, "{}", again.err);
    assert_eq!(read("study/figures.csv").unwrap(), table);
}

#[test]
fn mistakes_in_figures_are_named() {
    let before = [
        (
            "[[curves]]",
            "[error]\ncolumn = \"x\"\nvalue = 1.0\n[[curves]]",
            "one of [error]",
        ),
        (
            "from = \"0.45 ms\"",
            "from = \"0.5 mm\"",
            "[[figure]] `energy of a kilogram`: `0.5 mm`",
        ),
        (
            "each = \"method\"",
            "each = \"mathod\"",
            "axes are method, seed",
        ),
        ("of = \"when\"", "of = \"whan\"", "whan"),
        ("\"table.csv\"", "\"tuble.csv\"", "tuble.csv"),
        ("[71, 72]", "[71, 71]", "each value of an axis once"),
        (
            "impact.end=2 ms",
            "pack.seed=3",
            "an axis changes `pack.seed`",
        ),
        (
            "\"mass_kg\"\nat",
            "\"kinetic_energy_J\"\nat",
            "no column `kinetic_energy_J`",
        ),
        (
            "at = \"0.3 ms\"",
            "at = \"0.3 ms\"\nover = \"kinetic_energy_J\"",
            "no column `kinetic_energy_J`",
        ),
        (
            "at = \"0.3 ms\"",
            "at = \"0.3 ms\"\nto = \"1 ms\"",
            "without from and to",
        ),
        (
            "fastest\"\ncolumn = \"speed_max",
            "fastest\"\ncolumn = \"speed_mux",
            "no point measures `speed_mux_m_s`; columns are time_s, ",
        ),
    ];
    for (old, new, word) in before {
        let study = STUDY.replace(old, new);
        assert_ne!(study, STUDY, "{old}");
        let program = program(&study);
        program
            .call(&["study", "study.toml"])
            .badly(2, &["study.toml", word]);
        assert!(!program.path("artifacts").exists());
    }
}

#[test]
fn warnings_of_points_are_told_and_kept() {
    let study = "title = \"ends\"\npipeline = \"tiny.toml\"\n\
                 set = [\"relax.time=0.2 ms\", \"impact.end=2 ms\", \"post.panels=[]\"]\n\
                 [[axis]]\nname = \"speed\"\nkey = \"body.drop.velocity\"\n\
                 values = [\"1 m/s\", \"0.5 m/s\"]\n\
                 [[figure]]\nname = \"depth\"\ncolumn = \"crater_depth_m\"\n";
    let program = program(study);
    let told = program.call(&["study", "study.toml"]).well();
    let warned = |line: &&str| line.starts_with("warning: ") && line.contains(" of 2 points (");
    let lines: Vec<&str> = told.err.lines().filter(warned).collect();
    let restless = |line: &&&str| {
        line.starts_with("warning: 2 of 2 points (1 m/s; 0.5 m/s): ")
            && line.contains("relax drop: not at rest")
    };
    let count = lines.iter().filter(restless);
    assert_eq!(count.count(), 1, "{}", told.err);
    let page = fs::read_to_string(program.path("artifacts/latest/study/figures.md")).unwrap();
    for line in lines {
        assert!(
            page.contains(line.trim_start_matches("warning: ")),
            "{page}"
        );
    }
}
