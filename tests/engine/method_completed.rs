//! The density that is completed at a free surface: its rate, and the work of its pressure.

use super::cloud::{Cloud, OPEN};
use coronet::effect::tension::pass::{Energetic, Pull};
use coronet::effect::tension::ringed::{self, Heavy, alone};
use coronet::kernel::{Kernel, WendlandC2, plane};
use coronet::method::completed::{Completed, pass, ring};
use coronet::method::pass::{Spared, Sparing};
use coronet::method::projection::surface::Share;
use coronet::method::ring::{Compressed, Continuity};
use coronet::scene::{Dimension, KernelName, Side};
use coronet::space::sweep::rows;
use std::marker::PhantomData;

const AXIS: [[Side; 2]; 3] = [
    [Side::Axis, Side::Open],
    [Side::Periodic; 2],
    [Side::Open; 2],
];

/// Particles with free surfaces.
struct Body {
    cloud: Cloud,
    dimension: usize,
    share: Share,
}

impl Body {
    fn new(dimension: Dimension, sides: [[Side; 2]; 3], cells: [f64; 3]) -> Self {
        let cloud = Cloud::new(dimension, cells, sides, [1.5, 0.2], |_| true);
        let is_flat = dimension == Dimension::Two && !cloud.flow.is_axial();
        let dimension = if is_flat { 2 } else { 3 };
        Body {
            cloud,
            dimension,
            share: Share::of(KernelName::WendlandC2, dimension),
        }
    }

    fn all() -> [Body; 3] {
        [
            Body::new(Dimension::Two, OPEN, [16.0, 0.0, 12.0]),
            Body::new(Dimension::Three, OPEN, [12.0, 10.0, 9.0]),
            Body::new(Dimension::Two, AXIS, [14.0, 0.0, 10.0]),
        ]
    }

    fn len(&self) -> usize {
        self.cloud.flow.liquid()
    }

    /// V norm / h^d.
    fn unit(&self) -> f64 {
        let d = self.dimension as i32;
        let spacing = self.cloud.flow.lengths.spacing;
        spacing.powi(d) * WendlandC2::norm(self.dimension) / self.cloud.h.powi(d)
    }

    fn mass(&self, i: usize) -> f64 {
        self.cloud.flow.particles.weight(i)
    }

    fn is_axial(&self) -> bool {
        self.cloud.flow.is_axial()
    }

    /// n and its derivatives.
    fn look(&mut self) -> Vec<Completed> {
        let (n, unit) = (self.len(), self.unit());
        let scale = self.cloud.flow.grid.scale(self.cloud.h);
        let mut completed = vec![Completed::default(); n];
        if !self.is_axial() {
            self.cloud.pack::<()>(&vec![[0.0; 5]; n]);
            let pass = pass::Look {
                unit,
                share: &self.share,
                wanted: |_| true,
                kernel: PhantomData::<WendlandC2>,
            };
            let flow = &self.cloud.flow;
            rows(&flow.records, &flow.rows, scale, &pass, &mut completed);
            return completed;
        }
        let heavy: Vec<[f32; 5]> = (0..n)
            .map(|i| [self.mass(i) as f32, 0.0, 0.0, 0.0, 0.0])
            .collect();
        self.cloud.pack::<Heavy>(&heavy);
        let flow = &self.cloud.flow;
        let radii = flow.radii(self.cloud.h);
        let mut sums = vec![[0.0f32; 4]; n];
        let wanted = |_| true;
        let pass = ringed::Look { radii, wanted };
        rows(&flow.records, &flow.rows, scale, &pass, &mut sums);
        let of = |i: usize| {
            let ([r, _, z, sum], own) = (sums[i].map(f64::from), radii.own(i));
            let r = r + self.mass(i) * own.gradient;
            let sum = sum + self.mass(i) * own.value;
            Completed::of(&self.share, unit * sum, [unit * r, 0.0, unit * z])
        };
        (0..n).map(of).collect()
    }

