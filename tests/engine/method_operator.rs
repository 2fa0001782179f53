//! WCSPH operators on a lattice against analytic values, in 2-D and 3-D.

use super::cloud::{Cloud, OPEN};
use super::pack_scene::S0;
use coronet::effect::viscosity::{Central, Morris, PairViscosity, TwoTerm};
use coronet::kernel::{CubicSpline, Kernel, WendlandC2};
use coronet::method::pass::Surroundings;
use coronet::method::pass::{
    Compressed, Continuity, Force, ForceAndGradient, Moving, Neighbourhood,
};
use coronet::scene::Dimension;
use coronet::space::sweep::{Payload, rows};
use std::marker::PhantomData;

const DENSITY: f64 = 1100.0;
/// m^2/s.
const NU: f64 = 3e-6;

/// A lattice of spacing h / 2.5, wide enough that its middle sees no edge.
fn lattice(dimension: Dimension) -> Cloud {
    let width = if dimension == Dimension::Two {
        0.0
    } else {
        13.0
    };
    let cloud = Cloud::new(dimension, [13.0, width, 13.0], OPEN, [2.5, 0.0], |_| true);
    assert!(
        (cloud.flow.particles.mass - DENSITY * S0.powi(dimension.count() as i32)).abs() < 1e-15
    );
    cloud
}

/// The particle in the middle and its place, m.
fn middle(cloud: &Cloud) -> (usize, [f64; 3]) {
    let centre = cloud.flow.domain.size.map(|size| 0.5 * size);
    let off = |i: usize| {
        let x = cloud.flow.position(i);
        (0..3).map(|a| (x[a] - centre[a]).powi(2)).sum::<f64>()
    };
    let i = (0..cloud.flow.liquid())
        .min_by(|&i, &j| off(i).total_cmp(&off(j)))
        .unwrap();
    assert!(off(i) < 1e-12 * S0);
    (i, cloud.flow.position(i))
}

/// m norm / h^(d+1).
fn factor<K: Kernel>(cloud: &Cloud) -> f64 {
    let d = cloud.flow.dimension.count();
    cloud.flow.particles.mass * K::norm(d) / cloud.h.powi(d as i32 + 1)
}

/// Writes payloads given by place about the middle, m.
fn fill<P: Payload>(cloud: &mut Cloud, field: impl Fn([f64; 3]) -> [f64; 5]) -> usize {
    let (i, centre) = middle(cloud);
    let payload: Vec<[f32; 5]> = (0..cloud.records())
        .map(|j| {
            let x = cloud.position(j);
            field([0, 1, 2].map(|a| x[a] - centre[a])).map(|x| x as f32)
        })
        .collect();
    cloud.pack::<P>(&payload);
    i
}

/// Acceleration of the middle particle.
fn acceleration<K: Kernel, V: PairViscosity>(
    dimension: Dimension,
    viscosity: V,
    field: impl Fn([f64; 3]) -> [f64; 5],
) -> [f64; 3] {
    let mut cloud = lattice(dimension);
    let i = fill::<Moving>(&mut cloud, field);
    let pass = Force::<K, V, false> {
        factor: factor::<K>(&cloud),
        viscosity,
        kernel: PhantomData,
    };
    let mut out = vec![[0.0; 3]; cloud.flow.liquid()];
    let scale = cloud.flow.grid.scale(cloud.h);
    rows(
        &cloud.flow.records,
        &cloud.flow.rows,
        scale,
        &pass,
        &mut out,
    );
    out[i].map(f64::from)
}

/// Rate of density over rho0, 1/s: of the middle particle, and the largest anywhere.
fn dilation<K: Kernel>(
    dimension: Dimension,
    diffusion: f64,
    drift: [f64; 3],
    field: impl Fn([f64; 3]) -> [f64; 5],
) -> [f64; 2] {
    let mut cloud = lattice(dimension);
    let ahead = |x: [f64; 3]| {
        let mut payload = field(x);
        (0..3).for_each(|a| payload[a] += 0.5 * drift[a]);
        payload
    };
    let i = fill::<Compressed>(&mut cloud, ahead);
    let pass = Continuity {
        factor: factor::<K>(&cloud),
        diffusion: diffusion as f32,
        lag: 1.0,
        held: &[drift.map(|g| g as f32)],
        kernel: PhantomData::<K>,
    };
    let mut out = vec![0.0f32; cloud.flow.liquid()];
    let scale = cloud.flow.grid.scale(cloud.h);
    rows(
        &cloud.flow.records,
        &cloud.flow.rows,
        scale,
        &pass,
        &mut out,
    );
    let largest = out.iter().fold(0.0f32, |most, rate| most.max(rate.abs()));
    [out[i], largest].map(|rate| rate as f64 / DENSITY)
}

