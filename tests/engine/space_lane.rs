//! Wide lanes and their scalar twin: the same bits.

use std::process::Command;

use super::cloud::{CHANNEL, Cloud, PERIODIC};
use super::method_scene::{self, fingerprint};
use coronet::scene::Dimension;
use coronet::space::lane::{Half, Lanes, Portable, Real, Record, WIDTH, dot, wide};

/// The words of eight lanes, whatever they are of.
///
/// # Safety
/// `F` is eight f32 or eight f64.
#[inline(always)]
unsafe fn words_of<F: Copy>(x: F) -> [u64; WIDTH] {
    // A NaN is a NaN: its sign and payload mean nothing.
    let word = |x: f64| if x.is_nan() { f64::NAN } else { x }.to_bits();
    if size_of::<F>() == size_of::<[f32; WIDTH]>() {
        // SAFETY: they are eight f32.
        let x: [f32; WIDTH] = unsafe { std::mem::transmute_copy(&x) };
        x.map(|x| word(x as f64))
    } else {
        assert_eq!(size_of::<F>(), size_of::<[f64; WIDTH]>());
        // SAFETY: they are eight f64.
        let x: [f64; WIDTH] = unsafe { std::mem::transmute_copy(&x) };
        x.map(word)
    }
}

/// Appends them.
#[inline(always)]
fn store<F: Real>(x: F, into: &mut Vec<u64>) {
    // SAFETY: so are all numbers.
    into.extend(unsafe { words_of(x) });
}

/// Appends the words of eight coordinates.
#[inline(always)]
fn store_fixed<L: Lanes>(x: L::I, into: &mut Vec<u64>) {
    assert_eq!(size_of::<L::I>(), size_of::<[u32; WIDTH]>());
    // SAFETY: all lanes have them as eight words.
    let x: [u32; WIDTH] = unsafe { std::mem::transmute_copy(&x) };
    into.extend(x.map(u64::from));
}

/// Every operation on eight lanes.
#[inline(always)]
fn operate<L: Lanes>(lanes: L, x: [[f32; WIDTH]; 3], out: &mut Vec<u64>) {
    let words = x[1].map(|x| x.to_bits() as i32);
    // SAFETY: each has eight words.
    let (a, b, c, other) = unsafe {
        (
            lanes.load(x[0].as_ptr()),
            lanes.load(x[1].as_ptr()),
            lanes.load(x[2].as_ptr()),
            lanes.load_fixed(words.as_ptr()),
        )
    };
    store(lanes.splat(x[0][1]), out);
    store(a.splat(x[0][1]), out);
    store(a + b, out);
    store(a - b, out);
    store(a * b, out);
    store(a / b, out);
    store(a + x[1][2], out);
    store(a - x[1][2], out);
    store(a * x[1][2], out);
    store(a.mul_add(b, c), out);
    store(a.sqrt(), out);
    store(a.abs(), out);
    store(a.max(b), out);
    store(a.at_least(x[1][2]), out);
    store(a.min(b), out);
    store(c.if_less(a, b), out);
    // Places as kernels have them, within a table of five columns and four rows and beyond.
    let table = std::array::from_fn::<_, 20, _>(|n| [x[1][n % 8], n as f32, x[2][n % 8], 0.0]);
    let place = |x: f32| x.abs() * 0.7;
    let [column, row] = [x[0], x[2]].map(|x| a.of_array(x.map(place)));
    for x in column.look_up(row, &table, 5) {
        store(x, out);
    }
    store(dot([a, b, c], [c, a, b]), out);
    store(lanes.splat(a.sum()), out);
    out.push(a.less_mask(b) as u64);
    store(lanes.constant(x[0][1] as f64 / 3.0), out);
    out.extend(
        (a / b)
            .to_array()
            .map(|x| (x.to_bits() as u64, x.is_nan()))
            .map(|(bits, nan)| if nan { u64::MAX } else { bits }),
    );
    store(lanes.difference(x[0][0].to_bits() as i32, other), out);
    for count in 0..=WIDTH {
        store(lanes.first(count, a, b), out);
    }
}