    /// Rates of n at velocities in h a second.
    fn rates(&mut self, velocity: &[[f32; 3]], completed: &[Completed]) -> Vec<f64> {
        let (n, unit) = (self.len(), self.unit());
        let carried: Vec<[f32; 5]> = (0..n)
            .map(|i| {
                let [x, y, z] = velocity[i];
                match self.is_axial() {
                    true => [x, z, 0.0, 0.0, self.mass(i) as f32],
                    false => [x, y, z, 0.0, 0.0],
                }
            })
            .collect();
        let scale = self.cloud.flow.grid.scale(self.cloud.h);
        let mut out = vec![[0.0f32; 3]; n];
        if !self.is_axial() {
            self.cloud.pack::<Sparing>(&carried);
            let pass = pass::Spared {
                plain: Spared {
                    factor: unit,
                    diffusion: 0.0,
                    held: [0.0; 3],
                    kernel: PhantomData::<WendlandC2>,
                },
                completed,
            };
            let flow = &self.cloud.flow;
            rows(&flow.records, &flow.rows, scale, &pass, &mut out);
            return out.iter().map(|out| out[0] as f64).collect();
        }
        self.cloud.pack::<Compressed>(&carried);
        let flow = &self.cloud.flow;
        let pass = ring::Continuity {
            plain: Continuity {
                radii: flow.radii(self.cloud.h),
                diffusion: 0.0,
                held: 0.0,
            },
            completed,
        };
        rows(&flow.records, &flow.rows, scale, &pass, &mut out);
        let whole = |i: usize| {
            let push = self.mass(i) * velocity[i][0] as f64;
            unit * pass.closing(i, out[i], push)
        };
        (0..n).map(whole).collect()
    }

    /// Forces of a `pressure` over mass.
    fn forces(&mut self, pressure: &[f32], completed: &[Completed]) -> Vec<[f64; 3]> {
        let (n, unit) = (self.len(), self.unit());
        let carried: Vec<[f32; 5]> = (0..n)
            .map(|i| {
                let Energetic { slope, gradient } = completed[i].press(pressure[i]);
                let [x, y, z] = gradient;
                match self.is_axial() {
                    true => [slope, x, self.mass(i) as f32, z, 0.0],
                    false => [slope, x, y, z, 0.0],
                }
            })
            .collect();
        let scale = self.cloud.flow.grid.scale(self.cloud.h);
        let mut out = vec![[0.0f32; 3]; n];
        if !self.is_axial() {
            self.cloud.pack::<Energetic>(&carried);
            let pass = Pull::<WendlandC2> {
                factor: -unit,
                kernel: PhantomData,
            };
            let flow = &self.cloud.flow;
            rows(&flow.records, &flow.rows, scale, &pass, &mut out);
            return out.iter().map(|out| out.map(f64::from)).collect();
        }
        self.cloud.pack::<ringed::Energetic>(&carried);
        let flow = &self.cloud.flow;
        let radii = flow.radii(self.cloud.h);
        let pass = ringed::Pull { radii };
        rows(&flow.records, &flow.rows, scale, &pass, &mut out);
        let whole = |i: usize| {
            let [r, _, z] = out[i].map(f64::from);
            let Completed { slope, along, .. } = completed[i];
            let own = alone(radii, i, [slope, along[0]].map(f64::from));
            let own = self.mass(i) * pressure[i] as f64 * own;
            [r + own, 0.0, z].map(|f| -unit * f)
        };
        (0..n).map(whole).collect()
    }

    fn random(&mut self) -> Vec<[f32; 3]> {
        let is_deep = self.dimension == 3 && !self.is_axial();
        let random = &mut self.cloud.random;
        (0..self.cloud.flow.liquid())
            .map(|_| {
                let [x, y, z] = [0; 3].map(|_| random.signed() as f32);
                [x, if is_deep { y } else { 0.0 }, z]
            })
            .collect()
    }
}

#[test]
fn the_rate_is_that_of_the_density() {
    for mut body in Body::all() {
        let velocity = body.random();
        let completed = body.look();
        let rates = body.rates(&velocity, &completed);
        let (n, step) = (body.len(), 2e-3);
        let mut moved = |time: f64| {
            let home = body.cloud.flow.particles.position.clone();
            for a in 0..3 {
                let x = &mut body.cloud.flow.particles.position[a];
                for (i, x) in x.iter_mut().enumerate() {
                    *x += time * velocity[i][a] as f64 * body.cloud.h;
                    if a == 0 && body.cloud.flow.domain.is_axial() {
                        *x = x.abs();
                    }
                }
            }
            let found = body.look();
            body.cloud.flow.particles.position = home;
            found
        };
        let (after, before) = (moved(step), moved(-step));
        let size = rates.iter().map(|r| r * r).sum::<f64>() / n as f64;
        let wrong = (0..n).map(|i| {
            let by = (after[i].value - before[i].value) as f64 / (2.0 * step);
            (by - rates[i]).powi(2)
        });
        let error = (wrong.sum::<f64>() / n as f64 / size).sqrt();
        println!("{error:.5} of {:.3}", size.sqrt());
        assert!(error < 0.02, "{error}");
    }
}

