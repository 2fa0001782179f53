//! Operators of MPS against analytic values.

use super::cloud::{Cloud, OPEN};
use super::pack_scene::S0;
use coronet::kernel::Kernel;
use coronet::method::mps::pass::{Coupled, Look, Number, PressureSlope, Surface, Viscous, Weights};
use coronet::method::mps::{Lattice, Smooth};
use coronet::method::projection::correction::times;
use coronet::method::projection::look::Local;
use coronet::scene::Dimension;
use coronet::space::sparse::Sparse;
use coronet::space::sweep::{self, Pass, Payload};

const BOTH: [Dimension; 2] = [Dimension::Two, Dimension::Three];
/// r_e / l0, and h / l0 that covers it.
const RADIUS: f64 = 3.1;
const SMOOTHING: f64 = 1.55;
const REACH: f32 = 2.0;

fn cloud(dimension: Dimension, jitter: f64) -> Cloud {
    let depth = if dimension == Dimension::Two {
        0.0
    } else {
        10.0
    };
    let size = [10.0, depth, 10.0];
    Cloud::new(dimension, size, OPEN, [SMOOTHING, jitter], |_| true)
}

/// Particles whose support lies inside the box.
fn inside(cloud: &Cloud) -> Vec<usize> {
    let (reach, size) = (2.0 * cloud.h, cloud.flow.domain.size);
    let within = |i: &usize| {
        let x = cloud.flow.position(*i);
        (0..3).all(|a| size[a] == 0.0 || (x[a] > reach && x[a] < size[a] - reach))
    };
    let found: Vec<usize> = (0..cloud.flow.liquid()).filter(within).collect();
    assert!(!found.is_empty());
    found
}

/// Writes payloads given by place, in spacings.
fn pack<P: Payload>(cloud: &mut Cloud, payload: impl Fn([f64; 3]) -> [f64; 5]) {
    let payload: Vec<[f32; 5]> = (0..cloud.records())
        .map(|i| payload(cloud.position(i).map(|x| x / S0)).map(|x| x as f32))
        .collect();
    cloud.pack::<P>(&payload);
}

fn sums<const N: usize, P: Pass<N>>(
    cloud: &mut Cloud,
    pass: &P,
    payload: impl Fn([f64; 3]) -> [f64; 5],
) -> Vec<P::Out>
where
    P::Out: Default + Clone,
{
    pack::<P::Payload>(cloud, payload);
    let flow = &cloud.flow;
    let mut out = vec![P::Out::default(); flow.liquid()];
    let scale = flow.grid.scale(cloud.h);
    sweep::rows(&flow.records, &flow.rows, scale, pass, &mut out);
    out
}

/// Eqs. 3, 4 and 7 by hand: r_e = 2.1 l0 in the plane reaches the neighbours at 1, sqrt 2 and 2.
#[test]
fn lattice_constants_are_those_of_the_weight() {
    let root = 2f64.sqrt();
    let weights = [2.1 - 1.0, 2.1 / root - 1.0, 2.1 / 2.0 - 1.0];
    let found = Lattice::of(2.1, 2);
    let wanted = 4.0 * (weights[0] + weights[1] + weights[2]);
    assert!((found.number / wanted - 1.0).abs() < 1e-12);
    let wanted = 4.0 * (weights[0] + 2.0 * weights[1] + 4.0 * weights[2]);
    assert!((found.spread / wanted - 1.0).abs() < 1e-12);
}

#[test]
fn number_density_is_n0_inside_a_lattice_and_less_at_its_edge() {
    for dimension in BOTH {
        let mut cloud = cloud(dimension, 0.0);
        let lattice = Lattice::of(RADIUS, dimension.count());
        let pass = Number {
            reach: REACH,
            factor: 1.0 / lattice.number,
        };
        let found = sums(&mut cloud, &pass, |_| [0.0; 5]);
        for i in inside(&cloud) {
            assert!((found[i] - 1.0).abs() < 1e-4, "{dimension:?} {}", found[i]);
        }
        for (i, n) in found.iter().enumerate() {
            if cloud.flow.position(i)[2] < S0 {
                assert!(*n < 0.8, "{dimension:?} {n}");
            }
        }
    }
}

/// Eq. 6 is exact for a parabola on the lattice that gives lambda, as matrix and as viscosity.
#[test]
fn the_laplacian_of_a_parabola_is_exact_on_a_lattice() {
    for dimension in BOTH {
        let mut cloud = cloud(dimension, 0.0);
        let unit = 2.0 * dimension.count() as f64 / Lattice::of(RADIUS, dimension.count()).spread;
        let parabola = |[x, _, z]: [f64; 3]| 3.0 * x * x - 2.0 * z * z + 5.0 * x;
        let pass = Viscous {
            reach: REACH,
            is_central: false,
            factor: unit,
        };
        let found = sums(&mut cloud, &pass, |x| [parabola(x), 0.0, 0.0, 0.0, 0.0]);
        for i in inside(&cloud) {
            assert!((found[i][0] - 2.0).abs() < 5e-3, "{:?}", found[i]);
        }
        let flagged = |x: [f64; 3]| x[0] < 5.0;
        let weights = Weights::<true> { reach: REACH };
        let own = |x: [f64; 3]| [f64::from(u8::from(!flagged(x))), 1.0, 0.0, 0.0, 0.0];
        pack::<Coupled>(&mut cloud, own);
        let flow = &cloud.flow;
        let layout = cloud.layout();
        let (mut sparse, mut degree, mut parts) = (Sparse::default(), Vec::new(), Vec::new());
        sparse.build(&layout, &weights, &mut degree, &mut parts);
        let place = |i: usize| flow.position(i).map(|x| x / S0);
        let p: Vec<f64> = (0..flow.liquid())
            .map(|i| match place(i) {
                x if flagged(x) => 0.0,
                x => parabola(x),
            })
            .collect();
        for i in inside(&cloud) {
            let x = place(i);
            let left = unit * ((degree[i] + parts[i][6] as f64) * p[i] - sparse.dot(i, &p));
            if flagged(x) {
                assert!(sparse.row(i).next().is_none() && parts[i][6] == 0.0);
            } else if x[0] > 5.0 + RADIUS {
                assert!((left + 2.0).abs() < 5e-3, "{left}");
            } else {
                // Neighbours with p = 0 are those of a field that is zero there.
                let zero = |y: [f64; 3]| if flagged(y) { 0.0 } else { parabola(y) };
                let near = (0..flow.liquid()).map(|j| {
                    let y = place(j);
                    let r = (0..3).map(|a| (x[a] - y[a]).powi(2)).sum::<f64>().sqrt();
                    match r {
                        r if r > 0.0 && r < RADIUS => (RADIUS / r - 1.0) * (p[i] - zero(y)),
                        _ => 0.0,
                    }
                });
                let wanted = unit * near.sum::<f64>();
                assert!((left - wanted).abs() < 1e-3 * wanted.abs().max(1.0));
            }
        }
    }
}

