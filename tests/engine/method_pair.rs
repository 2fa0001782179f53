//! Pair sums against all pairs in f64, with every kernel, in boxes of every kind.

use super::cloud::{CHANNEL, Cloud, OPEN, PERIODIC, dot};
use coronet::effect::viscosity::{Morris, PairViscosity, TwoTerm};
use coronet::kernel::{CubicSpline, Kernel, WendlandC2};
use coronet::method::pass::{
    Continuity, Extrapolation, Force, ForceAndGradient, Moving, Neighbourhood, Summation,
};
use coronet::scene::{Dimension, Precision};
use coronet::space::sweep::{Pass, rows};
use std::marker::PhantomData;

/// Tolerance in units of the sum of magnitudes: f32 terms, about ten roundings each.
const ROUNDING: f64 = 1e-6;

/// The same of each precision: single rounds positions of up to 2^31 units to 2^7, in boxes of
/// some ten spacings; double rounds what comes in and goes out.
const PRECISIONS: [(Precision, f64); 3] = [
    (Precision::Single, 1e-5),
    (Precision::Mixed, ROUNDING),
    (Precision::Double, 2e-7),
];

/// One pair in f64: d in units of h, payloads of own and other.
struct Seen<'a> {
    d: [f64; 3],
    q: f64,
    own: &'a [f32; 5],
    other: &'a [f32; 5],
}

impl Seen<'_> {
    fn own(&self, k: usize) -> f64 {
        self.own[k] as f64
    }
    fn other(&self, k: usize) -> f64 {
        self.other[k] as f64
    }
    fn v(&self) -> [f64; 3] {
        [0, 1, 2].map(|a| self.own(a) - self.other(a))
    }
}

/// Sum and sum of magnitudes over all records.
fn brute<const N: usize>(
    cloud: &Cloud,
    payload: &[[f32; 5]],
    i: usize,
    from: std::ops::Range<usize>,
    term: impl Fn(&Seen) -> [f64; N],
) -> [[f64; N]; 2] {
    let mut sums = [[0.0; N]; 2];
    for j in from.filter(|&j| j != i) {
        let d = cloud.separation(i, j).map(|d| d / cloud.h);
        let q = dot(d, d).sqrt();
        if q >= 2.0 {
            continue;
        }
        let seen = Seen {
            d,
            q,
            own: &payload[i],
            other: &payload[j],
        };
        for (k, x) in term(&seen).into_iter().enumerate() {
            sums[0][k] += x;
            sums[1][k] += x.abs();
        }
    }
    sums
}

/// Random payloads: velocities and pressures of both signs, the last one positive.
fn payloads(cloud: &mut Cloud) -> Vec<[f32; 5]> {
    let count = cloud.records();
    let mut random = || cloud.random.signed() as f32;
    let mut weight = || (1.0 + 0.1 * random()) * if random() < 0.0 { -1.0 } else { 1.0 };
    let weights: Vec<f32> = (0..count).map(|_| weight()).collect();
    let payload = |w: f32| [random(), random(), random(), random(), w];
    weights.into_iter().map(payload).collect()
}

/// 2-D and 3-D, periodic, with walls that count, and alone.
fn clouds() -> Vec<(&'static str, Cloud)> {
    let (two, three) = (Dimension::Two, Dimension::Three);
    let all = |_: [f64; 3]| true;
    vec![
        (
            "periodic",
            Cloud::new(three, [6.5, 7.0, 8.0], PERIODIC, [1.3, 0.4], all),
        ),
        (
            "channel",
            Cloud::new(three, [6.0, 6.0, 7.0], CHANNEL, [1.3, 0.4], all),
        ),
        (
            "plane",
            Cloud::new(two, [14.0, 0.0, 9.0], CHANNEL, [1.6, 0.4], all),
        ),
        ("alone", Cloud::new(three, [6.0; 3], OPEN, [1.3, 0.6], all)),
    ]
}

