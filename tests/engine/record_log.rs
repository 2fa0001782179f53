//! The log: frames come back, segments merge to what an undisturbed run writes, cuts are survived.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use coronet::particle::Frame;
use coronet::record::log::{
    LogBody, LogError, LogSetup, LogWriter, Segment, content_digest, info, merge, read_frames,
    recover, segments,
};
use coronet::scene::{Colouring, Dimension};
use foxglove::messages::PointCloud;
use prost::Message as _;

const INTERVAL: f64 = 1.0 / 3.0 * 1e-3;

pub fn setup() -> LogSetup {
    let body = |name: &str, colour| LogBody {
        name: name.into(),
        colour,
    };
    LogSetup {
        bodies: vec![
            body("drop", [200, 30, 40]),
            body("pool", [40, 90, 200]),
            body("gone", [0, 0, 0]),
        ],
        wall: [vec![0.0, 1e-3], vec![0.0, 0.0], vec![-1e-3, -1e-3]],
        spacing: 0.25e-3,
        dimension: Dimension::Three,
        time_scale: 2.0,
        contact: Some(INTERVAL),
        colour: Colouring::Body,
        speed_scale: 3.0,
        pressure_scale: 1000.0,
        scene_text: "[liquid]\n# ψ\n".into(),
        provenance: vec![("key".into(), "sha256:00".into())],
    }
}

/// Frame number `k`: ids that alternate between two bodies, one particle less each time.
pub fn frame(k: usize) -> Frame {
    let count = 60 - k;
    let reals = |seed: f32| -> Vec<f32> {
        let noise = |i: usize| ((i * 7919 + k * 104_729) % 1009) as f32;
        (0..count).map(|i| seed * noise(i) / 1009.0).collect()
    };
    Frame {
        time: k as f64 * INTERVAL,
        id: (0..count as u32).map(|i| 3 * i).collect(),
        body: (0..count).map(|i| (i % 2) as u8).collect(),
        position: [reals(1e-3), reals(2e-3), reals(3e-3)],
        velocity: [reals(1.0), reals(-2.0), reals(3.0)],
        pressure: reals(500.0),
        density: reals(998.0),
        surface: (0..count).map(|i| u8::from(i % 5 == 0)).collect(),
        mass: Vec::new(),
        scalars: vec![
            ("kinetic_energy_J".into(), 1.0 / (k as f64 + 3.0)),
            ("mass_kg".into(), 0.0),
        ],
    }
}

/// Writes frames `range` as a segment, a durable place after each frame of `flushes`.
fn write_segment(
    folder: &Path,
    number: u32,
    resumed_from: Option<f64>,
    range: std::ops::Range<usize>,
    flushes: &[usize],
) -> PathBuf {
    let mut writer = LogWriter::create(folder, number, resumed_from, &setup()).unwrap();
    for k in range {
        writer.frame(frame(k)).unwrap();
        if flushes.contains(&k) {
            writer.flush(frame(k).time).unwrap().wait().unwrap();
        }
    }
    let path = writer.path().to_path_buf();
    writer.finish().unwrap();
    path
}

fn read(path: &Path) -> Vec<Frame> {
    read_frames(path)
        .unwrap()
        .collect::<Result<_, _>>()
        .unwrap()
}

/// Cuts the file off after `length` bytes.
fn cut(path: &Path, length: u64) {
    let file = fs::OpenOptions::new().write(true).open(path).unwrap();
    file.set_len(length).unwrap();
}

/// Opcode and end of every record of an MCAP file, by its specification.
fn records(bytes: &[u8]) -> Vec<(u8, usize)> {
    let mut records = Vec::new();
    let mut at = 8;
    while at + 9 <= bytes.len() - 8 {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        let opcode = bytes[at];
        at += 9 + length as usize;
        records.push((opcode, at));
    }
    records
}

#[test]
fn frames_come_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_segment(folder.path(), 0, None, 0..10, &[3]);
    let frames: Vec<_> = (0..10).map(frame).collect();
    assert_eq!(read(&path), frames);
    let told = info(&path).unwrap();
    let setup = setup();
    assert_eq!(told.bodies, setup.bodies);
    assert_eq!(told.scene_text, setup.scene_text);
    assert_eq!((told.spacing, told.time_scale), (0.25e-3, 2.0));
    assert_eq!(told.contact, Some(frame(1).time));
    assert_eq!(told.dimension, Dimension::Three);
    assert_eq!(told.provenance, setup.provenance.into_iter().collect());
}

