//! Curvature from counted neighbours: against all pairs in f64, and on circles and spheres.

use super::allocation::counted;
use super::cloud::{Cloud, OPEN, dot, length};
use super::pack_scene::S0;
use coronet::effect::tension::Tension;
use coronet::effect::tension::counted::disordered;
use coronet::effect::wetting::friction::Hold;
use coronet::effect::wetting::typed::Typed;
use coronet::kernel::{Kernel, WendlandC2};
use coronet::method::surface_of;
use coronet::scene::{Dimension, KernelName, Side, TensionForm, Wetting};
use std::f64::consts::PI;

const SIGMA: f64 = 0.067;
const DENSITY: f64 = 1100.0;
const FORMS: [TensionForm; 2] = [TensionForm::NumberDensity, TensionForm::NumberDensityExact];

fn tension(cloud: &Cloud, form: TensionForm) -> Tension {
    let d = cloud.flow.dimension.count();
    let kernel = KernelName::WendlandC2;
    Tension::new(form, kernel, [cloud.h; 2], SIGMA, 1.0, d, DENSITY)
}

/// What makes an acceleration of curvature times normal, m^2/s^2.
const UNIT: f64 = SIGMA / (DENSITY * S0);

/// kappa n of every particle, 1/m.
fn pulls(
    cloud: &Cloud,
    tension: &mut Tension,
    flag: &(dyn Fn(usize) -> bool + Sync),
) -> Vec<[f64; 3]> {
    let sources = cloud.flow.sources();
    let surface = surface_of(&cloud.flow, &sources);
    // Twice: the second time with what the first left in the buffers.
    tension.update(&surface, flag);
    tension.update(&surface, flag);
    let mut a = vec![[0.0; 3]; cloud.flow.liquid()];
    tension.add(&mut a);
    a.into_iter().map(|a| a.map(|a| a as f64 / UNIT)).collect()
}

/// A drop of conformal layers, a spacing apart: rings, or shells of spirals.
fn onion(dimension: Dimension, radius: f64, h: f64) -> Cloud {
    let size = 2.0 * radius + 4.0;
    let middle = 0.5 * size;
    let mut points = Vec::new();
    let mut r = radius - 0.5;
    while r > 0.5 {
        if dimension == Dimension::Two {
            let count = (2.0 * PI * r).round();
            for k in 0..count as usize {
                let angle = 2.0 * PI * (k as f64 + 0.37 * r) / count;
                points.push([middle + r * angle.cos(), 0.0, middle + r * angle.sin()]);
            }
        } else {
            let count = (4.0 * PI * r * r).round();
            for k in 0..count as usize {
                let z = 1.0 - 2.0 * (k as f64 + 0.5) / count;
                let angle = PI * (3.0 - 5f64.sqrt()) * k as f64;
                let across = r * (1.0 - z * z).sqrt();
                let [x, y] = [across * angle.cos(), across * angle.sin()];
                points.push([middle + x, middle + y, middle + r * z]);
            }
        }
        r -= 1.0;
    }
    let still = |at: [f64; 3]| (at, [0.0; 4]);
    let points: Vec<_> = points.into_iter().map(still).collect();
    let width = if dimension == Dimension::Two {
        0.0
    } else {
        size
    };
    Cloud::of(dimension, [size, width, size], OPEN, h, &points)
}

/// Depth below the surface in spacings, and the direction to the centre.
fn place(cloud: &Cloud, radius: f64, i: usize) -> (f64, [f64; 3]) {
    let middle = cloud.flow.domain.size.map(|size| 0.5 * size);
    let x = cloud.flow.position(i);
    let inward = [0, 1, 2].map(|a| middle[a] - x[a]);
    let r = length(inward);
    (radius - r / S0, inward.map(|x| x / r))
}

#[test]
fn circles_and_spheres_have_their_curvature_and_two_thirds_of_it_as_printed() {
    for (dimension, radius) in [
        (Dimension::Two, 12.5),
        (Dimension::Two, 25.5),
        (Dimension::Three, 10.5),
    ] {
        for form in FORMS {
            let cloud = onion(dimension, radius, 3.1);
            let top = |i: usize| place(&cloud, radius, i).0 < 1.0;
            let pulls = pulls(&cloud, &mut tension(&cloud, form), &top);
            let (mut sum, mut count) = (0.0, 0.0);
            for (i, pull) in pulls.iter().enumerate() {
                if top(i) {
                    sum += dot(*pull, place(&cloud, radius, i).1);
                    count += 1.0;
                } else {
                    assert_eq!(*pull, [0.0; 3]);
                }
            }
            let wanted = (dimension.count() as f64 - 1.0) / ((radius - 0.5) * S0);
            let ratio = sum / count / wanted;
            let (right, tolerance) = match (form, dimension) {
                (TensionForm::NumberDensityExact, _) => (1.0, 0.1),
                (_, Dimension::Two) => (2.0 / 3.0, 0.15),
                _ => (0.75, 0.2),
            };
            assert!(
                (ratio - right).abs() < tolerance,
                "{form:?} {dimension:?} {radius}: {ratio}"
            );
        }
    }
}