/// Corrected: exact for linear fields on disordered particles. Eq. 5: exact on a lattice.
#[test]
fn gradient_and_divergence_are_exact_for_linear_fields() {
    for (dimension, jitter) in [(0, 0.0), (0, 0.2), (1, 0.0), (1, 0.2)].map(|(d, j)| (BOTH[d], j)) {
        let mut cloud = cloud(dimension, jitter);
        let d = dimension.count();
        let y = (d - 2) as f64;
        let lattice = Lattice::of(RADIUS, d);
        let marks = vec![0.0; cloud.flow.liquid()];
        // A lattice does not see that the weight ends to grow at its spacing.
        let core = (1.0 / SMOOTHING) as f32;
        let surface = Surface {
            marks: &marks,
            even: 1.0,
        };
        let look = Look::<true, false> {
            reach: REACH,
            core,
            number: 1.0 / lattice.number,
            value: d as f64 / lattice.number,
            length: SMOOTHING,
            smooth: 1.0,
            active: [true, d == 3, true],
            surface,
        };
        let v = |[x, b, z]: [f64; 3]| {
            let b = y * b;
            [2.0 * x - z, 3.0 * b + x, 5.0 * z + 0.5 * x, 0.0, 0.0]
        };
        let local: Vec<Local> = sums(&mut cloud, &look, v);
        let slope = [4.0, -2.0 * y, 1.5];
        let p = |x: [f64; 3]| (0..3).map(|a| slope[a] * x[a]).sum::<f64>();
        // With the own pressure as the least: (p_j - p_i).
        let pass = PressureSlope::<false, false> {
            reach: REACH,
            core,
            surface,
        };
        let found = sums(&mut cloud, &pass, |x| [p(x), p(x), 0.0, 0.0, 0.0]);
        let unit = -(d as f64) / (lattice.number * SMOOTHING);
        for i in inside(&cloud) {
            let error = local[i].divergence as f64 / (7.0 + 3.0 * y) - 1.0;
            assert!(error.abs() < 1e-3, "{dimension:?} {error}");
            let plain = found[i].map(|s| unit * s as f64);
            let corrected = times(&local[i].correction, plain);
            for a in 0..3 {
                let exact = |g: f64| (g - slope[a]).abs() < 4e-3;
                assert!(exact(corrected[a]), "{dimension:?} {corrected:?}");
                assert!(jitter > 0.0 || exact(plain[a]), "{dimension:?} {plain:?}");
            }
        }
    }
}

/// `blended`, a surface near: (p_j - p_i) W' / q d by hand, times `even`; none near: as ever.
#[test]
fn near_a_surface_a_blended_gradient_is_that_of_the_smooth_kernel() {
    for dimension in BOTH {
        let mut cloud = cloud(dimension, 0.2);
        let n = cloud.flow.liquid();
        let marks: Vec<f32> = (0..n).map(|i| (i % 2) as f32).collect();
        let surface = Surface {
            marks: &marks,
            even: 0.4,
        };
        let core = (0.85 / SMOOTHING) as f32;
        let blended = PressureSlope::<false, true> {
            reach: REACH,
            core,
            surface,
        };
        let plain = PressureSlope::<false, false> {
            reach: REACH,
            core,
            surface,
        };
        let p = |[x, y, z]: [f64; 3]| 1.0 + 0.3 * x - 0.2 * y + 0.1 * z * z;
        let payload = |x| [p(x), p(x), 0.0, 0.0, 0.0];
        let found = sums(&mut cloud, &blended, payload);
        let inside = sums(&mut cloud, &plain, payload);
        for i in 0..n {
            let x = cloud.position(i);
            let mut sum = [0.0; 3];
            for y in (0..n).filter(|j| *j != i).map(|j| cloud.position(j)) {
                let d = [0, 1, 2].map(|a| (x[a] - y[a]) / cloud.h);
                let q = d.iter().map(|d| d * d).sum::<f64>().sqrt();
                let f = -0.4 * Smooth::slope(q) * (p(y.map(|y| y / S0)) - p(x.map(|x| x / S0)));
                (0..3).for_each(|a| sum[a] += f * d[a]);
            }
            let wanted = match marks[i] > 0.0 {
                true => sum,
                false => inside[i].map(f64::from),
            };
            let far = (0..3).map(|a| (found[i][a] as f64 - wanted[a]).abs());
            let far = far.fold(0.0, f64::max);
            assert!(far < 1e-4, "{dimension:?} {i}: {far}");
        }
    }
}
