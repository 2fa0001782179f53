//! Checkpoints: round trips, the frozen format, failing writes.

use std::fs;
use std::ops::Range;
use std::path::Path;
use std::process::Command;

use coronet::particle::{Particles, Shares, State};
use coronet::record::checkpoint::{peek, read};
use coronet::record::{Array, Checkpoint, CheckpointError, Digest};
use proptest::prelude::*;

pub fn example() -> Checkpoint {
    Checkpoint {
        kind: "state".into(),
        time: 0.0125,
        step: 321,
        scalars: vec![("mass".into(), 1.5e-8), ("method/last_step".into(), -0.0)],
        texts: vec![("note".into(), "d = 4.0 mm, ψ".into())],
        arrays: vec![
            ("id".into(), Array::U32((0..1000).collect())),
            ("body".into(), Array::U8(vec![1; 1000])),
            (
                "x".into(),
                Array::F64((0..1000).map(|i| (i as f64).sqrt()).collect()),
            ),
            ("p".into(), Array::F32(vec![f32::MIN_POSITIVE, -1.5])),
            ("n".into(), Array::U64(vec![u64::MAX])),
            ("none".into(), Array::F64(vec![])),
        ],
    }
}

fn state() -> State {
    let reals = |k: f64| vec![k, k + 0.25, k + 0.5];
    State {
        time: 1.25e-3,
        step: 77,
        particles: Particles {
            id: vec![2, 0, 1],
            body: vec![1, 0, 0],
            position: [reals(1.0), reals(2.0), reals(3.0)],
            velocity: [reals(-1.0), reals(-2.0), reals(-3.0)],
            density: reals(998.0),
            mass: 1.5e-8,
            weight: reals(2.0),
        },
        scalars: vec![("mass".into(), 0.5), ("removed".into(), 2.5)],
        arrays: vec![
            ("density".into(), reals(4.0)),
            ("shift_x".into(), reals(5.0)),
        ],
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_checkpoint_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let written = example();
    let digest = written.write(&path, 1).unwrap();
    let back = read(&path).unwrap();
    assert_eq!(back, written);
    // == calls the zeros equal; the sign must survive, too.
    assert!(back.scalar("method/last_step").unwrap().is_sign_negative());
    assert_eq!(back.digest(), digest);
    assert_eq!(written.digest(), digest);
    assert_eq!(names(folder.path()), ["a"]);

    let peeked = peek(&path).unwrap();
    assert_eq!(peeked.digest, digest);
    assert_eq!((peeked.time, peeked.step), (0.0125, 321));
    assert_eq!(peeked.arrays.len(), 6);
    assert_eq!(
        (peeked.arrays[2].name.as_str(), peeked.arrays[2].count),
        ("x", 1000)
    );
    assert_eq!(peeked.file_size, fs::metadata(&path).unwrap().len());
}

#[test]
fn the_digest_names_the_content_not_its_packing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let content = example();
    let digests: Vec<_> = [1, 3, 9]
        .map(|level| content.write(&path, level).unwrap())
        .into();
    assert!(digests.iter().all(|digest| *digest == digests[0]));
    let changes: [fn(&mut Checkpoint); 8] = [
        |c| c.kind.push('s'),
        |c| c.time = c.time.next_up(),
        |c| c.step += 1,
        |c| c.scalars[1].1 = 0.0,
        |c| c.texts[0].1.push(' '),
        |c| c.arrays[3].0 = "q".into(),
        |c| c.arrays.swap(0, 1),
        |c| c.arrays[4].1 = Array::U64(vec![u64::MAX - 1]),
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let mut other = content.clone();
        change(&mut other);
        assert_ne!(other.digest(), digests[0], "change {number} goes unseen");
    }
}