#[test]
fn the_work_of_the_force_is_that_of_the_density() {
    for mut body in Body::all() {
        let velocity = body.random();
        let pressure: Vec<f32> = body.random().iter().map(|v| 2.0 + v[0]).collect();
        let completed = body.look();
        let rates = body.rates(&velocity, &completed);
        let forces = body.forces(&pressure, &completed);
        let of_density = (0..body.len()).map(|i| body.mass(i) * rates[i] * pressure[i] as f64);
        let of_density: f64 = of_density.sum();
        let work = |i: usize| {
            let of = |a: usize| forces[i][a] * velocity[i][a] as f64;
            body.mass(i) * (0..3).map(of).sum::<f64>()
        };
        let of_force: f64 = (0..body.len()).map(work).sum();
        let error = of_force / -of_density - 1.0;
        assert!(error.abs() < 1e-3, "{of_force} {of_density}");
    }
}

/// Stretched along its surface by as much as it becomes thinner, liquid seemed to expand there.
#[test]
fn a_surface_that_is_stretched_keeps_its_density() {
    for mut body in Body::all() {
        let h = body.cloud.h;
        let is_axial = body.is_axial();
        let squeezed = if is_axial { -2.0 } else { -1.0 };
        let n = body.len();
        let velocity: Vec<[f32; 3]> = (0..n)
            .map(|i| {
                let [x, _, z] = body.cloud.flow.position(i);
                [x / h, 0.0, squeezed * z / h].map(|v| v as f32)
            })
            .collect();
        let size = body.cloud.flow.domain.size;
        // At the surfaces above and below, away from edges.
        let counted: Vec<usize> = (0..n)
            .filter(|&i| {
                let [x, y, z] = body.cloud.flow.position(i);
                let inside = |x: f64, size: f64| x > 2.2 * h && x < size - 2.2 * h;
                let aside = (is_axial || x > 2.2 * h) && x < size[0] - 2.2 * h;
                let deep = body.dimension == 2 || is_axial || inside(y, size[1]);
                aside && deep && !(z > h && z < size[2] - h)
            })
            .collect();
        assert!(counted.len() > 8);
        let completed = body.look();
        let with = body.rates(&velocity, &completed);
        let without = body.rates(&velocity, &vec![Completed::default(); n]);
        let mean = |rates: &[f64]| {
            let of = counted.iter().map(|&i| rates[i]);
            of.sum::<f64>() / counted.len() as f64
        };
        let [with, without] = [mean(&with), mean(&without)];
        println!("{without:.4} to {with:.4}");
        assert!(with.abs() < 0.25 * without.abs(), "{with} of {without}");
    }
}

/// Over the surface too, where tips of liquid are, a half-space has its density, and n_C and n_g
/// are the slopes of n.
#[test]
fn of_a_half_space_from_above_it_to_below_it() {
    for dimension in [2, 3] {
        let kernel = KernelName::WendlandC2;
        let share = Share::of(kernel, dimension);
        let steps = 2000;
        let dz = 2.0 / steps as f64;
        let mut fill = 0.5;
        for k in 0..steps {
            let z = k as f64 * dz;
            let slope = plane(kernel, dimension, z);
            for (fill, z) in [(fill, z), (1.0 - fill, -z)] {
                if z > -0.55 {
                    let of = Completed::of(&share, 1.1 * fill, [0.0, 0.0, 1.1 * slope]);
                    assert!((of.value - 1.1).abs() < 4e-3, "{dimension} {z}: {of:?}");
                }
            }
            fill += plane(kernel, dimension, z + 0.5 * dz) * dz;
        }
        for k in 1..29 {
            let (sum, steepness) = (0.7, 0.1 * k as f64);
            let value = |sum: f64, g: f64| {
                let [part, _] = share.slope(g / sum);
                sum / part
            };
            let (g, d) = (steepness * sum, 2e-3);
            let of = Completed::of(&share, sum, [0.0, 0.0, g]);
            let by_sum = (value(sum + d, g) - value(sum - d, g)) / (2.0 * d);
            let by_gradient = (value(sum, g + d) - value(sum, g - d)) / (2.0 * d);
            let near = |a: f64, b: f64| (a - b).abs() < 0.02 * b.abs() + 0.02;
            assert!(
                near(of.slope as f64, by_sum),
                "{steepness}: {of:?} {by_sum}"
            );
            let along = of.along[2] as f64;
            assert!(
                near(along, by_gradient),
                "{steepness}: {of:?} {by_gradient}"
            );
        }
    }
}
