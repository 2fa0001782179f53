//! An independent reader: Python's MCAP and protobuf packages decode every message of a log.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use coronet::record::log::{LogWriter, merge, segments};
use serde_json::Value;

use crate::record_log::{frame, setup};

/// Exact versions: what this test says about readers is said about these.
const PACKAGES: [&str; 2] = ["mcap==1.6.0", "mcap-protobuf-support==0.6.0"];

/// Python with the packages, in `target/`, made at the first call. Fails loudly where it cannot be:
/// a log that no other program was shown to read is not tested.
fn python() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let venv = target.join("reader");
    let python = venv.join("bin/python");
    let done = venv.join("complete");
    let lock = File::create(target.join("reader.lock")).unwrap();
    lock.lock().unwrap();
    if !done.exists() {
        run(Command::new("python3")
            .args(["-m", "venv", "--clear"])
            .arg(&venv));
        run(Command::new(&python)
            .args([
                "-m",
                "pip",
                "install",
                "--quiet",
                "--disable-pip-version-check",
            ])
            .args(PACKAGES));
        File::create(done).unwrap();
    }
    python
}

fn run(command: &mut Command) -> Vec<u8> {
    let output = command.output().unwrap_or_else(|error| {
        panic!("the reader test needs python3 with venv: {command:?}: {error}")
    });
    assert!(
        output.status.success(),
        "the reader test needs python3, venv and {PACKAGES:?} from PyPI: {command:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    output.stdout
}

/// Figures of frame `k`; a height that is not known.
fn figures(k: usize) -> Vec<(String, f64)> {
    let named = [
        ("crater_depth_m", k as f64 * 1e-3),
        ("jet_height_m", f64::NAN),
    ];
    named.map(|(name, value)| (name.to_string(), value)).into()
}

#[test]
fn a_reader_of_another_language_decodes_every_frame() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = LogWriter::create(folder.path(), 0, None, &setup()).unwrap();
    for k in 0..7 {
        writer.measured(frame(k), figures(k)).unwrap();
    }
    writer.finish().unwrap();
    let log = folder.path().join("log.mcap");
    merge(&segments(folder.path()).unwrap(), &log).unwrap();

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pipeline/read_log.py");
    let text = run(Command::new(python()).arg(script).arg(&log));
    let found: Value = serde_json::from_slice(&text).unwrap();

    let reals = |value: &Value| -> Vec<f64> {
        let values = value.as_array().expect("a list").iter();
        values.map(|v| v.as_f64().unwrap()).collect()
    };
    for (body, topic) in ["/body/drop", "/body/pool", "/body/gone"]
        .iter()
        .enumerate()
    {
        let cloud = &found["clouds"][*topic];
        assert_eq!(found["schemas"][*topic], "foxglove.PointCloud");
        assert_eq!(cloud["frame"], "box");
        let fields = [
            "x", "y", "z", "vx", "vy", "vz", "speed", "pressure", "density", "id", "red", "green",
            "blue", "alpha", "surface",
        ];
        assert_eq!(cloud["fields"], Value::from(fields.to_vec()));
        let counts = reals(&cloud["counts"]);
        let (ids, xs) = (reals(&cloud["id_sums"]), reals(&cloud["x_sums"]));
        assert_eq!(counts.len(), 7);
        for k in 0..7 {
            let frame = frame(k);
            let own = || (0..frame.id.len()).filter(|i| usize::from(frame.body[*i]) == body);
            assert_eq!(counts[k], own().count() as f64);
            assert_eq!(ids[k], own().map(|i| f64::from(frame.id[i])).sum::<f64>());
            let x: f64 = own().map(|i| f64::from(frame.position[0][i])).sum();
            assert!(
                (xs[k] - x).abs() <= 1e-15,
                "{topic} frame {k}: {} {x}",
                xs[k]
            );
        }
    }
    assert_eq!(found["clouds"]["/wall"]["counts"], serde_json::json!([2]));
    assert_eq!(found["transforms"], serde_json::json!([["world", "box"]]));
    let names = [
        "time_s",
        "time_after_contact_s",
        "kinetic_energy_J",
        "mass_kg",
    ];
    assert_eq!(found["measure_names"], Value::from(names.to_vec()));
    for k in 0..7 {
        let frame = frame(k);
        let after = (k > 0).then(|| frame.time - setup().contact.unwrap());
        assert_eq!(found["measures"][k][1].as_f64(), after);
        let others = [0, 2, 3].map(|n| found["measures"][k][n].as_f64().unwrap());
        assert_eq!(others, [frame.time, frame.scalars[0].1, frame.scalars[1].1]);
    }
    assert_eq!(found["attachments"]["pipeline.toml"], setup().scene_text);
    assert_eq!(found["metadata"]["coronet"]["time_scale"], "2");
    assert_eq!(found["metadata"]["bodies"]["001"], "#285ac8 pool");
    check_figures(&found);
    assert_eq!(found["message_count"], 2 + 7 * 5);
}

/// The channel of [`figures`].
fn check_figures(found: &Value) {
    assert_eq!(found["schemas"]["/figures"], "coronet.Figures");
    let names = [
        "time_s",
        "time_after_contact_s",
        "crater_depth_m",
        "jet_height_m",
    ];
    assert_eq!(found["figure_names"], Value::from(names.to_vec()));
    for k in 0..7 {
        let read = &found["figures"][k];
        assert_eq!(read[0], found["measures"][k][0]);
        assert_eq!(read[2].as_f64(), Some(k as f64 * 1e-3));
        assert!(read[3].is_null());
    }
}