#[test]
fn long_arrays_cross_the_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long");
    for count in [131_071, 131_072, 131_073, 300_000] {
        let content = Checkpoint {
            arrays: vec![
                (
                    "a".into(),
                    Array::F64((0..count).map(|i| 1.0 / f64::from(i)).collect()),
                ),
                ("b".into(), Array::U32((0..count).rev().collect())),
                ("c".into(), Array::U8((0..count).map(|i| i as u8).collect())),
            ],
            ..example()
        };
        content.write(&path, 1).unwrap();
        assert!(read(&path).unwrap() == content, "{count} elements");
    }
}

/// A state cut after so many particles.
struct Cut(State, Vec<usize>);

impl Cut {
    fn part(&self, k: usize) -> State {
        self.0.part(self.1[k]..self.1[k + 1])
    }
}

impl Shares for Cut {
    fn count(&self) -> usize {
        self.0.particles.len()
    }

    fn each(&self, columns: &Range<usize>, take: &mut dyn FnMut(State)) {
        (1..self.1.len() - 1).for_each(|k| take(self.part(k).columns(columns)));
    }
}

#[test]
fn parts_make_the_file_of_the_whole() {
    let count = 300_000;
    let reals = |k: usize| {
        (0..count)
            .map(|i| ((i * k) as f64).sin())
            .collect::<Vec<f64>>()
    };
    let state = State {
        particles: Particles {
            id: (0..count as u32).collect(),
            body: (0..count).map(|i| (i % 3) as u8).collect(),
            position: [1, 2, 3].map(reals),
            velocity: [4, 5, 6].map(reals),
            density: reals(7),
            mass: 1e-9,
            weight: Vec::new(),
        },
        arrays: vec![("held_x".into(), reals(8)), ("held_y".into(), reals(9))],
        ..state()
    };
    let folder = tempfile::tempdir().unwrap();
    let [whole, joined] = ["whole", "joined"].map(|name| folder.path().join(name));
    Checkpoint::from(&state).write(&whole, 1).unwrap();
    // An end of a block of 131072 is inside of a part, between parts, and behind an empty one.
    for cuts in [
        vec![0, 100_000, 250_000, 300_000],
        vec![0, 131_072, 262_144, 262_144, 300_000],
        vec![0, 0, 7, 300_000],
        vec![0, 300_000, 300_000],
    ] {
        let cut = Cut(state.clone(), cuts);
        let own = Checkpoint::from(cut.part(0));
        own.write_with(Some(&cut), &joined, 1).unwrap();
        assert!(
            fs::read(&whole).unwrap() == fs::read(&joined).unwrap(),
            "{:?}",
            cut.1
        );
    }
}

#[test]
fn states_and_particles_convert_and_are_told_apart() {
    let state = state();
    let checkpoint = Checkpoint::from(&state);
    assert_eq!(State::try_from(checkpoint.clone()).unwrap(), state);
    let particles = state.particles.clone();
    let of_particles = Checkpoint::from(&particles);
    assert_eq!(
        Particles::try_from(of_particles.clone()).unwrap(),
        particles
    );

    let kinds = State::try_from(of_particles).unwrap_err();
    assert!(
        matches!(kinds, CheckpointError::WrongContent { .. }),
        "{kinds}"
    );
    for index in 0..checkpoint.arrays.len() {
        let mut missing = checkpoint.clone();
        let name = missing.arrays.remove(index).0;
        let partial = State::try_from(missing);
        assert!(
            partial.is_err() || name.starts_with("method/") || name == "weight",
            "{name} is not missed"
        );
        let mut short = checkpoint.clone();
        short.arrays[index].1 = Array::F64(vec![0.0]);
        let error = State::try_from(short).unwrap_err();
        assert!(
            matches!(error, CheckpointError::WrongContent { .. }),
            "{error}"
        );
    }
}

