//! Operators of ISPH against analytic values.

use super::cloud::{Cloud, OPEN, PERIODIC};
use super::pack_scene::S0;
use coronet::kernel::{CubicSpline, Kernel, WendlandC2};
use coronet::method::isph::pass::{Coupled, Look, Pressed, PressureSlope, Weights};
use coronet::method::pass::Moving;
use coronet::method::projection::correction::{inverse, least_eigenvalue, times};
use coronet::method::projection::look::Local;
use coronet::method::projection::surface::{Completion, Share, is_surface};
use coronet::scene::{Dimension, KernelName};
use coronet::space::sparse::{Layout, Sparse};
use coronet::space::sweep;
use std::marker::PhantomData;

const BOTH: [Dimension; 2] = [Dimension::Two, Dimension::Three];
/// h / s0.
const SMOOTHING: f64 = 1.5;

fn cloud(
    dimension: Dimension,
    side: f64,
    sides: [[coronet::scene::Side; 2]; 3],
    jitter: f64,
) -> Cloud {
    let depth = if dimension == Dimension::Two {
        0.0
    } else {
        side
    };
    Cloud::new(
        dimension,
        [side, depth, side],
        sides,
        [SMOOTHING, jitter],
        |_| true,
    )
}

/// V norm / h^(d+k).
fn factor<K: Kernel>(cloud: &Cloud, k: i32) -> f64 {
    let d = cloud.flow.dimension.count() as i32;
    S0.powi(d) * K::norm(d as usize) / cloud.h.powi(d + k)
}

/// SUM w (p_a - p_b) of every liquid particle in physical units: -lap p.
fn laplacian<K: Kernel>(cloud: &Cloud, p: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let flow = &cloud.flow;
    let layout = cloud.layout();
    let (mut sparse, mut degree, mut sums) = (Sparse::default(), Vec::new(), Vec::new());
    sparse.build(
        &layout,
        &Weights::<K, false>(PhantomData),
        &mut degree,
        &mut sums,
    );
    let p: Vec<f64> = (0..flow.liquid()).map(|i| p(flow.position(i))).collect();
    let unit = 2.0 * factor::<K>(cloud, 2);
    (0..p.len())
        .map(|i| unit * (degree[i] * p[i] - sparse.dot(i, &p)))
        .collect()
}

/// What a particle of this volume carries.
fn like(volume: f32) -> Coupled {
    Coupled {
        density: 1.0,
        volume,
        offset: 0.0,
    }
}

/// Particles whose support lies inside the box.
fn inside(cloud: &Cloud) -> Vec<usize> {
    let (reach, size) = (2.0 * cloud.h, cloud.flow.domain.size);
    let within = |i: &usize| {
        let x = cloud.flow.position(*i);
        (0..3).all(|a| size[a] == 0.0 || (x[a] > reach && x[a] < size[a] - reach))
    };
    (0..cloud.flow.liquid()).filter(within).collect()
}

#[test]
fn the_laplacian_of_a_parabola_is_right_on_a_lattice() {
    for dimension in BOTH {
        let mut cloud = cloud(dimension, 10.0, OPEN, 0.0);
        cloud.flow.pack(|_, _| like(1.0), |_, _| Coupled::default());
        let found = laplacian::<WendlandC2>(&cloud, |x| 3.0 * x[0] * x[0] - x[2]);
        for i in inside(&cloud) {
            assert!(
                (found[i] / -6.0 - 1.0).abs() < 0.02,
                "{dimension:?} {}",
                found[i]
            );
        }
        let found = laplacian::<CubicSpline>(&cloud, |x| 3.0 * x[2] * x[2]);
        for i in inside(&cloud) {
            assert!(
                (found[i] / -6.0 - 1.0).abs() < 0.05,
                "{dimension:?} {}",
                found[i]
            );
        }
    }
}