/// Runs a pass over the liquid rows, with every precision, and compares with `term`, in its order
/// of sums.
fn compare<const N: usize, P: Pass<N>>(
    pass: &P,
    numbers: impl Fn(&P::Out) -> [f64; N],
    scale: f64,
    term: impl Fn(&Seen) -> [f64; N],
) where
    P::Out: Clone + Default,
{
    for (name, mut cloud) in clouds() {
        let payload = payloads(&mut cloud);
        cloud.pack::<P::Payload>(&payload);
        let n = cloud.flow.liquid();
        let sums = |i| brute(&cloud, &payload, i, 0..cloud.records(), &term);
        let sums: Vec<_> = (0..n).map(sums).collect();
        for (precision, rounding) in PRECISIONS {
            let mut out = vec![P::Out::default(); n];
            cloud.flow.grid.precision = precision;
            let lengths = cloud.flow.grid.scale(cloud.h);
            let (records, neighbours) = (&cloud.flow.records, &cloud.flow.rows);
            rows(records, neighbours, lengths, pass, &mut out);
            for (i, (out, [sum, size])) in out.iter().zip(&sums).enumerate() {
                for (k, got) in numbers(out).into_iter().enumerate() {
                    let (sum, size) = (scale * sum[k], scale.abs() * size[k]);
                    let error = (got - sum).abs();
                    assert!(
                        error <= rounding * size,
                        "{name}, {precision:?}: sum {k} of {i} is {got}, not {sum} of {size}"
                    );
                }
            }
        }
    }
}

/// Calls `check` with both kernels.
macro_rules! kernels {
    ($check:ident) => {
        $check::<CubicSpline>();
        $check::<WendlandC2>();
    };
}

#[test]
fn density() {
    fn check<K: Kernel>() {
        let pass = Summation {
            factor: 3.0,
            own: 0.0,
            kernel: PhantomData::<K>,
        };
        compare(&pass, |out| [*out], 3.0, |p| [K::w(p.q)]);
        let whole = Summation { own: 0.5, ..pass };
        let (mut got, mut without) = (0.0, 0.0);
        whole.finish(0, [2.0], &mut got);
        Summation { own: 0.0, ..whole }.finish(0, [2.0], &mut without);
        assert_eq!(got - without, 0.5);
    }
    kernels!(check);
}

#[test]
fn continuity() {
    fn check<K: Kernel>() {
        let (diffusion, drift) = (0.7f32, [0.1f32, -0.2, 0.3]);
        let pass = Continuity {
            factor: 1.5,
            diffusion,
            lag: 1.0,
            held: &[drift],
            kernel: PhantomData::<K>,
        };
        compare(
            &pass,
            |out| [*out as f64],
            1.5,
            |p| {
                let (v, e) = (p.v(), p.own(3) - p.other(3));
                let convection = dot(v, p.d) - dot(drift.map(f64::from), p.d);
                [K::slope(p.q) * (convection + diffusion as f64 * e)]
            },
        );
    }
    kernels!(check);
}

fn force<K: Kernel, V: PairViscosity>(viscosity: V, term: impl Fn(&Seen) -> [f64; 3]) {
    let pass = Force::<K, V, false> {
        factor: 2.0,
        viscosity,
        kernel: PhantomData,
    };
    compare(
        &pass,
        |out| out.map(f64::from),
        2.0,
        |p| {
            let pressure = -K::slope(p.q) * (p.own(3) + p.other(3));
            let viscous = term(p);
            [0, 1, 2].map(|a| pressure * p.d[a] + viscous[a])
        },
    );
}

fn two_term<K: Kernel>(p: &Seen, factor: f64) -> [f64; 3] {
    let f = factor * K::slope(p.q) * (p.own(4) + p.other(4)) / (p.q * p.q + 0.01);
    let (v, along) = (p.v(), dot(p.v(), p.d));
    [0, 1, 2].map(|a| f * (v[a] * p.q * p.q + p.d[a] * along))
}

fn morris<K: Kernel>(p: &Seen, factor: f64) -> [f64; 3] {
    p.v()
        .map(|v| factor * K::slope(p.q) * (p.own(4) + p.other(4)) * v)
}

#[test]
fn pressure_and_viscosity() {
    fn check<K: Kernel>() {
        force::<K, ()>((), |_| [0.0; 3]);
        let factor = 0.4f32;
        force::<K, _>(TwoTerm { factor }, |p| two_term::<K>(p, 0.4f32 as f64));
        force::<K, _>(Morris { factor }, |p| morris::<K>(p, 0.4f32 as f64));
    }
    kernels!(check);
}