/// Loads, and every mask of a compression.
#[inline(always)]
fn move_about<L: Lanes>(lanes: L, records: &[Record], index: &[u32; WIDTH], out: &mut Vec<u64>) {
    let half = |record: &Record| Half(std::array::from_fn(|k| record.0[k]));
    let halves: Vec<Half> = records.iter().map(half).collect();
    let places = index.map(|j| j as u16);
    assert!(index.iter().all(|&j| (j as usize) < records.len()));
    // SAFETY: the indices are those of points.
    let (at, word) = unsafe { lanes.gather_halves(halves.as_ptr(), places.as_ptr()) };
    at.into_iter().for_each(|x| store_fixed::<L>(x, out));
    store(word, out);
    // SAFETY: the indices are those of records.
    let gathered = unsafe {
        let records = records.as_ptr();
        [
            lanes.gather(records, index.as_ptr()),
            lanes.gather(records, places.as_ptr()),
        ]
    };
    for (at, payload) in gathered {
        at.into_iter().for_each(|x| store_fixed::<L>(x, out));
        payload.into_iter().for_each(|x| store(x, out));
    }
    for mask in 0..256 {
        let mut room = [u32::MAX; WIDTH];
        // SAFETY: there are eight words, and there is room for eight.
        let count = unsafe { lanes.compress(mask, index.as_ptr(), room.as_mut_ptr()) };
        out.push(count as u64);
        out.extend(room[..count].iter().map(|&x| x as u64));
    }
}

#[inline(always)]
fn everything<L: Lanes>(lanes: L, out: &mut Vec<u64>) {
    let words = words();
    let n = words.len();
    for shift in [1, 5, 16, 33, 77, 1001] {
        for k in (0..n - WIDTH).step_by(WIDTH) {
            let mut x = [[0.0; WIDTH]; 3];
            for (row, eight) in x.iter_mut().enumerate() {
                for (lane, x) in eight.iter_mut().enumerate() {
                    *x = f32::from_bits(words[(k + lane + row * shift) % n]);
                }
            }
            operate(lanes, x, out);
        }
    }
    let mut records = Vec::new();
    for words in words.chunks_exact(WIDTH) {
        let mut record = Record::default();
        record.0.copy_from_slice(words);
        records.push(record);
    }
    let index = [5, 0, 17, 3, 3, 40, 21, 8];
    move_about(lanes, &records, &index, out);
}