#[test]
fn masses_of_rings_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut frame = frame(0);
    frame.mass = frame
        .id
        .iter()
        .map(|id| 1e-9 * (*id as f32 + 1.0))
        .collect();
    let mut writer = LogWriter::create(folder.path(), 0, None, &setup()).unwrap();
    writer.frame(frame.clone()).unwrap();
    let path = writer.path().to_path_buf();
    writer.finish().unwrap();
    assert_eq!(read(&path), [frame]);
}

#[test]
fn messages_have_the_topics_times_and_colours_that_viewers_expect() {
    let folder = tempfile::tempdir().unwrap();
    for (colour, expected) in [
        (Colouring::Body, [200, 30, 40, 255]),
        (Colouring::Speed, [253, 231, 37, 255]),
        (Colouring::Pressure, [33, 144, 141, 255]),
    ] {
        let mut one = frame(2);
        one.velocity[2][0] = 10.0;
        one.pressure[0] = 500.0;
        let setup = LogSetup { colour, ..setup() };
        let folder = folder.path().join(format!("{colour:?}"));
        fs::create_dir(&folder).unwrap();
        let mut writer = LogWriter::create(&folder, 0, None, &setup).unwrap();
        let path = writer.path().to_path_buf();
        writer.frame(one.clone()).unwrap();
        assert_eq!(writer.finish().unwrap(), 1);

        let bytes = fs::read(&path).unwrap();
        let messages: Vec<_> = mcap::MessageStream::new(&bytes)
            .unwrap()
            .map(Result::unwrap)
            .collect();
        let topics: Vec<_> = messages.iter().map(|m| m.channel.topic.as_str()).collect();
        let frame_topics = ["/body/drop", "/body/pool", "/body/gone", "/measures"];
        assert_eq!(topics, [&["/tf", "/wall"][..], &frame_topics].concat());
        let nanoseconds = (2.0 * one.time * 1e9).round() as u64;
        assert!(messages[2..].iter().all(|m| m.log_time == nanoseconds));
        let cloud = PointCloud::decode(&*messages[2].data).unwrap();
        assert_eq!(cloud.frame_id, "box");
        let names: Vec<_> = cloud.fields.iter().map(|f| f.name.as_str()).collect();
        let expected_names = [
            "x", "y", "z", "vx", "vy", "vz", "speed", "pressure", "density", "id", "red", "green",
            "blue", "alpha", "surface",
        ];
        assert_eq!(names, expected_names);
        let red = cloud.fields[10].offset as usize;
        assert_eq!(cloud.data[red..red + 4], expected, "{colour:?}");
        let stride = cloud.point_stride as usize;
        assert_eq!(cloud.data.len(), stride * 29, "58 particles in two bodies");
    }
}

