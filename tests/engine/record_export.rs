//! Exports: each file is taken apart by its format's rules, not by our writer.

use std::fs;
use std::path::{Path, PathBuf};

use coronet::particle::{Particles, State};
use coronet::record::Checkpoint;
use coronet::record::export::{ExportError, Exported, Format, LIST, Selection, export_checkpoints};
use coronet::record::layout::Layout;
use coronet::record::log::{LogWriter, Reel};
use serde_json::Value;

use crate::record_log::{frame, setup};

/// Value of an XML attribute in the element text `element`.
fn attribute<'a>(element: &'a str, name: &str) -> &'a str {
    let start = element.find(&format!(" {name}=\"")).expect(name) + name.len() + 3;
    element[start..].split('"').next().unwrap()
}

/// Type, number of components and bytes of the array `name` of a `.vtp` file.
fn vtp_array(bytes: &[u8], name: &str) -> (String, usize, Vec<u8>) {
    let marker = b"<AppendedData encoding=\"raw\">\n_";
    let at = bytes
        .windows(marker.len())
        .position(|w| w == marker)
        .unwrap();
    let header = std::str::from_utf8(&bytes[..at]).unwrap();
    let data = &bytes[at + marker.len()..];
    let element = header
        .split('<')
        .find(|e| e.starts_with("DataArray") && attribute(e, "Name") == name)
        .unwrap_or_else(|| panic!("no array {name}"));
    assert_eq!(attribute(element, "format"), "appended");
    let offset: usize = attribute(element, "offset").parse().unwrap();
    let length = u64::from_le_bytes(data[offset..offset + 8].try_into().unwrap()) as usize;
    let components = element
        .contains("NumberOfComponents")
        .then(|| attribute(element, "NumberOfComponents").parse().unwrap());
    let content = data[offset + 8..offset + 8 + length].to_vec();
    (
        attribute(element, "type").into(),
        components.unwrap_or(1),
        content,
    )
}