/// Where the weight is negative, a negative own pressure counts with its sign turned.
#[test]
fn controlled_tension() {
    fn check<K: Kernel>() {
        let pass = ForceAndGradient(Force::<K, _, true> {
            factor: 2.0,
            viscosity: Morris { factor: 0.4 },
            kernel: PhantomData,
        });
        let numbers = |(force, gradient): &([f32; 3], [f32; 3])| {
            let ([a, b, c], [d, e, f]) = (force.map(f64::from), gradient.map(f64::from));
            // The force alone has the factor.
            [a, b, c, 2.0 * d, 2.0 * e, 2.0 * f]
        };
        compare(&pass, numbers, 2.0, |p| {
            let marked = p.own(4) < 0.0 && p.own(3) < 0.0;
            let own = if marked { -p.own(3) } else { p.own(3) };
            let weight = p.own(4).abs() + p.other(4).abs();
            let viscous = p.v().map(|v| 0.4f32 as f64 * K::slope(p.q) * weight * v);
            let pressure = p.d.map(|d| -K::slope(p.q) * (own + p.other(3)) * d);
            let [d, e, f] = p.d.map(|d| K::slope(p.q) * d);
            let [a, b, c] = [0, 1, 2].map(|a| pressure[a] + viscous[a]);
            [a, b, c, d, e, f]
        });
    }
    kernels!(check);
}

#[test]
fn neighbourhood() {
    fn check<K: Kernel>() {
        let pass = Neighbourhood {
            factor: 1.0,
            viscosity: Morris { factor: 0.4 },
            kernel: PhantomData::<K>,
        };
        let numbers = |out: &coronet::method::pass::Surroundings| {
            let [a, b, c] = out.vector;
            [a, b, c, out.sum, out.stir].map(f64::from)
        };
        compare(&pass, numbers, 1.0, |p| {
            let [a, b, c] = morris::<K>(p, 0.4f32 as f64);
            let stir = p.v().iter().map(|v| v * v).sum::<f64>() * K::w(p.q);
            [a, b, c, K::w(p.q), stir]
        });
    }
    kernels!(check);
}

/// What a wall takes over from the liquid, and from nothing else.
#[test]
fn extrapolation_to_walls() {
    type K = WendlandC2;
    let (_, mut cloud) = clouds().swap_remove(1);
    cloud.flow.wall_sees_wall = false;
    cloud.flow.find();
    let payload = payloads(&mut cloud);
    cloud.pack::<Moving>(&payload);
    let (n, walls) = (cloud.flow.liquid(), cloud.flow.walls());
    let pass = Extrapolation {
        kernel: PhantomData::<K>,
    };
    let mut out = vec![coronet::method::pass::WallSums::default(); walls];
    let scale = cloud.flow.grid.scale(cloud.h);
    rows(
        &cloud.flow.records,
        &cloud.flow.wall_rows,
        scale,
        &pass,
        &mut out,
    );
    let mut wetted = 0;
    for (k, got) in out.iter().enumerate() {
        let [sum, size] = brute(&cloud, &payload, n + k, 0..n, |p| {
            let w = K::w(p.q);
            let pressure = p.other(3) / p.other(4).abs();
            let [lx, ly, lz] = p.d.map(|d| w * d);
            let [x, y, z] = [0, 1, 2].map(|a| w * p.other(a));
            [w, w * pressure, lx, ly, lz, x, y, z]
        });
        let ([lx, ly, lz], [x, y, z]) = (got.lever, got.velocity);
        let got = [got.weight, got.pressure, lx, ly, lz, x, y, z].map(f64::from);
        for c in 0..8 {
            // A single pair far out has an error of w(0).
            let error = (got[c] - sum[c]).abs();
            assert!(error <= ROUNDING * (size[c] + 0.1), "sum {c} of wall {k}");
        }
        wetted += usize::from(sum[0] > 0.0);
    }
    assert!(wetted > 100 && wetted < walls, "{wetted} of {walls}");
}