/// Pairs in f64, as the page of the effect has them.
struct Brute<'a> {
    cloud: &'a Cloud,
    printed: bool,
    /// n1 by particle.
    first: Vec<f64>,
}

impl<'a> Brute<'a> {
    fn new(cloud: &'a Cloud, form: TensionForm) -> Self {
        let mut brute = Brute {
            cloud,
            printed: form == TensionForm::NumberDensity,
            first: Vec::new(),
        };
        let number = |i: usize| brute.others(i).map(|j| brute.w(brute.away(i, j))).sum();
        brute.first = (0..cloud.flow.liquid()).map(number).collect();
        brute
    }

    fn others(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        (0..self.cloud.flow.liquid()).filter(move |j| *j != i)
    }

    /// In H.
    fn away(&self, i: usize, j: usize) -> [f64; 3] {
        self.cloud.separation(i, j).map(|x| x / self.cloud.h)
    }

    fn w(&self, x: [f64; 3]) -> f64 {
        match self.printed {
            true => f64::from(u8::from(length(x) < 2.0)),
            false => WendlandC2::w(length(x).min(2.0)),
        }
    }

    /// What a full support holds, and what a layer through its middle adds.
    fn lattice(&self) -> [f64; 2] {
        let l0 = S0 / self.cloud.h;
        let reach = 2 + (2.0 / l0) as i64;
        let deep = match self.cloud.flow.dimension {
            Dimension::Three => reach,
            Dimension::Two => 0,
        };
        let (mut full, mut layer) = (-self.w([0.0; 3]), 0.0);
        for x in -reach..=reach {
            for y in -deep..=deep {
                let w = |z: i64| self.w([x, y, z].map(|k| l0 * k as f64));
                layer += w(0);
                full += (-reach..=reach).map(w).sum::<f64>();
            }
        }
        [full, layer]
    }

    /// kappa before (5), 1/m; `layer`: of the lattice.
    fn kappa(&self, i: usize, [full, layer]: [f64; 2]) -> f64 {
        let part = |j: usize| {
            let more = self.first[j] - self.first[i];
            let s = match self.printed {
                true => {
                    let x = (0.5 * more).clamp(0.0, 1.0);
                    x * x * (3.0 - 2.0 * x)
                }
                false => (0.5 + more / layer).clamp(0.0, 1.0),
            };
            s * self.w(self.away(i, j))
        };
        let deeper: f64 = self.others(i).map(part).sum();
        let (h, d) = (self.cloud.h, self.cloud.flow.dimension.count());
        let flat = match self.printed {
            true => disordered(2.0 * h / S0, d),
            false => 0.5 * full,
        };
        let middles = (0..4000).map(|c| (c as f64 + 0.5) / 2000.0);
        let moment = |k: i32| -> f64 {
            let term = |q: f64| WendlandC2::w(q) * q.powi(k);
            middles.clone().map(term).sum()
        };
        let lack = 1.0 - deeper / flat;
        match (self.printed, d) {
            (true, 2) => (0.5 * PI * (1.0 - lack)).cos() / h,
            (true, _) => 2.0 * lack / h,
            (false, 2) => PI * moment(1) / moment(2) * lack / h,
            (false, _) => 4.0 * moment(2) / moment(3) * lack / h,
        }
    }

    fn normal(&self, i: usize) -> [f64; 3] {
        let l0 = S0 / self.cloud.h;
        let mut sum = [0.0; 3];
        for x in self.others(i).map(|j| self.away(i, j)) {
            for a in 0..3 {
                let beside = |by: f64| {
                    let mut x = x;
                    x[a] += by;
                    self.w(x)
                };
                sum[a] += match self.printed {
                    true => beside(l0) - beside(-l0),
                    false => WendlandC2::slope(length(x).min(2.0)) * x[a],
                };
            }
        }
        sum.map(|s| s / length(sum))
    }

    /// kappa n of the particles of the surface, 1/m.
    fn pulls(&self, top: &dyn Fn(usize) -> bool) -> Vec<[f64; 3]> {
        let n = self.cloud.flow.liquid();
        let lattice = self.lattice();
        let kappa = |i: usize| if top(i) { self.kappa(i, lattice) } else { 0.0 };
        let kappas: Vec<f64> = (0..n).map(kappa).collect();
        let mean = |i: usize| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for j in self.others(i).filter(|j| top(*j)) {
                let w = (2.0 / length(self.away(i, j)).max(0.15) - 1.0).max(0.0);
                sum += w * kappas[j];
                weight += w;
            }
            0.5 * (kappas[i] + sum / weight)
        };
        let pull = |i: usize| self.normal(i).map(|n| mean(i) * n);
        (0..n)
            .map(|i| if top(i) { pull(i) } else { [0.0; 3] })
            .collect()
    }
}