pub fn f32s(bytes: &[u8]) -> Vec<f32> {
    let numbers = bytes.chunks_exact(4);
    numbers
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

fn i64s(bytes: &[u8]) -> Vec<i64> {
    let numbers = bytes.chunks_exact(8);
    numbers
        .map(|b| i64::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

pub fn write_log(folder: &Path) -> std::path::PathBuf {
    let mut writer = LogWriter::create(folder, 0, None, &setup()).unwrap();
    let path = writer.path().to_path_buf();
    (0..3).for_each(|k| writer.frame(frame(k)).unwrap());
    writer.finish().unwrap();
    path
}

pub fn export_log(log: &Path, folder: &Path, format: Format) -> Result<Exported, ExportError> {
    coronet::record::export::export_log(&Reel::finished(log), folder, format, &Selection::default())
}

fn export_checkpoint(path: &Path, folder: &Path, format: Format) -> Result<PathBuf, ExportError> {
    let exported = export_checkpoints(&[path.to_path_buf()], folder, format)?;
    Ok(exported.files[0].clone())
}

fn state() -> State {
    let reals = |k: f64| vec![k, k + 0.1];
    State {
        time: 0.5,
        step: 3,
        particles: Particles {
            id: vec![7, 3],
            body: vec![0, 1],
            position: [reals(0.1), reals(0.2), reals(0.3)],
            velocity: [reals(1.0), reals(2.0), reals(3.0)],
            density: vec![998.0, 1e3],
            mass: 1e-8,
            weight: Vec::new(),
        },
        scalars: vec![("removed".into(), 2.5)],
        arrays: vec![
            ("shift_x".into(), reals(8.0)),
            ("shift_y".into(), reals(9.0)),
        ],
    }
}

#[test]
fn a_log_becomes_a_vtk_series() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let files = export_log(&log, folder.path(), Format::Vtk).unwrap().files;
    let names: Vec<_> = files
        .iter()
        .map(|f| f.file_name().unwrap().to_str().unwrap())
        .collect();
    let expected = [
        "frames.pvd",
        "frame-00000.vtp",
        "frame-00001.vtp",
        "frame-00002.vtp",
    ];
    assert_eq!(names, expected);
    let index = fs::read_to_string(&files[0]).unwrap();
    let sets: Vec<_> = index
        .split('<')
        .filter(|e| e.starts_with("DataSet"))
        .collect();
    for (k, set) in sets.iter().enumerate() {
        assert_eq!(attribute(set, "timestep").parse::<f64>(), Ok(frame(k).time));
        assert_eq!(attribute(set, "file"), expected[k + 1]);
    }
    assert_eq!(sets.len(), 3);

    let frame = frame(2);
    let bytes = fs::read(&files[3]).unwrap();
    let (kind, components, points) = vtp_array(&bytes, "position");
    assert_eq!((kind.as_str(), components), ("Float32", 3));
    let [x, y, z] = &frame.position;
    let interleaved: Vec<_> = (0..58).flat_map(|i| [x[i], y[i], z[i]]).collect();
    assert_eq!(f32s(&points), interleaved);
    assert_eq!(f32s(&vtp_array(&bytes, "pressure").2), frame.pressure);
    assert_eq!(vtp_array(&bytes, "surface").2, frame.surface);
    assert_eq!(vtp_array(&bytes, "velocity").1, 3);
    let (kind, _, cells) = vtp_array(&bytes, "connectivity");
    assert_eq!((kind.as_str(), i64s(&cells)), ("Int64", (0..58).collect()));
    assert_eq!(
        i64s(&vtp_array(&bytes, "offsets").2),
        (1..59).collect::<Vec<_>>()
    );
    // The last array ends exactly where the closing tags begin.
    assert!(bytes.ends_with(b"\n  </AppendedData>\n</VTKFile>\n"));
    let end = bytes.len() - b"\n  </AppendedData>\n</VTKFile>\n".len();
    assert_eq!(bytes[end - 8..end], 58i64.to_le_bytes());
}

#[test]
fn a_checkpoint_becomes_csv_and_ply() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.coronet");
    Checkpoint::from(state()).write(&path, 1).unwrap();
    let text = export_checkpoint(&path, folder.path(), Format::Csv).unwrap();
    assert_eq!(text, folder.path().join("state.csv"));
    let lines = fs::read_to_string(&text).unwrap();
    let expected = "position_x,position_y,position_z,id,body,velocity_x,velocity_y,velocity_z,\
         density,method/shift_x,method/shift_y,mass,radius\n\
         0.1,0.2,0.3,7,0,1.0,2.0,3.0,998.0,8.0,9.0,1e-8,";
    assert!(lines.starts_with(expected), "{lines}");
    let cells: Vec<&str> = lines.lines().last().unwrap().split(',').collect();
    assert_eq!(cells[..4], ["0.2", "0.30000000000000004", "0.4", "3"]);
    let radius: f64 = cells[12].parse().unwrap();
    // 4/3 pi r^3 is the volume of 1e-8 kg of 1000 kg/m^3.
    assert!((4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) - 1e-11).abs() < 1e-22);

    let ply = fs::read(export_checkpoint(&path, folder.path(), Format::Ply).unwrap()).unwrap();
    let end = b"end_header\n";
    let at = ply.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let header = std::str::from_utf8(&ply[..at]).unwrap();
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
    assert!(header.contains("\nelement vertex 2\nproperty double x\nproperty double y\n"));
    assert!(header.contains("\nproperty uint id\nproperty uchar body\n"));
    assert!(header.contains("\nproperty double method_shift_x\n"));
    let row = 3 * 8 + 4 + 1 + 3 * 8 + 8 + 2 * 8 + 2 * 8;
    assert_eq!(ply.len() - at, 2 * row);
    assert_eq!(ply[at + row..at + row + 8], 0.2f64.to_le_bytes());
    assert_eq!(ply[at + row + 24..at + row + 28], 3u32.to_le_bytes());

    let other = folder.path().join("calibration.coronet");
    Checkpoint::default().write(&other, 1).unwrap();
    assert!(export_checkpoint(&other, folder.path(), Format::Vtk).is_err());
}

