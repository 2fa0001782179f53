//! Surface tension: against all pairs in f64, and against what a closed surface must do.

use super::cloud::{CHANNEL, Cloud, OPEN, dot, length};
use super::pack_scene::S0;
use coronet::effect::tension::Tension;
use coronet::kernel::{CubicSpline, Kernel, WendlandC2};
use coronet::method::surface_of;
use coronet::scene::{Dimension, KernelName, TensionForm};
use std::f64::consts::PI;

const SIGMA: f64 = 0.067;
const DENSITY: f64 = 1100.0;
const FORMS: [TensionForm; 2] = [TensionForm::NormalisedColour, TensionForm::RawColour];

/// A round drop of `radius` spacings. H is 1.95 spacings with the normalised colour (1.5 h), 2.6
/// with the raw one (2 h), as in the presets.
fn drop(dimension: Dimension, form: TensionForm, radius: f64, jitter: f64) -> Cloud {
    let size = 2.0 * radius.ceil() + 2.0;
    let width = if dimension == Dimension::Two {
        0.0
    } else {
        size
    };
    let centre = [0.5 * size, 0.5 * width, 0.5 * size];
    let smoothing = if form == TensionForm::RawColour {
        2.6
    } else {
        1.95
    };
    let inside = |x: [f64; 3]| length([0, 1, 2].map(|a| x[a] - centre[a])) < radius;
    Cloud::new(
        dimension,
        [size, width, size],
        OPEN,
        [smoothing, jitter],
        inside,
    )
}

/// The kernel that goes with a form.
fn preset(form: TensionForm) -> KernelName {
    match form {
        TensionForm::RawColour => KernelName::WendlandC2,
        _ => KernelName::CubicSpline,
    }
}

fn tension(cloud: &Cloud, form: TensionForm, kernel: KernelName, strength: f64) -> Tension {
    let d = cloud.flow.dimension.count();
    Tension::new(form, kernel, [cloud.h; 2], SIGMA, strength, d, DENSITY)
}

/// Accelerations, and sigma_eff A.
fn evaluate(
    cloud: &Cloud,
    tension: &mut Tension,
    flag: impl Fn(usize) -> bool + Sync,
) -> (Vec<[f32; 3]>, f64) {
    let sources = cloud.flow.sources();
    let surface = surface_of(&cloud.flow, &sources);
    tension.update(&surface, flag);
    let mut a = vec![[0.0; 3]; cloud.flow.liquid()];
    tension.add(&mut a);
    let centre = cloud.flow.domain.size.map(|size| 0.5 * size);
    let normal = |i: usize| {
        let x = cloud.flow.position(i);
        let lever = [0, 1, 2].map(|k| x[k] - centre[k]);
        (lever.map(|l| l / length(lever)), 1.0)
    };
    (a, tension.virial(&surface, normal))
}

/// SUM over all others within the support: `term(d, q, j)`, d in units of H.
fn all<const N: usize>(
    cloud: &Cloud,
    i: usize,
    term: impl Fn([f64; 3], f64, usize) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for j in (0..cloud.flow.liquid()).filter(|&j| j != i) {
        let d = cloud.separation(i, j).map(|d| d / cloud.h);
        let q = length(d);
        if q < 2.0 {
            let term = term(d, q, j);
            (0..N).for_each(|k| sum[k] += term[k]);
        }
    }
    sum
}

/// u = sqrt(|T|) n / |n| / rho of every particle, by the equations of the effect in f64.
fn roots<K: Kernel>(cloud: &Cloud, form: TensionForm) -> Vec<[f64; 3]> {
    let (n, h) = (cloud.flow.liquid(), cloud.h);
    let (d, mass) = (cloud.flow.dimension.count(), cloud.flow.particles.mass);
    let norm = K::norm(d) / h.powi(d as i32);
    let root = |n: [f64; 3], size: f64, rho: f64| {
        let u = (SIGMA * size).sqrt() / rho / length(n);
        n.map(|n| u * n)
    };
    if form == TensionForm::RawColour {
        let faint = 0.05 / h;
        let gradient = norm / h * mass / DENSITY;
        return (0..n)
            .map(|i| {
                let n = all(cloud, i, |d, q, _| d.map(|d| gradient * K::slope(q) * d));
                let size = (dot(n, n) - faint * faint) * h;
                if size > 0.0 {
                    root(n, size, DENSITY)
                } else {
                    [0.0; 3]
                }
            })
            .collect();
    }
    let volume: Vec<f64> = (0..n)
        .map(|i| 1.0 / (norm * (K::w(0.0) + all(cloud, i, |_, q, _| [K::w(q)])[0])))
        .collect();
    let colour: Vec<f64> = (0..n)
        .map(|i| {
            let [others] = all(cloud, i, |_, q, j| [volume[j] * K::w(q)]);
            norm * (K::w(0.0) * volume[i] + others)
        })
        .collect();
    (0..n)
        .map(|i| {
            let gradient = norm / h * mass / cloud.flow.particles.density[i];
            let n = all(cloud, i, |d, q, j| {
                d.map(|d| gradient * (colour[j] - colour[i]) * K::slope(q) * d)
            });
            if length(n) > 0.01 / h {
                root(n, length(n), mass / volume[i])
            } else {
                [0.0; 3]
            }
        })
        .collect()
}