fn look(cloud: &mut Cloud, v: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Local> {
    let payload: Vec<[f32; 5]> = (0..cloud.records())
        .map(|i| {
            let [x, y, z] = v(cloud.position(i)).map(|v| v as f32);
            [x, y, z, 0.0, 0.0]
        })
        .collect();
    cloud.pack::<Moving>(&payload);
    let marks = vec![0.0; cloud.flow.liquid()];
    let pass = Look::<WendlandC2, true> {
        value: factor::<WendlandC2>(cloud, 0),
        gradient: factor::<WendlandC2>(cloud, 1),
        active: [true, cloud.flow.dimension == Dimension::Three, true],
        full: 1.0,
        marks: &marks,
        kernel: PhantomData,
    };
    let mut out = vec![Local::default(); cloud.flow.liquid()];
    let scale = cloud.flow.grid.scale(cloud.h);
    sweep::rows(
        &cloud.flow.records,
        &cloud.flow.rows,
        scale,
        &pass,
        &mut out,
    );
    out
}

/// Even at corners of a disordered block: least eigenvalues there are above what is inverted.
#[test]
fn corrected_divergence_and_gradient_are_exact_for_linear_fields() {
    for dimension in BOTH {
        let mut cloud = cloud(dimension, 10.0, OPEN, 0.2);
        let y = if dimension == Dimension::Two {
            0.0
        } else {
            1.0
        };
        let v = |x: [f64; 3]| {
            let [x, y, z] = [x[0], y * x[1], x[2]].map(|x| x / S0);
            [2.0 * x - z, 3.0 * y + x, 5.0 * z + 0.5 * x]
        };
        let local = look(&mut cloud, v);
        let wanted = (7.0 + 3.0 * y) / S0;
        let good: Vec<usize> = (0..local.len())
            .filter(|i| least_eigenvalue(&local[*i].moment) > 0.3)
            .collect();
        assert!(good.len() as f64 > 0.8 * local.len() as f64);
        for &i in &good {
            let error = local[i].divergence as f64 / wanted - 1.0;
            assert!(error.abs() < 1e-3, "{dimension:?} {error}");
        }
        let slope = [4.0, -2.0 * y, 1.5];
        let p = |x: [f64; 3]| (0..3).map(|a| slope[a] * x[a] / S0).sum::<f64>();
        let payload: Vec<[f32; 5]> = (0..cloud.records())
            .map(|i| [p(cloud.position(i)) as f32, 0.0, 0.0, 0.0, 0.0])
            .collect();
        cloud.pack::<Pressed>(&payload);
        let mut sums = vec![[0.0; 3]; local.len()];
        let pass = PressureSlope::<WendlandC2, false>(PhantomData);
        let scale = cloud.flow.grid.scale(cloud.h);
        sweep::rows(
            &cloud.flow.records,
            &cloud.flow.rows,
            scale,
            &pass,
            &mut sums,
        );
        let unit = factor::<WendlandC2>(&cloud, 1) * S0;
        for i in good {
            let g = times(&local[i].correction, sums[i].map(|s| unit * s as f64));
            for a in 0..3 {
                assert!((g[a] - slope[a]).abs() < 4e-3, "{dimension:?} {g:?}");
            }
        }
    }
}

#[test]
fn tensors_are_inverted_down_to_the_least_eigenvalue() {
    let regular = [2.0, 0.3, -0.2, 1.5, 0.1, 1.0];
    let back = times(&inverse(&regular), times(&regular, [1.0, -2.0, 3.0]));
    for (got, wanted) in back.into_iter().zip([1.0, -2.0, 3.0]) {
        assert!((got - wanted).abs() < 1e-5, "{back:?}");
    }
    assert!((least_eigenvalue(&[3.0, 0.0, 0.0, 1.0, 0.0, 2.0]) - 1.0).abs() < 1e-6);
    // All neighbours along x: y and z count as 0.3.
    let thin = inverse(&[0.5, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(
        (thin[0] - 2.0).abs() < 1e-5 && (thin[3] - 1.0 / 0.3).abs() < 1e-4,
        "{thin:?}"
    );
}

#[test]
fn thin_liquid_is_no_surface_and_its_density_is_seen() {
    for dimension in [2, 3] {
        let closure = Completion::of::<WendlandC2>(KernelName::WendlandC2, dimension, SMOOTHING);
        let full = closure.lattice();
        assert!((1.002..1.006).contains(&full), "{full}");
        assert_eq!(closure.density(0.9 * full, [0.0; 3]), 0.9);
        // Nor is disorder one.
        assert_eq!(closure.density(full, [0.0, 0.03, 0.0]), 1.0);
    }
}

/// Under a flat lattice surface p = depth solves every layer's equation: the plane p = 0 lies half
/// a spacing above the top layer.
#[test]
fn the_completed_closure_is_exact_for_the_depth_below_a_lattice() {
    for dimension in BOTH {
        let depth = if dimension == Dimension::Two {
            0.0
        } else {
            8.0
        };
        let sides = [PERIODIC[0], PERIODIC[1], OPEN[2]];
        let all = |_: [f64; 3]| true;
        let cells = [8.0, depth, 14.0];
        let mut cloud = Cloud::new(dimension, cells, sides, [SMOOTHING, 0.0], all);
        let local = look(&mut cloud, |_| [0.0; 3]);
        let d = dimension.count();
        let closure = Completion::of::<WendlandC2>(KernelName::WendlandC2, d, SMOOTHING);
        let h = cloud.h;
        let inverse: Vec<f32> = local
            .iter()
            .map(|l| {
                let slope = l.slope.map(|s| h * s as f64);
                (1.0 / closure.density(l.kernel_sum as f64, slope)) as f32
            })
            .collect();
        for (l, n) in local.iter().zip(&inverse) {
            assert!(
                (n - 1.0).abs() < 0.06,
                "{dimension:?} C {} 1/n {n}",
                l.kernel_sum
            );
        }
        cloud
            .flow
            .pack(|_, i| like(inverse[i]), |_, _| Coupled::default());
        let flow = &cloud.flow;
        let layout = Layout {
            records: &flow.records,
            liquid: &flow.rows,
            wall: &flow.wall_rows,
            start: &[],
            member: &[],
            unknown: &[],
            columns: flow.rows.len(),
            scale: flow.grid.scale(h),
            images: (usize::MAX, &[]),
        };
        let (mut sparse, mut degree, mut sums) = (Sparse::default(), Vec::new(), Vec::new());
        sparse.build(
            &layout,
            &Weights::<WendlandC2, false>(PhantomData),
            &mut degree,
            &mut sums,
        );
        let top = 14.0 * S0;
        let p: Vec<f64> = (0..local.len())
            .map(|i| (top - flow.position(i)[2]) / S0)
            .collect();
        for i in (0..p.len()).filter(|i| p[*i] < 7.0) {
            let slope = local[i].slope.map(|s| h * s as f64);
            let moment = [2, 3, 4].map(|k| sums[i][k] as f64);
            let s = closure.surface(local[i].kernel_sum as f64, slope, degree[i], moment);
            let left = (degree[i] + s) * p[i] - sparse.dot(i, &p);
            // Over what one layer of neighbours takes.
            let part = left / closure.full();
            assert!(part.abs() < 0.04, "{dimension:?} depth {}: {part}", p[i]);
            assert!(p[i] < 2.0 || s == 0.0, "{dimension:?} depth {}: {s}", p[i]);
        }
    }
}

#[test]
fn shares_are_those_of_a_half_space() {
    for kernel in [KernelName::CubicSpline, KernelName::WendlandC2] {
        for d in [2, 3] {
            let share = Share::of(kernel, d);
            assert_eq!(share.at(0.0), [1.0, 2.0]);
            let [f, z] = share.at(1e9);
            assert!((f - 0.5).abs() < 1e-2 && z < 1e-2, "{f} {z}");
        }
    }
}

/// Marrone et al. on lattices: the outermost layer, corners included, and no other; a film.
#[test]
fn detected_surfaces_are_the_outermost_layer() {
    for dimension in BOTH {
        let side = if dimension == Dimension::Two {
            16.0
        } else {
            12.0
        };
        let mut cloud = cloud(dimension, side, OPEN, 0.0);
        let local = look(&mut cloud, |_| [0.0; 3]);
        let flow = &cloud.flow;
        let scene = (&flow.grid, cloud.h, dimension == Dimension::Two);
        for i in 0..local.len() {
            let found = is_surface(
                &local[i],
                i,
                flow.rows.row(i).indices(),
                &flow.records,
                scene,
            );
            let x = flow.position(i).map(|x| x / S0);
            let edge = |a: &usize| x[*a] < 1.0 || x[*a] > side - 1.0;
            let axes: &[usize] = if dimension == Dimension::Two {
                &[0, 2]
            } else {
                &[0, 1, 2]
            };
            assert_eq!(found, axes.iter().any(edge), "{dimension:?} {x:?}");
        }
        let depth = if dimension == Dimension::Two {
            0.0
        } else {
            8.0
        };
        let flat = |x: [f64; 3]| x[2] < 1.0;
        let cells = [8.0, depth, 8.0];
        let mut film = Cloud::new(dimension, cells, OPEN, [SMOOTHING, 0.0], flat);
        let local = look(&mut film, |_| [0.0; 3]);
        let flow = &film.flow;
        let scene = (&flow.grid, film.h, dimension == Dimension::Two);
        let seen = |i: usize| {
            is_surface(
                &local[i],
                i,
                flow.rows.row(i).indices(),
                &flow.records,
                scene,
            )
        };
        assert!((0..local.len()).all(seen), "{dimension:?}");
    }
}

/// Two particles alone that come together have more weight than a full support, and an equation.
#[test]
fn a_pair_alone_is_never_without_what_it_lacks() {
    for dimension in [2, 3] {
        let closure = Completion::of::<WendlandC2>(KernelName::WendlandC2, dimension, SMOOTHING);
        let alone = WendlandC2::norm(dimension) / SMOOTHING.powi(dimension as i32);
        for q in [1.0, 0.1, 0.03, 0.0] {
            let sum = alone * (WendlandC2::w(0.0) + WendlandC2::w(q));
            let slope = alone * WendlandC2::slope(q) * q;
            // Densities of a half on both sides.
            let degree = 4.0 * -WendlandC2::slope(q);
            let moment = [degree * q, 0.0, 0.0];
            let lack = closure.surface(sum, [slope, 0.0, 0.0], degree, moment);
            assert!(lack > 0.03 * closure.full(), "{dimension}, {q}: {lack}");
        }
    }
}