/// What the softening eta^2 = 0.01 h^2 leaves of a second derivative.
fn softened<K: Kernel>(d: i32) -> f64 {
    let mut parts = [0.0; 2];
    for k in 0..20000 {
        let q = (k as f64 + 0.5) * 1e-4;
        let whole = K::slope(q) * q.powi(d + 1);
        parts[0] += whole * q * q / (q * q + 0.01);
        parts[1] += whole;
    }
    parts[0] / parts[1]
}

fn close(what: &str, got: f64, wanted: f64, tolerance: f64) {
    let error = (got - wanted).abs();
    assert!(
        error < tolerance * wanted.abs().max(1e-30),
        "{what}: {got}, not {wanted}"
    );
}

const W: f64 = 1.0 / (DENSITY * DENSITY);
const BOTH: [Dimension; 2] = [Dimension::Two, Dimension::Three];

/// v = (z^2, 0, 0) and v = (x^2, 0, 0), each times b, 1/(m s).
const B: f64 = 1e6;

fn viscous<K: Kernel, V: PairViscosity>(dimension: Dimension, viscosity: V) -> [[f64; 3]; 2] {
    let shear = |x: [f64; 3]| [B * x[2] * x[2], 0.0, 0.0, 0.0, W];
    let squeeze = |x: [f64; 3]| [B * x[0] * x[0], 0.0, 0.0, 0.0, W];
    [
        acceleration::<K, V>(dimension, viscosity, shear),
        acceleration::<K, V>(dimension, viscosity, squeeze),
    ]
}

fn viscosity_of<K: Kernel>() {
    for dimension in BOTH {
        let d = dimension.count() as f64;
        let mu = (NU * DENSITY / lattice(dimension).h) as f32;
        let laplacian = 2.0 * B * NU;
        // Morris: nu lap v, whichever way v points.
        let [shear, squeeze] = viscous::<K, _>(dimension, Morris { factor: mu });
        close("Morris, shear", shear[0], laplacian, 0.01);
        close("Morris, squeeze", squeeze[0], laplacian, 0.01);
        assert!(
            shear[1].abs() + shear[2].abs() < 1e-5 * laplacian,
            "{shear:?}"
        );
        // Two terms: (d+3)/(d+2) nu lap v + 2/(d+2) nu grad div v.
        let [shear, squeeze] = viscous::<K, _>(dimension, TwoTerm { factor: mu });
        let left = softened::<K>(d as i32) * laplacian;
        let wanted = [(d + 3.0) / (d + 2.0), (d + 5.0) / (d + 2.0)];
        close("two terms, shear", shear[0], wanted[0] * left, 0.015);
        close("two terms, squeeze", squeeze[0], wanted[1] * left, 0.015);
        let exact = TwoTerm {
            factor: mu * ((d + 2.0) / (d + 3.0)) as f32,
        };
        let [shear, _] = viscous::<K, _>(dimension, exact);
        close("two terms made exact", shear[0], left, 0.015);
        // Along pairs: nu lap v + 2 nu grad div v.
        let central = Central::of::<K>(dimension.count(), mu as f64);
        let [shear, squeeze] = viscous::<K, _>(dimension, central);
        close("central, shear", shear[0], laplacian, 0.03);
        close("central, squeeze", squeeze[0], 3.0 * laplacian, 0.03);
    }
}

#[test]
fn viscosity_tends_to_the_laplacian() {
    viscosity_of::<CubicSpline>();
    viscosity_of::<WendlandC2>();
}

#[test]
fn rigid_motion_has_no_viscosity() {
    let spin = |x: [f64; 3]| [3.0 - 50.0 * x[2], 1.0, 50.0 * x[0], 0.0, W];
    for dimension in BOTH {
        let shear = |x: [f64; 3]| [3.0 - 50.0 * x[2], 1.0, 0.0, 0.0, W];
        for field in [spin, shear] {
            let (m, t) = (Morris { factor: 1e3 }, TwoTerm { factor: 1e3 });
            let rest = |_: [f64; 3]| [50.0 * S0, 0.0, 0.0, 0.0, W];
            // Against what the same differences of velocity would give if they did not cancel.
            let scale: f64 = 1e3 * 50.0 * S0 * W * factor::<WendlandC2>(&lattice(dimension));
            for a in [
                acceleration::<WendlandC2, _>(dimension, m, field),
                acceleration::<WendlandC2, _>(dimension, t, field),
                acceleration::<WendlandC2, _>(dimension, m, rest),
            ] {
                assert!(a.iter().all(|a| a.abs() < 1e-4 * scale), "{a:?} of {scale}");
            }
        }
    }
}