#[test]
fn a_log_becomes_a_csv_series() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let files = export_log(&log, folder.path(), Format::Csv).unwrap().files;
    let index = fs::read_to_string(&files[0]).unwrap();
    let lines: Vec<_> = index.lines().collect();
    assert_eq!(
        lines[0],
        "time_s,time_after_contact_s,file,kinetic_energy_J,mass_kg"
    );
    assert!(
        lines[1].starts_with("0.0,,frame-00000.csv,"),
        "{}",
        lines[1]
    );
    assert_eq!(lines.len(), 4);
    let cells: Vec<_> = lines[3].split(',').collect();
    assert_eq!(cells[0].parse::<f64>(), Ok(frame(2).time));
    assert_eq!(cells[1].parse::<f64>(), Ok(frame(2).time - frame(1).time));
    assert_eq!(
        (cells[2], cells[3].parse::<f64>()),
        ("frame-00002.csv", Ok(0.2))
    );
    let last = fs::read_to_string(&files[3]).unwrap();
    assert_eq!(last.lines().count(), 59);
    let header: Vec<_> = last.lines().next().unwrap().split(',').collect();
    let pressure = header.iter().position(|name| *name == "pressure").unwrap();
    for (line, expected) in last.lines().skip(1).zip(frame(2).pressure) {
        assert_eq!(
            line.split(',').nth(pressure).unwrap().parse::<f32>(),
            Ok(expected)
        );
    }
}

#[test]
fn an_export_leaves_nothing_of_an_earlier_one_and_everything_else() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let kept = [
        "frame-0003.vtp",
        "frame-00003.vtp.bak",
        "frame-000003.vtp",
        "frame-00003.ply",
        "frame-3.vtp",
        "my-frame-00003.vtp",
        "frame-00042.vtp",
        "frames.csv",
        ".frame-00003.vtp",
    ];
    let stale = ["frame-00003.vtp", "frame-00041.vtp", "frame-123456.vtp"];
    let killed = ".frame-00041.vtp.77.0.coronet-tmp";
    for name in kept.into_iter().chain(stale).chain([killed]) {
        fs::write(out.join(name), name).unwrap();
    }
    let list = serde_json::json!({ "coronet": "0.1.0", "files": stale });
    fs::write(out.join(LIST), list.to_string()).unwrap();
    fs::create_dir(out.join("frame-00009.vtp")).unwrap();
    let exported = export_log(&log, &out, Format::Vtk).unwrap();
    assert_eq!(exported.removed, 3);
    for name in kept {
        assert_eq!(fs::read_to_string(out.join(name)).unwrap(), name);
    }
    let mut expected: Vec<_> = exported.files.clone();
    expected.push(out.join(LIST));
    expected.extend(kept.map(|name| out.join(name)));
    expected.push(out.join("frame-00009.vtp"));
    let entries = fs::read_dir(&out).unwrap();
    let mut found: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);

    // A file of the user is in the way of another format: nothing is written or removed.
    let error = export_log(&log, &out, Format::Csv).unwrap_err();
    assert!(
        error.is_usage() && error.to_string().contains("frames.csv"),
        "{error}"
    );
    assert!(exported.files.iter().all(|file| file.exists()));
    fs::rename(out.join("frames.csv"), out.join("my-frames.csv")).unwrap();
    // Another format replaces them; what has not been exported stays. A log that cannot be read
    // costs no file.
    let csv = export_log(&log, &out, Format::Csv).unwrap();
    assert_eq!(csv.removed, 4, "three frames and their index");
    assert!(exported.files.iter().all(|file| !file.exists()));
    assert!(out.join("my-frame-00003.vtp").exists());
    let checkpoint = folder.path().join("state.checkpoint");
    Checkpoint::from(state()).write(&checkpoint, 1).unwrap();
    let file = export_checkpoint(&checkpoint, &out, Format::Ply).unwrap();
    assert!(csv.files.iter().all(|file| !file.exists()));
    fs::write(&log, "no log").unwrap();
    assert!(export_log(&log, &out, Format::Vtk).unwrap_err().is_damage());
    assert!(file.is_file());
    fs::write(&log, "").unwrap();
}

/// A frame number of a folder: the write fails there.
#[test]
fn an_export_that_fails_midway_has_no_index_and_no_temporary_file() {
    let folder = tempfile::tempdir().unwrap();
    let log = write_log(folder.path());
    let out = folder.path().join("out");
    fs::create_dir_all(out.join("frame-00001.vtp")).unwrap();
    let list = r#"{"coronet": "0.1.0", "files": ["frames.pvd", "frame-00001.vtp"]}"#;
    fs::write(out.join(LIST), list).unwrap();
    fs::write(out.join("frames.pvd"), "of an earlier export").unwrap();
    let error = export_log(&log, &out, Format::Vtk).unwrap_err();
    assert!(!error.is_damage(), "{error}");
    let entries = fs::read_dir(&out).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, [LIST, "frame-00000.vtp", "frame-00001.vtp"]);
}