#[test]
fn the_format_is_frozen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("golden");
    let content = Checkpoint {
        arrays: vec![("a".into(), Array::F64(vec![1.0, -2.0]))],
        scalars: vec![("s".into(), 0.25)],
        texts: vec![("t".into(), "u".into())],
        ..example()
    };
    // Written by format version 1; must be readable for ever.
    let golden = include_bytes!("golden/checkpoint-1.coronet");
    fs::write(&path, golden).unwrap();
    assert_eq!(read(&path).unwrap(), content);
    let digest = "sha256:8082398a84d2c0aac9cb07b652415be27ecd6697ea4c2087aca4dfdd1f13e4a5";
    assert_eq!(content.write(&path, 1).unwrap().to_string(), digest);
    assert_eq!(fs::read(&path).unwrap(), golden);
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    // A folder of that name: the rename at the very end fails.
    fs::create_dir(folder.path().join("a")).unwrap();
    let error = example().write(&folder.path().join("a"), 1).unwrap_err();
    assert!(matches!(&error, CheckpointError::Io(error) if error.action == "rename into place"));
    assert_eq!(names(folder.path()), ["a"]);
    let nowhere = example().write(&folder.path().join("no/such/a"), 1);
    assert!(matches!(nowhere, Err(CheckpointError::Io(_))));
}

/// Runs `a_long_write_meets_its_limit` with a limit on the length of files: a write fails half way.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let digest = example().write(&path, 1).unwrap();
    let output = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 64; exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "record_checkpoint::a_long_write_meets_its_limit"])
        .env("CORONET_TEST_FOLDER", folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("1 passed"),
        "{text}"
    );
    assert_eq!(names(folder.path()), ["a"]);
    assert_eq!(read(&path).unwrap().digest(), digest);
}

/// With a limit when it is the child of `a_full_disk_leaves_the_old_file_and_nothing_else`.
#[test]
fn a_long_write_meets_its_limit() {
    let noise = (0..100_000u64).map(|i| f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
    let long = Checkpoint {
        arrays: vec![("noise".into(), Array::F64(noise.collect()))],
        ..example()
    };
    let Some(folder) = std::env::var_os("CORONET_TEST_FOLDER") else {
        let folder = tempfile::tempdir().unwrap();
        long.write(&folder.path().join("a"), 1).unwrap();
        return;
    };
    let error = long.write(&Path::new(&folder).join("a"), 1).unwrap_err();
    assert!(
        matches!(&error, CheckpointError::Io(error) if error.action == "write"),
        "{error}"
    );
}

#[test]
fn digests_are_written_and_read() {
    let digest = Digest::of(b"abc");
    let text = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(digest.to_string(), text);
    assert_eq!(text.parse(), Ok(digest));
    assert_eq!(serde_json::to_string(&digest).unwrap(), format!("{text:?}"));
    for wrong in [
        "",
        "sha256:",
        &text[7..],
        &text[..70],
        &text.to_uppercase(),
        "sha256:é",
    ] {
        assert!(wrong.parse::<Digest>().is_err(), "{wrong}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_checkpoint_comes_back(
        kind in ".{0,8}",
        bits in prop::collection::vec(any::<u64>(), 0..200),
        small in prop::collection::vec(any::<u8>(), 0..200),
        step in any::<u64>(),
        name in ".{0,20}",
        level in 1..5i32,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p");
        let content = Checkpoint {
            kind,
            time: 0.0,
            step,
            scalars: bits.iter().map(|b| (format!("{b}"), f64::from_bits(*b))).collect(),
            texts: vec![(name.clone(), name.clone())],
            arrays: vec![
                (name.clone(), Array::F64(bits.iter().map(|b| f64::from_bits(*b)).collect())),
                ("u".into(), Array::U64(bits.clone())),
                ("w".into(), Array::U32(bits.iter().map(|b| *b as u32).collect())),
                ("s".into(), Array::F32(bits.iter().map(|b| f32::from_bits(*b as u32)).collect())),
                ("b".into(), Array::U8(small)),
            ],
        };
        let digest = content.write(&path, level).unwrap();
        let back = read(&path).unwrap();
        // NaNs are unequal, so compare by digest, which sees every bit.
        prop_assert_eq!(back.digest(), digest);
        prop_assert_eq!(content.digest(), digest);
        prop_assert_eq!(back.array("u"), content.array("u"));
        prop_assert_eq!(back.scalars.len(), bits.len());
    }
}