#[test]
fn pulls_are_those_of_all_pairs() {
    for (dimension, radius, h) in [
        (Dimension::Two, 12.3, 1.55),
        (Dimension::Two, 12.3, 3.1),
        (Dimension::Three, 6.4, 1.55),
    ] {
        for form in FORMS {
            let size = 2.0 * radius + 3.0;
            let width = if dimension == Dimension::Two {
                0.0
            } else {
                size
            };
            let middle = [0.5 * size, 0.5 * width, 0.5 * size];
            let inside = |x: [f64; 3]| length([0, 1, 2].map(|a| x[a] - middle[a])) < radius;
            let cloud = Cloud::new(dimension, [size, width, size], OPEN, [h, 0.2], inside);
            let top = |i: usize| {
                let x = cloud.flow.position(i);
                length([0, 1, 2].map(|a| x[a] / S0 - middle[a])) > radius - 1.0
            };
            let wanted = Brute::new(&cloud, form).pulls(&top);
            let got = pulls(&cloud, &mut tension(&cloud, form), &top);
            let most = wanted.iter().map(|a| length(*a)).fold(0.0, f64::max);
            for (i, (got, wanted)) in got.iter().zip(&wanted).enumerate() {
                let off = length([0, 1, 2].map(|a| got[a] - wanted[a]));
                assert!(
                    off < 1e-4 * most,
                    "{form:?} {dimension:?} {i}: {got:?}, not {wanted:?}"
                );
            }
        }
    }
}

/// The flank of a rectangle at 90 degrees, told to be at 60: (4) of the particle types.
#[test]
fn particles_of_a_contact_line_are_pulled_at_the_angle() {
    let mut sides = OPEN;
    sides[2][0] = Side::Wall;
    let inside = |x: [f64; 3]| (18.0..42.0).contains(&x[0]) && x[2] < 20.0;
    let cloud = Cloud::new(
        Dimension::Two,
        [60.0, 0.0, 60.0],
        sides,
        [1.55, 0.0],
        inside,
    );
    let flank = |i: usize| {
        let x = cloud.flow.position(i)[0] / S0;
        !(19.0..41.0).contains(&x)
    };
    for angle in [60.0, 120.0] {
        let mut tension = tension(&cloud, TensionForm::NumberDensity);
        tension.typed = Some(Typed {
            angle: Wetting::of(angle),
            domain: cloud.flow.domain.clone(),
            lengths: [2.1, 4.1, 4.1].map(|l| l * S0),
            here: Vec::new(),
        });
        let top = |i: usize| flank(i) || cloud.flow.position(i)[2] / S0 > 19.0;
        let pulls = pulls(&cloud, &mut tension, &top);
        let mut line = 0;
        for (i, pull) in pulls.iter().enumerate() {
            let [x, _, z] = cloud.flow.position(i).map(|x| x / S0);
            // A signal particle is beside them, at a height of 2.5 or 3.5.
            if !flank(i) || z > 6.0 {
                continue;
            }
            let n = [
                if x < 30.0 { 1.0 } else { -1.0 } * f64::to_radians(angle).sin(),
                0.0,
                -f64::to_radians(angle).cos(),
            ];
            let (along, size) = (dot(*pull, n), length(*pull));
            assert!(
                (along.abs() - size).abs() < 1e-6 * size,
                "{angle}: {pull:?} at {x} {z}"
            );
            line += 1;
        }
        assert_eq!(line, 12, "six rows on either side");
        let sources = cloud.flow.sources();
        let surface = surface_of(&cloud.flow, &sources);
        let reached: Vec<u32> = (0..pulls.len() as u32)
            .filter(|i| top(*i as usize))
            .collect();
        let (mut n, mut kappa) = (vec![[0.0; 3]; reached.len()], vec![0.0; reached.len()]);
        let typed = tension.typed.as_mut().unwrap();
        let again = || typed.prescribe(&surface, top, &reached, (&mut n, &mut kappa));
        assert_eq!(counted(again), 0, "allocations of another step");
        let mut held = Vec::new();
        tension.friction(&surface, &cloud.flow.particles.velocity, &mut held);
        for (i, held) in held.iter().enumerate() {
            let film = cloud.flow.position(i)[2] < 2.1 * S0;
            let most = if film { f32::MAX } else { 0.0 };
            let [most, drive] = [[most, 0.0, 0.0], [0.0; 3]];
            let hold = Hold {
                most,
                drive,
                ..Hold::default()
            };
            assert_eq!(*held, hold);
        }
    }
}