#[test]
fn names_from_a_stranger_stay_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept-1.5.checkpoint");
    let reals = || coronet::record::Array::F64(vec![-1.0]);
    let hostile = [
        "=HYPERLINK(\"x\")",
        "-1+1",
        "a,b",
        "a<b>&\"\u{1b}[2J",
        "x\nproperty float y",
    ];
    let mut checkpoint = Checkpoint {
        scalars: vec![("=now()".into(), -2.0)],
        ..Checkpoint::default()
    };
    for name in ["position_x", "position_y", "position_z"]
        .into_iter()
        .chain(hostile)
    {
        checkpoint.arrays.push((name.into(), reals()));
    }
    checkpoint.write(&path, 1).unwrap();
    let file = export_checkpoint(&path, folder.path(), Format::Csv).unwrap();
    assert_eq!(file, folder.path().join("kept-1.5.csv"));
    let mut reader = csv::Reader::from_path(&file).unwrap();
    let header: Vec<_> = reader
        .headers()
        .unwrap()
        .iter()
        .skip(3)
        .map(String::from)
        .collect();
    assert_eq!(header[..3], ["'=HYPERLINK(\"x\")", "'-1+1", "a,b"]);
    let row = reader.records().next().unwrap().unwrap();
    assert!(row.iter().all(|number| number == "-1.0"), "{row:?}");

    let vtp = fs::read(export_checkpoint(&path, folder.path(), Format::Vtk).unwrap()).unwrap();
    let text = String::from_utf8_lossy(&vtp);
    assert!(
        text.contains("Name=\"a&lt;b&gt;&amp;&quot;_[2J\""),
        "{text}"
    );
    assert!(text.contains("Name=\"x_property float y\""), "{text}");
    let ply = fs::read(export_checkpoint(&path, folder.path(), Format::Ply).unwrap()).unwrap();
    let text = String::from_utf8_lossy(&ply);
    let properties = text.lines().filter(|line| line.starts_with("property "));
    assert_eq!(properties.count(), 3 + hostile.len());
    assert!(
        text.contains("property double x_property_float_y\n"),
        "{text}"
    );
}

#[test]
fn the_layout_shows_every_body_and_plots_every_scalar() {
    let layout = Layout {
        bodies: vec!["drop".into(), "pool".into()],
        size: [0.04, 0.04, 0.02],
        is_axial: false,
        figures: vec!["crater_depth_m".into(), "crown_height_m".into()],
        scalars: ["kinetic_energy_J", "time_step_s", "potential_energy_J"]
            .map(Into::into)
            .into(),
    };
    let json: Value = serde_json::from_str(&layout.json()).unwrap();
    let view = &json["configById"]["3D!coronet"];
    for topic in ["/body/drop", "/body/pool"] {
        assert_eq!(view["topics"][topic]["visible"], true);
        assert_eq!(view["topics"][topic]["colorMode"], "rgba-fields");
    }
    // The stock camera sees nothing nearer than 0.5 m; the box is 0.04 m long.
    assert!(view["cameraState"]["near"].as_f64().unwrap() < 0.001);
    let plots: Vec<Vec<_>> = (0..3)
        .map(|k| {
            let paths = json["configById"][format!("Plot!{k}")]["paths"]
                .as_array()
                .unwrap();
            paths
                .iter()
                .map(|path| path["value"].as_str().unwrap())
                .collect()
        })
        .collect();
    let energies = vec!["/measures.kinetic_energy_J", "/measures.potential_energy_J"];
    let figures = vec!["/figures.crater_depth_m", "/figures.crown_height_m"];
    assert_eq!(plots, [figures, energies, vec!["/measures.time_step_s"]]);
    // Every panel of the tree is configured.
    let tree = json["layout"].to_string();
    for id in json["configById"].as_object().unwrap().keys() {
        assert!(tree.contains(&format!("\"{id}\"")), "{id}");
    }
}