fn brute<K: Kernel>(cloud: &Cloud, form: TensionForm) -> Vec<[f64; 3]> {
    let d = cloud.flow.dimension.count();
    let factor = cloud.flow.particles.mass * K::norm(d) / cloud.h.powi(d as i32 + 1);
    let u = roots::<K>(cloud, form);
    (0..cloud.flow.liquid())
        .map(|i| {
            all(cloud, i, |d, q, j| {
                let (a, b) = (u[i], u[j]);
                let (ad, bd) = (dot(a, d), dot(b, d));
                let both = dot(a, a) + dot(b, b);
                let stress = [0, 1, 2].map(|c| both * d[c] - b[c] * bd - a[c] * ad);
                stress.map(|s| factor * K::slope(q) * s)
            })
        })
        .collect()
}

#[test]
fn accelerations_are_those_of_all_pairs() {
    for (dimension, radius) in [(Dimension::Two, 9.3), (Dimension::Three, 5.4)] {
        for form in FORMS {
            let cloud = drop(dimension, form, radius, 0.2);
            for kernel in [KernelName::CubicSpline, KernelName::WendlandC2] {
                let wanted = match kernel {
                    KernelName::CubicSpline => brute::<CubicSpline>(&cloud, form),
                    KernelName::WendlandC2 => brute::<WendlandC2>(&cloud, form),
                };
                let mut tension = tension(&cloud, form, kernel, 1.0);
                let (got, _) = evaluate(&cloud, &mut tension, |_| true);
                let largest = wanted.iter().map(|a| length(*a)).fold(0.0, f64::max);
                assert!(largest > 0.1, "{largest}");
                for (i, (got, wanted)) in got.iter().zip(&wanted).enumerate() {
                    let off = length([0, 1, 2].map(|a| got[a] as f64 - wanted[a]));
                    assert!(
                        off < 1e-5 * largest,
                        "{form:?} {kernel:?} {dimension:?}: {got:?} of {i}, not {wanted:?}"
                    );
                }
            }
        }
    }
}

/// Calibrated by the virial of its pairs, the tension pulls inwards as a surface of energy sigma A
/// does: SUM m a . x = -(d-1) sigma A, which Young and Laplace's pressure balances.
#[test]
fn a_calibrated_drop_is_pulled_together_by_sigma_times_area() {
    for (dimension, radius) in [(Dimension::Two, 20.3), (Dimension::Three, 10.2)] {
        for form in FORMS {
            let cloud = drop(dimension, form, radius, 0.0);
            let r = radius * S0;
            let d = dimension.count() as f64;
            let area = if d == 2.0 {
                2.0 * PI * r
            } else {
                4.0 * PI * r * r
            };
            let kernel = preset(form);
            let (_, raw) = evaluate(&cloud, &mut tension(&cloud, form, kernel, 1.0), |_| true);
            let strength = SIGMA * area / raw;
            assert!(
                (5.0..7.5).contains(&strength),
                "{form:?} {dimension:?}: alpha {strength}"
            );
            let mut tension = tension(&cloud, form, kernel, strength);
            let (a, virial) = evaluate(&cloud, &mut tension, |_| true);
            let off = virial / (SIGMA * area) - 1.0;
            assert!(off.abs() < 1e-6, "{form:?} {dimension:?}: {off:e}");
            let centre = cloud.flow.domain.size.map(|size| 0.5 * size);
            let pull: f64 = (0..a.len())
                .map(|i| {
                    let x = cloud.flow.position(i);
                    let lever = [0, 1, 2].map(|k| x[k] - centre[k]);
                    cloud.flow.particles.mass * dot(a[i].map(f64::from), lever)
                })
                .sum();
            let ratio = -pull / ((d - 1.0) * SIGMA * area);
            // The normalised stress lies deeper, where the area is smaller.
            let tolerance = if form == TensionForm::RawColour {
                0.03
            } else {
                0.08
            };
            assert!(
                (ratio - 1.0).abs() < tolerance,
                "{form:?} {dimension:?}: {ratio}"
            );
        }
    }
}

#[test]
fn a_drop_does_not_pull_itself_away() {
    for (dimension, radius) in [(Dimension::Two, 12.3), (Dimension::Three, 6.4)] {
        for form in FORMS {
            let cloud = drop(dimension, form, radius, 0.3);
            let mut tension = tension(&cloud, form, KernelName::WendlandC2, 3.0);
            let (a, _) = evaluate(&cloud, &mut tension, |_| true);
            let (mut sum, mut size) = ([0.0; 3], 0.0);
            for a in a {
                let a = a.map(f64::from);
                (0..3).for_each(|k| sum[k] += a[k]);
                size += length(a);
            }
            assert!(
                size > 0.0 && length(sum) < 1e-7 * size,
                "{form:?}: {sum:?} of {size}"
            );
        }
    }
}