#[test]
fn interrupted_runs_merge_to_the_log_of_an_undisturbed_one() {
    let folder = tempfile::tempdir().unwrap();
    let calm = folder.path().join("calm");
    let rough = folder.path().join("rough");
    fs::create_dir(&calm).unwrap();
    fs::create_dir(&rough).unwrap();
    write_segment(&calm, 0, None, 0..20, &[]);

    // Durable to frame 4, killed while writing; goes on from 4 to 9 (checkpoints 6, 8), killed; the
    // checkpoint at 8 turns out damaged, so goes on from 6; killed before anything was written;
    // then to the end.
    let time = |k: usize| frame(k).time;
    let first = write_segment(&rough, 0, None, 0..8, &[2, 4]);
    let bytes = fs::read(&first).unwrap();
    let durable: Vec<_> = records(&bytes)
        .iter()
        .filter(|r| r.0 == 0x0c)
        .map(|r| r.1)
        .collect();
    // Metadata: segment, three of the setup, then one a durable place.
    assert_eq!(durable.len(), 6);
    cut(&first, durable[5] as u64 + 3);
    write_segment(&rough, 1, Some(time(4)), 5..10, &[6, 8]);
    let empty = write_segment(&rough, 2, Some(time(6)), 7..9, &[]);
    cut(&empty, 20);
    write_segment(&rough, 3, Some(time(6)), 7..20, &[12]);

    let listed = segments(&rough).unwrap();
    let starts: Vec<_> = listed.iter().map(|segment| segment.resumed_from).collect();
    assert_eq!(starts, [None, Some(time(4)), Some(time(6))]);
    let merged = merge(&listed, &rough.join("log.mcap")).unwrap();
    let undisturbed = merge(&segments(&calm).unwrap(), &calm.join("log.mcap")).unwrap();
    assert_eq!(merged, undisturbed);
    assert_eq!((merged.frames, merged.last_time), (20, time(19)));
    assert_eq!(
        content_digest(&rough.join("log.mcap")).unwrap(),
        merged.digest
    );
    let same =
        fs::read(rough.join("log.mcap")).unwrap() == fs::read(calm.join("log.mcap")).unwrap();
    assert!(same, "the files differ");
    assert_eq!(
        read(&calm.join("log.mcap")),
        (0..20).map(frame).collect::<Vec<_>>()
    );
    assert_eq!(info(&calm.join("log.mcap")).unwrap().bodies.len(), 3);

    // Extending: the finished log is a segment of the longer run.
    let longer = [
        Segment {
            path: calm.join("log.mcap"),
            resumed_from: None,
        },
        Segment {
            path: write_segment(&calm, 1, Some(time(19)), 20..25, &[]),
            resumed_from: Some(time(19)),
        },
    ];
    let extended = merge(&longer, &calm.join("longer.mcap")).unwrap();
    fs::create_dir(folder.path().join("long")).unwrap();
    let long = write_segment(&folder.path().join("long"), 0, None, 0..25, &[]);
    assert_eq!(content_digest(&long).unwrap(), extended.digest);
}

#[test]
fn a_run_killed_before_its_first_checkpoint_starts_afresh() {
    let folder = tempfile::tempdir().unwrap();
    let calm = write_segment(folder.path(), 0, None, 0..5, &[]);
    let expected = content_digest(&calm).unwrap();
    let bytes = fs::read(&calm).unwrap();
    let ends = records(&bytes)
        .into_iter()
        .map(|r| r.1)
        .filter(|end| *end < bytes.len() / 2);
    write_segment(folder.path(), 1, None, 0..5, &[]);
    let out = folder.path().join("log.mcap");
    for end in ends {
        fs::write(&calm, &bytes[..end]).unwrap();
        let merged = merge(&segments(folder.path()).unwrap(), &out).unwrap();
        assert_eq!(merged.digest, expected, "killed after {end} bytes");
    }
}

#[test]
fn a_merge_that_would_lose_frames_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let out = folder.join("log.mcap");
    let first = write_segment(folder, 0, None, 0..8, &[2, 4]);
    write_segment(folder, 1, Some(frame(4).time), 5..10, &[]);
    let good = fs::read(&first).unwrap();
    let marks: Vec<_> = records(&good)
        .iter()
        .filter(|r| r.0 == 0x0c)
        .map(|r| r.1)
        .collect();
    let all = segments(folder).unwrap();
    merge(&all, &out).unwrap();
    let digest = content_digest(&out).unwrap();

    // Cut before the durable place of frame 4, then one bit flipped in an early chunk.
    cut(&first, marks[5] as u64 - 10);
    let error = merge(&all, &out).unwrap_err();
    assert!(matches!(error, LogError::FramesLost { .. }), "{error}");
    let mut flipped = good.clone();
    let chunks = records(&good).into_iter().filter(|r| r.0 == 0x06);
    // Of the second chunk, the first with frames.
    flipped[chunks.map(|r| r.1).nth(1).unwrap() - 100] ^= 4;
    fs::write(&first, flipped).unwrap();
    let error = merge(&all, &out).unwrap_err();
    assert!(matches!(error, LogError::FramesLost { .. }), "{error}");
    // An unfinished last segment.
    fs::write(&first, &good).unwrap();
    let last = &all[1].path;
    cut(last, fs::metadata(last).unwrap().len() - 30);
    let error = merge(&all, &out).unwrap_err();
    assert!(matches!(error, LogError::FramesLost { .. }), "{error}");
    // The good log of before is still there, and nothing else.
    assert_eq!(content_digest(&out).unwrap(), digest);
    assert_eq!(fs::read_dir(folder).unwrap().count(), 3);
}

