//! What of a log is exported, and what an export removes from its folder.

use std::fs;

use coronet::record::export::{Format, LIST, Selection, Which};
use coronet::record::log::{LogWriter, Reel};

use crate::record_export::{export_log, f32s, write_log};
use crate::record_log::{frame, setup};

#[test]
fn a_list_from_a_stranger_removes_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(folder.path().join("outside.csv"), "outside").unwrap();
    fs::write(out.join("notes.txt"), "notes").unwrap();
    let outside = folder.path().join("outside.csv").display().to_string();
    let list = serde_json::json!({
        "coronet": "0", "files": ["../outside.csv", outside, "notes.txt", "..", "", "gone.csv"],
    });
    fs::write(out.join(LIST), list.to_string()).unwrap();
    assert_eq!(export_log(&log, &out, Format::Npz).unwrap().removed, 0);
    assert!(folder.path().join("outside.csv").is_file() && out.join("notes.txt").is_file());
    fs::write(out.join(LIST), "my own list").unwrap();
    let error = export_log(&log, &out, Format::Npz).unwrap_err();
    assert!(
        error.is_usage() && error.to_string().contains("another folder"),
        "{error}"
    );
    assert_eq!(fs::read_to_string(out.join(LIST)).unwrap(), "my own list");
}

#[test]
fn frames_are_chosen_by_time() {
    let times = [0.0, 0.5e-3, 1.001e-3, 1.5e-3, 2.0e-3];
    let at = |instants: &[f64]| Which::Nearest(instants.to_vec()).of(&times);
    assert_eq!(at(&[1e-3]).unwrap(), [2]);
    // In order of time, each once; on both sides of a middle.
    assert_eq!(at(&[2.1e-3, 0.1e-3, 0.0]).unwrap(), [0, 4]);
    assert_eq!(at(&[0.24e-3, 0.26e-3]).unwrap(), [0, 1]);
    for outside in [2.3e-3, -0.3e-3, f64::NAN] {
        assert!(at(&[outside]).is_err(), "{outside}");
    }
    assert!(Which::Nearest(vec![0.0]).of(&[]).is_err());
    let every = |step: f64| Which::Every(step).of(&times).unwrap();
    assert_eq!(every(1e-3), [0, 2, 4]);
    assert_eq!(every(1.5e-3), [0, 3]);
    assert_eq!(every(1e-9), [0, 1, 2, 3, 4]);
    assert_eq!(every(1.0), [0]);
    assert!(Which::Every(1.0).of(&[]).unwrap().is_empty());
}

#[test]
fn a_body_at_an_instant_becomes_arrays() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let body = setup().bodies[1].name.clone();
    let selection = Selection {
        which: Which::Nearest(vec![frame(1).time]),
        bodies: vec![body],
        ..Selection::default()
    };
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let export = |selection| {
        coronet::record::export::export_log(&Reel::finished(&log), &out, Format::Npz, selection)
    };
    let exported = export(&selection).unwrap();
    assert_eq!(
        (exported.files.len(), &exported.times[..]),
        (2, &[frame(1).time][..])
    );
    let expected = frame(1);
    let own: Vec<usize> = (0..59).filter(|&i| expected.body[i] == 1).collect();
    assert!(!own.is_empty() && own.len() < 59);
    let mut archive = zip::ZipArchive::new(fs::File::open(&exported.files[1]).unwrap()).unwrap();
    let mut array = |name: &str| {
        let mut bytes = Vec::new();
        let mut entry = archive.by_name(&format!("{name}.npy")).unwrap();
        std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
        assert_eq!(bytes[..8], *b"\x93NUMPY\x01\x00");
        let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((end % 64, bytes[end - 1]), (0, b'\n'));
        (
            String::from_utf8_lossy(&bytes[10..end]).into_owned(),
            bytes[end..].to_vec(),
        )
    };
    let (header, points) = array("position");
    let count = own.len();
    let facts = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({count}, 3), }}");
    assert_eq!(header.trim_end(), facts);
    let [x, y, z] = &expected.position;
    let interleaved: Vec<f32> = own.iter().flat_map(|&i| [x[i], y[i], z[i]]).collect();
    assert_eq!(f32s(&points), interleaved);
    let (header, time) = array("time_s");
    assert!(header.contains("'shape': ()"), "{header}");
    assert_eq!(time, expected.time.to_le_bytes());

    // The mass of a particle is known; that of all of them is not that of the body.
    assert!(archive.by_name("mass.npy").is_ok());
    for scalar in ["mass_kg", "kinetic_energy_J"] {
        assert!(
            archive.by_name(&format!("{scalar}.npy")).is_err(),
            "{scalar}"
        );
    }

    let nobody = Selection {
        bodies: vec!["nobody".into()],
        ..Selection::default()
    };
    let error = export(&nobody).unwrap_err();
    assert!(
        error.is_usage() && error.to_string().contains("`nobody`"),
        "{error}"
    );
    assert!(exported.files[1].is_file());
}

#[test]
fn points_about_an_axis_have_no_momentum_across_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = LogWriter::create(folder.path(), 0, None, &setup()).unwrap();
    let mut rings = frame(0);
    rings.mass = vec![1e-9; rings.id.len()];
    let names = ["x", "y", "z"].map(|axis| format!("momentum_{axis}_kg_m_s"));
    rings.scalars = names.iter().map(|name| (name.clone(), 3.0)).collect();
    writer.frame(rings).unwrap();
    let log = writer.path().to_path_buf();
    writer.finish().unwrap();
    for (revolve, momentum) in [(None, "3.0,3.0,3.0"), (Some(64), "0.0,0.0,3.0")] {
        let selection = Selection {
            revolve,
            ..Selection::default()
        };
        let (reel, out) = (Reel::finished(&log), folder.path().join("out"));
        fs::create_dir_all(&out).unwrap();
        let export = coronet::record::export::export_log;
        let exported = export(&reel, &out, Format::Csv, &selection).unwrap();
        let index = fs::read_to_string(&exported.files[0]).unwrap();
        assert!(index.trim_end().ends_with(momentum), "{index}");
    }
}

#[test]
fn a_log_that_is_cut_off_names_the_command_that_saves_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let bytes = fs::read(&log).unwrap();
    fs::write(&log, &bytes[..bytes.len() - 100]).unwrap();
    let error = export_log(&log, folder.path(), Format::Csv).unwrap_err();
    let remedy = format!("`coronet recover {}`", log.display());
    assert!(error.to_string().contains(&remedy), "{error}");
}