/// Bits of special values, each beside each other, and of numbers of all sizes.
fn words() -> Vec<u32> {
    let special = [
        0.0,
        1.0,
        2.0,
        0.5,
        1.0 + f32::EPSILON,
        16777217.0,
        f32::MIN_POSITIVE,
        1e-45,
        3e-39,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    let mut words = Vec::new();
    for a in special {
        for b in special {
            words.extend([a, -b, -a, b].map(f32::to_bits));
        }
    }
    let mut seed = 1u64;
    for k in 0..4096 {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let bits = (seed >> 32) as u32;
        // Any bits at all, then numbers near one as the pair loops see them.
        let near = f32::from_bits(bits >> 9 | 0x3F80_0000) - 1.5;
        words.push(if k % 2 == 0 { bits } else { near.to_bits() });
    }
    words
}

/// What the processor has, all operations of `lanes`.
#[cfg(target_arch = "x86_64")]
fn everything_wide<L: Lanes>(lanes: L, out: &mut Vec<u64>) {
    #[target_feature(enable = "avx2,fma,popcnt")]
    fn with_features<L: Lanes>(lanes: L, out: &mut Vec<u64>) {
        everything(lanes, out)
    }
    assert!(wide());
    // SAFETY: `wide` has found the features.
    unsafe { with_features(lanes, out) };
}

/// The same.
#[cfg(target_arch = "aarch64")]
fn everything_wide<L: Lanes>(lanes: L, out: &mut Vec<u64>) {
    everything(lanes, out)
}

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[test]
fn every_operation_gives_the_bits_of_its_scalar_twin() {
    use coronet::space::lane::Scalar;

    fn compare<L: Lanes, T: Lanes>(lanes: L, twin: T) {
        let (mut fast, mut plain) = (Vec::new(), Vec::new());
        everything_wide(lanes, &mut fast);
        everything(twin, &mut plain);
        assert!(fast.len() > 500_000, "{}", fast.len());
        assert_eq!(fast.len(), plain.len());
        let differs = fast.iter().zip(&plain).position(|(a, b)| a != b);
        let differs = differs.map(|k| (k, f64::from_bits(fast[k]), f64::from_bits(plain[k])));
        assert_eq!(differs, None, "word, wide, portable");
    }
    if !wide() {
        return;
    }
    #[cfg(target_arch = "x86_64")]
    {
        use coronet::space::lane::{Avx2, Avx2Double};

        // SAFETY: `wide` has found the features.
        let (mixed, single, double) =
            unsafe { (Avx2::<false>::new(), Avx2::<true>::new(), Avx2Double::new()) };
        compare(mixed, Portable::new());
        compare(single, Scalar::<f32, true>::new());
        compare(double, Scalar::<f64, false>::new());
    }
    #[cfg(target_arch = "aarch64")]
    {
        use coronet::space::lane::Neon;

        compare(Neon::<false>::new(), Portable::new());
        compare(Neon::<true>::new(), Scalar::<f32, true>::new());
    }
}

/// What rows, sums and whole steps give, as lines `name bits`.
fn passes() -> Vec<String> {
    let mut lines = Vec::new();
    let cases = [
        (Dimension::Two, [16.0, 0.0, 9.0], CHANNEL),
        (Dimension::Three, [7.0, 6.0, 8.0], CHANNEL),
        (Dimension::Three, [7.0, 8.0, 9.0], PERIODIC),
    ];
    for (dimension, cells, sides) in cases {
        let cloud = Cloud::new(dimension, cells, sides, [1.3, 0.4], |_| true);
        let mut words: Vec<u64> = Vec::new();
        for i in 0..cloud.flow.liquid() {
            words.extend(cloud.flow.rows.row(i).indices().map(|j| j as u64));
        }
        for i in 0..cloud.flow.walls() {
            words.extend(cloud.flow.wall_rows.row(i).indices().map(|j| j as u64));
        }
        lines.push(format!("rows {}", fingerprint(&words)));
    }
    // Paper and corrected: density, two-term viscosity, the normalised tension. Modern: continuity,
    // Morris, surroundings, extrapolation, the raw tension.
    for preset in ["paper", "corrected", "modern"] {
        for dimension in [2, 3] {
            let mut solver = method_scene::splash(preset, dimension);
            solver.advance(&mut |_| ()).unwrap();
            solver.advance(&mut |_| ()).unwrap();
            for (name, words) in method_scene::words(&solver.state()) {
                lines.push(format!(
                    "{preset} {dimension}-D {name} {}",
                    fingerprint(&words)
                ));
            }
        }
    }
    lines
}

/// Runs itself again with the twin. Under `CORONET_LANES=portable` it only prints.
#[test]
fn whole_passes_give_the_bits_of_the_scalar_twin() {
    let mark = "bits of ";
    if std::env::var("CORONET_LANES").is_ok() {
        assert!(!wide());
        passes().iter().for_each(|line| println!("{mark}{line}"));
        return;
    }
    let program = std::env::current_exe().unwrap();
    let name = "space_lane::whole_passes_give_the_bits_of_the_scalar_twin";
    let twin = Command::new(program)
        .args([name, "--exact", "--nocapture", "--test-threads=1"])
        .env("CORONET_LANES", "portable")
        .output()
        .unwrap();
    let text = String::from_utf8(twin.stdout).unwrap();
    assert!(twin.status.success(), "{text}");
    let there: Vec<&str> = text.lines().filter_map(|l| l.split(mark).nth(1)).collect();
    let here = passes();
    assert!(here.len() > 40, "{}", here.len());
    assert_eq!(here, there);
}

#[test]
fn payloads_of_a_record_make_no_subnormal_products() {
    let least = 1e-18f32;
    let faint = [1e-45, -1e-38, 0.99e-18, f32::NAN, least];
    let mut record = Record::new([0; 3], faint);
    let carried = [0, 1, 2, 3, 4].map(|k| record.payload(k));
    assert_eq!(carried[..3], [0.0; 3]);
    assert!(carried[3].is_nan(), "what is no number must stay visible");
    assert_eq!(carried[4], least);
    assert!((carried[4] * carried[4]).is_normal());
    record.carry(faint);
    assert_eq!(record.payload(0), 0.0);
}

/// Positions within, beyond and far beyond the box, in runs of any length.
#[test]
fn many_positions_are_placed_as_one_is() {
    for sides in [PERIODIC, CHANNEL] {
        let cloud = Cloud::new(Dimension::Three, [7.0, 6.0, 8.0], sides, [1.3, 0.4], |_| {
            true
        });
        let grid = &cloud.flow.grid;
        for axis in 0..3 {
            let size = cloud.flow.domain.size[axis];
            for count in [0, 1, 7, 8, 513] {
                let x: Vec<f64> = (0..count)
                    .map(|i| size * (0.37 * i as f64 - 80.0) * (1.0 + 1e-9 * i as f64))
                    .collect();
                let mut all = vec![0; count];
                grid.fix_all(axis, &x, &mut all);
                let single: Vec<i32> = x.iter().map(|x| grid.fix(axis, *x)).collect();
                assert_eq!(all, single);
            }
        }
    }
}