fn pressure_of<K: Kernel>() {
    for dimension in BOTH {
        for axis in (0..3).filter(|&a| a != 1 || dimension == Dimension::Three) {
            let slope = 2.0e5;
            let field = |x: [f64; 3]| [0.0, 0.0, 0.0, (40.0 + slope * x[axis]) * W, W];
            let a = acceleration::<K, ()>(dimension, (), field);
            close("pressure gradient", a[axis], -slope / DENSITY, 0.01);
            let across = (0..3)
                .filter(|&b| b != axis)
                .map(|b| a[b].abs())
                .sum::<f64>();
            assert!(across < 1e-4 * slope / DENSITY, "{a:?}");
        }
    }
}

#[test]
fn pressure_force_of_a_linear_field_is_its_gradient() {
    pressure_of::<CubicSpline>();
    pressure_of::<WendlandC2>();
}

fn divergence_of<K: Kernel>() {
    for dimension in BOTH {
        let y = if dimension == Dimension::Three {
            2.0
        } else {
            0.0
        };
        let grow = move |x: [f64; 3]| [5.0 * x[0], y * x[1], 3.0 * x[2], 0.0, 0.0];
        let [rate, _] = dilation::<K>(dimension, 0.0, [0.0; 3], grow);
        close("divergence", rate, -(8.0 + y), 0.01);
        let turn = |x: [f64; 3]| [5.0 * x[2], 1.0, -5.0 * x[0], 0.0, 0.0];
        assert!(dilation::<K>(dimension, 0.0, [0.0; 3], turn)[0].abs() < 1e-4);
    }
}

#[test]
fn density_follows_the_divergence() {
    divergence_of::<CubicSpline>();
    divergence_of::<WendlandC2>();
}

#[test]
fn density_diffusion_is_a_laplacian_that_spares_a_hydrostatic_column() {
    type K = WendlandC2;
    let (delta, c, g) = (0.1, 12.0, -9.81);
    for dimension in BOTH {
        let h = lattice(dimension).h;
        let bend = |x: [f64; 3]| [0.0, 0.0, 0.0, 1e4 * (x[0] * x[0] - 3.0 * x[2] * x[2]), 0.0];
        let [rate, _] = dilation::<K>(dimension, 2.0 * delta * c, [0.0; 3], bend);
        close("diffusion", rate, delta * h * c * 1e4 * (2.0 - 6.0), 0.01);
        // de/dz = g / c^2.
        let column = |x: [f64; 3]| [0.0, 0.0, 0.0, g * x[2] / (c * c), 0.0];
        let drift = [0.0, 0.0, 2.0 * delta * h / c * g];
        let [_, rest] = dilation::<K>(dimension, 2.0 * delta * c, drift, column);
        // Where neighbours are missing, the slope alone would drive a flux.
        let [_, without] = dilation::<K>(dimension, 2.0 * delta * c, [0.0; 3], column);
        assert!(rest < 1e-4 * without, "{rest} of {without}");
    }
}

#[test]
fn kernel_sum_is_one_inside_and_its_gradient_points_inwards() {
    type K = WendlandC2;
    for dimension in BOTH {
        let mut cloud = lattice(dimension);
        let inside = fill::<Moving>(&mut cloud, |_| [0.0; 5]);
        let pass = Neighbourhood {
            factor: 0.0,
            viscosity: (),
            kernel: PhantomData::<K>,
        };
        let mut around = vec![Surroundings::default(); cloud.flow.liquid()];
        let scale = cloud.flow.grid.scale(cloud.h);
        let (records, listed) = (&cloud.flow.records, &cloud.flow.rows);
        rows(records, listed, scale, &pass, &mut around);
        let pass = ForceAndGradient(Force::<K, (), false> {
            factor: 0.0,
            viscosity: (),
            kernel: PhantomData,
        });
        let mut out = vec![Default::default(); cloud.flow.liquid()];
        rows(records, listed, scale, &pass, &mut out);
        let d = dimension.count();
        let factor = K::norm(d) * (S0 / cloud.h).powi(d as i32);
        let sum = |i: usize| factor * (around[i].sum as f64 + 1.0);
        close("kernel sum", sum(inside), 1.0, 0.01);
        // SUM slope d of grad C: against the outward normal at the lower face, about half the bulk.
        let centre = cloud.flow.position(inside);
        let faces = (0..cloud.flow.liquid()).filter(|&i| {
            let x = cloud.flow.position(i);
            x[0] == centre[0] && x[1] == centre[1] && x[2] < S0
        });
        let face: Vec<usize> = faces.collect();
        assert_eq!(face.len(), 1);
        let low = sum(face[0]);
        assert!(low > 0.5 && low < 0.75, "{low}");
        let gradient: [f32; 3] = out[face[0]].1;
        let [x, y, z] = gradient.map(|g| g as f64 * factor);
        assert!(z > 0.3 && x.abs() + y.abs() < 1e-5, "{x} {y} {z}");
    }
}
