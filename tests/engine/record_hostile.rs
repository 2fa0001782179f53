//! Logs made by a stranger: no panic, and no more memory than the file may claim.

use std::fs;

use coronet::particle::Frame;
use coronet::record::log::{LogError, LogWriter, content_digest, info, recover, segments};
use foxglove::messages::{PackedElementField, PointCloud};
use prost::Message as _;

use crate::allocation::peak;
use crate::record_log::{frame, setup};
use crate::record_spoiled::frames;

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

fn map(name: &str, value: &str) -> Vec<u8> {
    let entry = [text(name), text(value)].concat();
    [&(entry.len() as u32).to_le_bytes()[..], &entry].concat()
}

fn record(opcode: u8, parts: &[&[u8]]) -> Vec<u8> {
    let body = parts.concat();
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], &body].concat()
}

/// A chunk that claims to have `size` bytes.
fn chunk(packed: &[u8], size: u64, crc: u32) -> Vec<u8> {
    let times = [0; 16];
    let length = (packed.len() as u64).to_le_bytes();
    let (size, crc) = (size.to_le_bytes(), crc.to_le_bytes());
    record(6, &[&times, &size, &crc, &text("zstd"), &length, packed])
}

/// A chunk of these records, compressed well.
fn honest(records: &[u8]) -> Vec<u8> {
    let packed = zstd::bulk::compress(records, 19).unwrap();
    chunk(&packed, records.len() as u64, crc32fast::hash(records))
}

fn crafted(records: &[Vec<u8>]) -> Vec<u8> {
    let magic: &[u8] = mcap::MAGIC;
    [
        magic,
        &record(1, &[&text(""), &text("")]),
        &records.concat(),
    ]
    .concat()
}

/// Schema and channel 1 on this topic.
fn channel(topic: &str, schema: &str, data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u32).to_le_bytes();
    let id = 1u16.to_le_bytes();
    let schema = record(3, &[&id, &text(schema), &text("protobuf"), &length, data]);
    let parts = [
        &id[..],
        &id,
        &text(topic),
        &text("protobuf"),
        &map("body", "0"),
    ];
    [schema, record(4, &parts)].concat()
}

fn message(data: &[u8]) -> Vec<u8> {
    record(5, &[&1u16.to_le_bytes(), &[0; 20], data])
}

/// Names and records of files of less than 100 kB that claim much more.
fn greedy() -> [(&'static str, Vec<Vec<u8>>); 10] {
    let zeros = |count: usize| vec![0; count];
    let packed = zstd::bulk::compress(&zeros(1 << 28), 19).unwrap();
    let honest_crc = crc32fast::hash(&zeros(1 << 28));
    let huge = u64::MAX.to_le_bytes();
    let cloud = PointCloud {
        fields: vec![PackedElementField::default(); 1 << 20],
        ..PointCloud::default()
    };
    // A file that describes a message of a million empty fields.
    let (inner, outer) = ([0x12, 0].repeat(1 << 20), |tag: u8, inner: &[u8]| {
        let mut bytes = vec![tag];
        prost::encoding::encode_varint(inner.len() as u64, &mut bytes);
        [&bytes, inner].concat()
    });
    let descriptor = outer(0x0a, &outer(0x22, &inner));
    let body = channel("/body/drop", "foxglove.PointCloud", &[]);
    [
        ("a claim", vec![chunk(b"1234", 3 << 30, 1)]),
        ("the largest claim", vec![chunk(b"1234", u64::MAX, 1)]),
        ("a bomb", vec![chunk(&packed, 1 << 28, honest_crc)]),
        (
            "a bomb that claims little",
            vec![chunk(&packed, 100, honest_crc)],
        ),
        ("many bombs", vec![honest(&message(&zeros(1 << 22))); 100]),
        ("clouds without an end", {
            let message = message(&zeros(6 << 20));
            vec![
                honest(&body),
                honest(&message),
                honest(&message),
                honest(&message),
            ]
        }),
        ("a long text", vec![record(12, &[&[0xff; 4], b"name"])]),
        ("a long record", vec![[&[12][..], &huge, b"name"].concat()]),
        (
            "many fields",
            vec![honest(&[body, message(&cloud.encode_to_vec())].concat())],
        ),
        ("a wide schema", {
            let channel = channel("/measures", "coronet.Measures", &descriptor);
            vec![honest(&[channel, message(&[])].concat())]
        }),
    ]
}

#[test]
fn a_small_hostile_log_takes_no_more_memory_than_it_may_claim() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("segment-000.mcap");
    let out = folder.path().join("out.mcap");
    for (name, records) in greedy() {
        let bytes = crafted(&records);
        assert!(bytes.len() < 100_000, "{name}: {} bytes", bytes.len());
        fs::write(&path, &bytes).unwrap();
        let may_claim = (8 << 20) + 256 * bytes.len();
        let held = peak(|| {
            let error = frames(&path).1.expect(name);
            assert!(error.is_damage(), "{name}: {error}");
            assert!(info(&path).is_err() && content_digest(&path).is_err());
            assert!(recover(&path, &out).unwrap_err().is_damage());
            let _ = segments(folder.path());
        });
        assert!(
            held < 4 * may_claim,
            "{name}: {held} bytes, a claim of {may_claim}"
        );
    }
    // The same parts in a file that claims nothing wrong are read.
    let body = channel("/body/drop", "foxglove.PointCloud", &[]);
    let good = crafted(&[honest(&[body, message(&vec![0; 1 << 20])].concat())]);
    fs::write(&path, good).unwrap();
    let error = frames(&path).1.unwrap();
    assert!(matches!(error, LogError::Foreign { .. }), "{error}");
}

