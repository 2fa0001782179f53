//! Takes the bumps of single particles off thick liquid, and leaves sheets, ligaments and drops.
//!
//! Where there is deep liquid within three spacings, the field is a mean over about a spacing: its
//! level 1/2 is then a smooth surface at the same place. Elsewhere it stays.

use rayon::prelude::*;

use super::Field;
use crate::draw::smooth_step;
use crate::space::lane::{Job, Lanes, Real, WIDTH, run_mixed};

/// Weights of a mean over five nodes, whose variance is one node squared.
const BINOMIAL: [f32; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];

/// How a field is smoothed.
pub(super) struct Smoothing {
    /// Means over five nodes along each axis, one after the other.
    pub passes: usize,
    /// Twice as many nodes around deep liquid are smoothed.
    pub reach: usize,
    /// How often the difference between the mean and the mean of it is added, against the
    /// flattening of curved surfaces.
    pub sharpness: f32,
    /// What the field of thin liquid is multiplied by.
    pub thin: f32,
}

impl Field {
    /// Smooths a field with nodes nearer than particles; `sharpness`: as in [`Smoothing`].
    pub(super) fn smooth(&mut self, sharpness: f32) {
        let cells = self.spacing / self.step.min();
        self.smooth_by(Smoothing {
            passes: (cells * cells).round() as usize,
            reach: (1.5 * cells).round() as usize,
            sharpness,
            thin: 1.0,
        });
    }

    /// Smooths the field.
    pub(super) fn smooth_by(&mut self, by: Smoothing) {
        let axes = [0, 1, 2].into_iter().filter(|&axis| self.count[axis] > 1);
        let axes: Vec<usize> = axes.collect();
        let mut mean: Vec<f32> = self.values.par_iter().map(|v| v.min(1.0)).collect();
        let mut spare = vec![0.0; mean.len()];
        let mut blur = |values: &mut Vec<f32>, passes: usize| {
            for axis in axes.iter().cycle().take(passes * axes.len()) {
                self.along(*axis, values, &mut spare, Mean);
                std::mem::swap(values, &mut spare);
            }
        };
        blur(&mut mean, by.passes);
        let mut depth = mean.clone();
        blur(&mut depth, by.passes);
        if by.sharpness > 0.0 {
            let pairs = mean.par_iter_mut().zip(&depth);
            pairs.for_each(|(mean, blurred)| *mean += by.sharpness * (*mean - blurred));
        }
        for axis in axes.iter().cycle().take(by.reach * axes.len()) {
            self.along(*axis, &depth, &mut spare, Largest);
            std::mem::swap(&mut depth, &mut spare);
        }
        let values = self.values.par_iter_mut().zip(mean).zip(depth);
        values.for_each(|((value, mean), depth)| {
            *value *= by.thin;
            *value += smooth_step(0.80, 0.96, depth) * (mean - *value);
        });
    }

    /// Makes a number of five nodes in a line along an axis; beyond the sides the last node counts.
    fn along<M: Mix>(&self, axis: usize, old: &[f32], new: &mut [f32], mix: M) {
        let (rows, row) = (self.count[1], self.count[2]);
        let layer = rows * row;
        new.par_chunks_mut(row).enumerate().for_each(|(n, out)| {
            let start = n * row;
            if axis == 2 {
                let line = &old[start..][..row];
                // Of the nodes near an end, and of a short row, one after the other.
                let inner = 2..row.saturating_sub(2).max(2);
                let ends = (0..row).filter(|k| !inner.contains(k));
                for k in ends {
                    let at = |d: usize| (k + d).clamp(2, row + 1) - 2;
                    out[k] = mix.one([0, 1, 2, 3, 4].map(|d| line[at(d)]));
                }
                if row > 4 {
                    let lines = [0, 1, 2, 3, 4].map(|d| &line[d..row - 4 + d]);
                    let out = &mut out[inner];
                    run_mixed(Mixing { lines, out, mix });
                }
                return;
            }
            let (place, count, stride) = match axis {
                0 => (n / rows, self.count[0], layer),
                _ => (n % rows, rows, row),
            };
            let lines = [0, 1, 2, 3, 4].map(|d| {
                let other = (place + d).clamp(2, count + 1) - 2;
                &old[start + other * stride - place * stride..][..row]
            });
            run_mixed(Mixing { lines, out, mix });
        });
    }
}

/// What is made of five numbers.
trait Mix: Copy + Sync {
    /// Of one five.
    fn one(self, near: [f32; 5]) -> f32;
    /// Of eight fives.
    fn eight<F: Real>(self, near: [F; 5]) -> F;
}

/// Their mean, with the weights of a binomial.
#[derive(Clone, Copy)]
struct Mean;

impl Mix for Mean {
    fn one(self, near: [f32; 5]) -> f32 {
        near.iter().zip(BINOMIAL).map(|(v, w)| v * w).sum()
    }

    #[inline(always)]
    fn eight<F: Real>(self, near: [F; 5]) -> F {
        let mut sum = near[0] * BINOMIAL[0];
        for k in 1..5 {
            sum += near[k] * BINOMIAL[k];
        }
        sum
    }
}

/// The largest of them and 0.
#[derive(Clone, Copy)]
struct Largest;

impl Mix for Largest {
    fn one(self, near: [f32; 5]) -> f32 {
        near.iter().copied().fold(0.0, f32::max)
    }

    #[inline(always)]
    fn eight<F: Real>(self, near: [F; 5]) -> F {
        let mut most = near[0].at_least(0.0);
        for k in 1..5 {
            most = near[k].max(most);
        }
        most
    }
}

/// Mixes lines side by side, each as long as the result.
struct Mixing<'a, M> {
    lines: [&'a [f32]; 5],
    out: &'a mut [f32],
    mix: M,
}

impl<M: Mix> Job for Mixing<'_, M> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let zero = lanes.splat(0.0);
        let mut first = 0;
        while first < self.out.len() {
            let Some(out) = self.out[first..].first_chunk_mut::<WIDTH>() else {
                break;
            };
            let mut near = [zero; 5];
            for k in 0..5 {
                if let Some(eight) = self.lines[k][first..].first_chunk::<WIDTH>() {
                    near[k] = zero.of_array(*eight);
                }
            }
            *out = self.mix.eight(near).to_array();
            first += WIDTH;
        }
        for k in first..self.out.len() {
            self.out[k] = self.mix.one(self.lines.map(|line| line[k]));
        }
    }
}