/// Depth of every particle below the surface, in spacings.
fn depth(cloud: &Cloud, radius: f64) -> Vec<f64> {
    let centre = cloud.flow.domain.size.map(|size| 0.5 * size);
    let place = |i: usize| {
        let x = cloud.flow.position(i);
        radius - length([0, 1, 2].map(|a| x[a] - centre[a])) / S0
    };
    (0..cloud.flow.liquid()).map(place).collect()
}

/// Beyond the bands nothing is lost but roundings, for targets are summed in other company, and,
/// of the normalised colour, what disorder does to volumes and colours deep inside.
#[test]
fn looking_only_near_the_surface_changes_nothing() {
    for (dimension, radius) in [(Dimension::Two, 30.3), (Dimension::Three, 15.2)] {
        for form in FORMS {
            let cloud = drop(dimension, form, radius, 0.05);
            let depth = depth(&cloud, radius);
            let kernel = KernelName::WendlandC2;
            let mut near = tension(&cloud, form, kernel, 3.0);
            let (limited, _) = evaluate(&cloud, &mut near, |i| depth[i] < 1.2);
            let (whole, _) = evaluate(&cloud, &mut tension(&cloud, form, kernel, 3.0), |_| true);
            let size = |a: &[f32; 3]| length(a.map(f64::from));
            let most = whole.iter().map(size).fold(0.0, f64::max);
            let apart = |(a, b): (&[f32; 3], &[f32; 3])| size(&[0, 1, 2].map(|k| a[k] - b[k]));
            let error = limited.iter().zip(&whole).map(apart).fold(0.0, f64::max);
            let roundings = match form {
                TensionForm::NormalisedColour => 1e-3,
                _ => 1e-5,
            };
            assert!(
                error <= roundings * most,
                "{form:?} {dimension:?}: {error} of {most}"
            );
            // Again, with what the last update left in the buffers.
            let (again, _) = evaluate(&cloud, &mut near, |i| depth[i] < 1.2);
            assert_eq!(again, limited, "{form:?} {dimension:?}");
        }
    }
}

#[test]
fn normals_without_tension_point_inwards_and_pull_nothing() {
    let radius = 14.3;
    let cloud = drop(Dimension::Two, TensionForm::RawColour, radius, 0.1);
    let depth = depth(&cloud, radius);
    let mut normals = Tension::normals(KernelName::WendlandC2, cloud.h, 2, DENSITY);
    let (a, _) = evaluate(&cloud, &mut normals, |i| depth[i] < 1.2);
    assert!(a.iter().all(|a| *a == [0.0; 3]));
    let centre = cloud.flow.domain.size.map(|size| 0.5 * size);
    for i in (0..a.len()).filter(|&i| depth[i] < 2.0) {
        let (x, n) = (cloud.flow.position(i), normals.root_of(i).map(f64::from));
        let inward = [0, 1, 2].map(|k| centre[k] - x[k]);
        let cosine = dot(n, inward) / (length(n) * length(inward));
        assert!(cosine > 0.97, "{cosine} at a depth of {} s0", depth[i]);
    }
}

#[test]
fn the_inside_of_a_drop_feels_nothing() {
    for (dimension, radius) in [(Dimension::Two, 30.3), (Dimension::Three, 15.2)] {
        for form in FORMS {
            let cloud = drop(dimension, form, radius, 0.05);
            let depth = depth(&cloud, radius);
            let mut tension = tension(&cloud, form, KernelName::WendlandC2, 3.0);
            let (a, _) = evaluate(&cloud, &mut tension, |_| true);
            // In units of H: what the page of the effect says, and a cell's width.
            let deep = if form == TensionForm::RawColour {
                3.6
            } else {
                5.0
            };
            let deep = deep * cloud.h / S0;
            let inside = (0..a.len()).filter(|&i| depth[i] > deep);
            let inside: Vec<usize> = inside.collect();
            assert!(inside.len() > 50, "{}", inside.len());
            for i in inside {
                assert_eq!(
                    a[i], [0.0; 3],
                    "{form:?} {dimension:?} at depth {}",
                    depth[i]
                );
            }
        }
    }
}

#[test]
fn a_wetted_wall_is_no_surface() {
    for form in FORMS {
        for dimension in [Dimension::Two, Dimension::Three] {
            let width = if dimension == Dimension::Two {
                0.0
            } else {
                12.0
            };
            let cloud = Cloud::new(dimension, [12.0, width, 6.0], CHANNEL, [2.6, 0.0], |_| true);
            assert!(cloud.flow.walls() > 0);
            let mut tension = tension(&cloud, form, KernelName::WendlandC2, 3.0);
            let (a, virial) = evaluate(&cloud, &mut tension, |_| true);
            assert!(a.iter().all(|a| *a == [0.0; 3]), "{form:?} {dimension:?}");
            assert_eq!(virial, 0.0);
        }
    }
}