/// A lattice at rest before a lattice of walls: nothing that a run writes compresses more.
#[test]
fn what_compresses_best_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let n = 100usize;
    let count = n * n * n;
    let lattice = |f: fn(usize, usize) -> usize| -> Vec<f64> {
        (0..count).map(|i| f(i, n) as f64 * 1e-4).collect()
    };
    let positions = [
        lattice(|i, n| i % n),
        lattice(|i, n| i / n % n),
        lattice(|i, n| i / n / n),
    ];
    let single = |values: &Vec<f64>| values.iter().map(|value| *value as f32).collect();
    let zeros = || vec![0.0; count];
    let rest = Frame {
        id: (0..count as u32).collect(),
        body: vec![0; count],
        position: [0, 1, 2].map(|axis| single(&positions[axis])),
        velocity: [zeros(), zeros(), zeros()],
        pressure: zeros(),
        density: vec![998.0; count],
        surface: vec![0; count],
        ..Frame::default()
    };
    let no_walls = [const { Vec::new() }; 3];
    for (number, (wall, frame)) in [(positions, Frame::default()), (no_walls, rest)]
        .into_iter()
        .enumerate()
    {
        let setup = coronet::record::log::LogSetup { wall, ..setup() };
        let mut writer = LogWriter::create(folder.path(), number as u32, None, &setup).unwrap();
        let path = writer.path().to_path_buf();
        writer.frame(frame.clone()).unwrap();
        writer.finish().unwrap();
        let bytes = if number == 0 { 16 } else { 48 };
        let ratio = bytes * count / fs::metadata(&path).unwrap().len() as usize;
        assert!(ratio < 128, "log {number} compresses by {ratio}");
        assert!(frames(&path).0 == [frame]);
    }
}

#[test]
fn a_segment_that_starts_at_no_time_is_damage() {
    let folder = tempfile::tempdir().unwrap();
    for time in ["NaN", "inf", "soon", ""] {
        let start = [text("segment"), map("resumed_from_s", time)].concat();
        let bytes = crafted(&[record(12, &[&start])]);
        fs::write(folder.path().join("segment-000.mcap"), bytes).unwrap();
        assert!(segments(folder.path()).unwrap_err().is_damage(), "{time}");
    }
}

/// Check sums are right, but the third frame is not what a solver writes.
#[test]
fn a_frame_whose_particles_cannot_be_read_is_not_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = LogWriter::create(folder.path(), 0, None, &setup()).unwrap();
    for k in 56..60 {
        writer.frame(frame(k)).unwrap();
    }
    let path = writer.path().to_path_buf();
    writer.finish().unwrap();
    let whole = fs::read(&path).unwrap();
    let good = frames(&path).0;

    let (foreign, out) = (folder.path().join("foreign"), folder.path().join("out"));
    let mut copy = mcap::Writer::new(fs::File::create(&foreign).unwrap()).unwrap();
    let mut clouds = 0;
    for message in mcap::MessageStream::new(&whole).unwrap() {
        let mut message = message.unwrap();
        if message.channel.topic.starts_with("/body/") {
            clouds += 1;
            if clouds == 2 * setup().bodies.len() + 1 {
                let mut cloud = PointCloud::decode(&message.data[..]).unwrap();
                cloud.point_stride += 1;
                message.data = cloud.encode_to_vec().into();
            }
        }
        copy.write(&message).unwrap();
    }
    copy.finish().unwrap();
    assert!(clouds > 2 * setup().bodies.len());

    let recovered = recover(&foreign, &out).unwrap();
    assert_eq!(recovered.frames, 2);
    assert!(recovered.damage.unwrap().contains("other fields"));
    let (found, error) = frames(&out);
    assert!(found == good[..2] && error.is_none());
}