#[test]
fn a_log_cut_at_any_byte_is_recovered_to_its_last_whole_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_segment(folder.path(), 0, None, 0..12, &[2, 5, 8]);
    let whole = fs::read(&path).unwrap();
    let frames = read(&path);
    // The first chunk has the transform and the wall, each of the others three frames.
    let chunks: Vec<_> = records(&whole)
        .iter()
        .filter(|r| r.0 == 0x06)
        .map(|r| r.1)
        .collect();
    assert_eq!(chunks.len(), 5);
    let (broken, saved) = (folder.path().join("broken"), folder.path().join("saved"));
    let mut seen = BTreeMap::<usize, usize>::new();
    let places = (0..whole.len()).filter(|at| at % 31 == 0 || at + 40 > whole.len());
    for at in places.chain(chunks.iter().flat_map(|end| [end - 1, *end, end + 1])) {
        fs::write(&broken, &whole[..at]).unwrap();
        let before = chunks.iter().filter(|end| **end <= at).count();
        let expected = 3 * before.saturating_sub(1);
        let recovered = recover(&broken, &saved);
        *seen.entry(expected).or_default() += 1;
        if expected == 0 {
            let error = recovered.unwrap_err();
            assert!(matches!(error, LogError::NoFrames { .. }), "{error}");
            continue;
        }
        let recovered = recovered.unwrap();
        assert_eq!(recovered.frames as usize, expected, "cut at {at}");
        assert!(recovered.damage.is_some(), "cut at {at} goes unseen");
        assert_eq!(read(&saved), frames[..expected], "cut at {at}");
        let strict: Result<Vec<_>, _> = read_frames(&broken).unwrap().collect();
        assert!(
            matches!(strict, Err(LogError::Damaged { .. })),
            "cut at {at}"
        );
    }
    assert_eq!(seen.keys().copied().collect::<Vec<_>>(), [0, 3, 6, 9, 12]);
    let recovered = recover(&path, &saved).unwrap();
    assert_eq!((recovered.frames, recovered.damage), (12, None));
    assert_eq!(
        content_digest(&saved).unwrap(),
        content_digest(&path).unwrap()
    );

    // A chunk that is damaged inside costs its own frames.
    for lost in [2, 4] {
        let mut spoiled = whole.clone();
        spoiled[chunks[lost] - 40] ^= 1;
        fs::write(&broken, spoiled).unwrap();
        let recovered = recover(&broken, &saved).unwrap();
        assert_eq!(recovered.frames, 9);
        assert!(recovered.damage.unwrap().contains("chunk"));
        let gap = 3 * (lost - 1)..3 * lost;
        let kept = (0..12).filter(|i| !gap.contains(i));
        let kept: Vec<_> = kept.map(|i| frames[i].clone()).collect();
        assert_eq!(read(&saved), kept);
    }

    fs::write(&broken, b"PK\x03\x04 foreign").unwrap();
    let error = recover(&broken, &saved).unwrap_err();
    assert!(matches!(error, LogError::NotALog { .. }), "{error}");
}

#[test]
fn damage_inside_a_log_never_gives_a_wrong_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_segment(folder.path(), 0, None, 0..9, &[2, 5]);
    let whole = fs::read(&path).unwrap();
    let frames = read(&path);
    let broken = folder.path().join("broken");
    for at in (8..whole.len()).step_by(11) {
        let mut bad = whole.clone();
        bad[at] ^= 1 << (at % 8);
        fs::write(&broken, bad).unwrap();
        let Ok(read) = read_frames(&broken) else {
            continue;
        };
        let good: Vec<_> = read.map_while(Result::ok).collect();
        // Channel names and metadata stand outside of the frames; the numbers must be right.
        assert!(frames.starts_with(&good), "bit flipped in byte {at}");
    }
}
