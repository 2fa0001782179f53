//! Splitting and merging of rings, so that the area of each in the half-plane stays near that of a
//! lattice cell: m = 2 pi r rho A is kept, and A falls where a ring moves outwards.
//!
//! Two rings of one body, each the nearest of the other, merge where one has less than half of a
//! cell and both together less than a cell, if they are near and hardly move apart: mass, momentum,
//! centre of mass and volume are kept, and the kinetic energy that is lost is booked. A ring of
//! more than root 2 cells, which is as far from one as its halves are, becomes two beside each
//! other in the direction in which it has the fewest neighbours: what it has of energy is kept,
//! but for that of the surface, which is booked too: in a disc of water that collapses to its axis
//! a tenth of the largest kinetic energy, whatever the spacing. These limits are those of
//! [`crate::scene::Rings`].

use super::liquid::Liquid;
use crate::kernel::{Kernel, WendlandC2};
use crate::particle::State;
use crate::particle::column::{Blend, Columns, Duplicate, Retain, Scalar, Scalars};
use crate::space::parallel::max;
use std::f64::consts::{PI, TAU};

/// Distance below which rings merge, in spacings.
const NEAR: f64 = 0.6;

/// Distance of half a ring from where the whole was, in edges of its area.
const ASIDE: f64 = 0.25;

/// Part by which the area of any ring may change, as its radius does, until areas are looked at
/// again, and most steps until then.
const CHANGE: f64 = 0.1;
const STEPS: f64 = 100.0;

/// When areas are looked at next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Adaption {
    next_step: u64,
    /// Identities given so far.
    ids: u32,
}

impl Scalars for Adaption {
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar)) {
        see("adaption_step", &mut self.next_step);
        see("identities", &mut self.ids);
    }
}

impl Adaption {
    /// As in a state, or at the start of a run.
    pub fn of(state: &State) -> Self {
        let largest = state.particles.id.iter().max();
        let mut adaption = Adaption {
            next_step: 0,
            ids: largest.map_or(0, |id| id + 1),
        };
        adaption.load(state);
        adaption
    }
}

/// A ring that splits, and where its halves go from there, m.
struct Split {
    ring: u32,
    by: [f64; 2],
}

/// Rings that merge and that split.
pub struct Plan {
    splits: Vec<Split>,
    merged: Vec<[u32; 2]>,
}

impl Adaption {
    /// What merges and splits now, if anything does and the time has come. Rows must be those of
    /// now.
    pub fn plan(&mut self, liquid: &Liquid) -> Option<Plan> {
        let step = liquid.now.step;
        if !liquid.adapts() || step < self.next_step {
            return None;
        }
        let changed = liquid.radial_rate() * liquid.now.last_step;
        self.next_step = step + (CHANGE / changed).clamp(1.0, STEPS) as u64;
        let splits = liquid.splits();
        let merged = liquid.merging();
        (!splits.is_empty() || !merged.is_empty()).then_some(Plan { splits, merged })
    }
}

impl Liquid {
    /// Whether rings split and merge: not in a body that comes to rest alone.
    pub fn adapts(&self) -> bool {
        self.flow.is_axial() && !self.case.rests
    }

    /// Merges and splits rings; `own`: columns of the method. Particles have to be sorted, and rows
    /// found, again then; what their energy changed by is for the caller to book.
    pub fn adapt(&mut self, plan: &Plan, own: &mut impl Columns, adaption: &mut Adaption) {
        let mut kept = vec![true; self.len()];
        for &[into, gone] in &plan.merged {
            self.merge(into as usize, gone as usize, own);
            kept[gone as usize] = false;
        }
        self.split(&plan.splits, own, adaption);
        let n = kept.len() as u32;
        let kept = (0..n).filter(|&i| kept[i as usize]);
        let kept: Vec<u32> = kept.chain(n..self.len() as u32).collect();
        self.flow.particles.visit(&mut Retain(&kept));
        own.visit(&mut Retain(&kept));
        self.ledger.displaces = true;
    }

    /// Area of ring `i`, in cells.
    fn area(&self, i: usize) -> f64 {
        let (p, spacing) = (&self.flow.particles, self.case.spacing);
        let radius = (p.position[0][i] / spacing).max(0.5);
        p.weight(i) / (TAU * radius)
    }

    /// Largest rate at which a radius changes, over itself, 1/s.
    fn radial_rate(&self) -> f64 {
        let (p, least) = (&self.flow.particles, 0.5 * self.case.spacing);
        let rate = |i: usize| p.velocity[0][i].abs() / p.position[0][i].max(least);
        max(self.flow.span(), rate).max(0.0)
    }

    /// Neighbours of ring `i` among the liquid, and where they are from it, m.
    fn around(&self, i: usize) -> impl Iterator<Item = (usize, [f64; 2])> {
        let flow = &self.flow;
        let n = flow.liquid();
        let [x, _, z] = &flow.particles.position;
        let row = flow.rows.row(i).indices();
        row.filter(move |&j| j < n && j != i)
            .map(move |j| (j, [x[j] - x[i], z[j] - z[i]]))
    }

    /// Pairs to merge: the one that stays and the one that goes.
    fn merging(&self) -> Vec<[u32; 2]> {
        let p = &self.flow.particles;
        let case = &self.case;
        let Some(limits) = case.domain.revolved else {
            return Vec::new();
        };
        let near = NEAR * case.spacing;
        // What tension can hold together.
        let slow = case.effects.sigma().map_or(f64::INFINITY, |sigma| {
            (sigma / (case.density * case.spacing)).sqrt()
        });
        let partner = |i: usize| -> Option<usize> {
            let area = self.area(i);
            let fits = |j: usize, d: [f64; 2]| {
                let other = self.area(j);
                let apart = (0..3).map(|a| (p.velocity[a][i] - p.velocity[a][j]).powi(2));
                area.min(other) < limits.merge
                    && area + other < 1.0
                    && p.body[i] == p.body[j]
                    && d[0].hypot(d[1]) < near
                    && apart.sum::<f64>() < slow * slow
            };
            if area >= 1.0 {
                return None;
            }
            let found = self.around(i).filter(|&(j, d)| fits(j, d));
            let distance = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
            found
                .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
                .map(|(j, _)| j)
        };
        let pairs = (0..p.len()).filter_map(|i| {
            let j = partner(i)?;
            (i < j && partner(j) == Some(i)).then_some([i as u32, j as u32])
        });
        pairs.collect()
    }

    fn merge(&mut self, i: usize, j: usize, own: &mut impl Columns) {
        let p = &mut self.flow.particles;
        let (a, b) = (p.weight[i], p.weight[j]);
        let whole = a + b;
        let mean = |values: &mut Vec<f64>| values[i] = (a * values[i] + b * values[j]) / whole;
        p.position.iter_mut().for_each(mean);
        p.velocity.iter_mut().for_each(mean);
        p.density[i] = whole / (a / p.density[i] + b / p.density[j]);
        p.weight[i] = whole;
        let part = b / whole;
        own.visit(&mut Blend { i, j, part });
    }

    /// Rings that split.
    fn splits(&self) -> Vec<Split> {
        let most = self.case.domain.revolved.unwrap_or_default().split;
        let large = (0..self.len()).filter(|&i| self.area(i) > most);
        large.map(|i| self.divided(i)).collect()
    }

    fn divided(&self, i: usize) -> Split {
        let (flow, case) = (&self.flow, &self.case);
        let mut spread = [0.0; 3];
        for (_, [x, z]) in self.around(i) {
            let distance = (x * x + z * z).sqrt() / case.h;
            let w = WendlandC2::w(distance);
            spread = [
                spread[0] + w * x * x,
                spread[1] + w * x * z,
                spread[2] + w * z * z,
            ];
        }
        let [xx, xz, zz] = spread;
        let along = 0.5 * (2.0 * xz).atan2(xx - zz) + 0.5 * PI;
        let length = ASIDE * self.area(i).sqrt() * case.spacing;
        let [x, _, z] = flow.position(i);
        let mut by = [length * along.cos(), length * along.sin()];
        // Neither across the axis nor into a wall.
        let is_outside = |at: f64, by: f64, size: f64| at - by.abs() < 0.0 || at + by.abs() > size;
        let size = case.domain.size;
        if x < case.spacing || is_outside(x, by[0], size[0]) {
            by = [0.0, length];
        }
        if is_outside(z, by[1], size[2]) {
            by = [length.min(0.5 * x), 0.0];
        }
        Split { ring: i as u32, by }
    }

    fn split(&mut self, splits: &[Split], own: &mut impl Columns, adaption: &mut Adaption) {
        let n = self.len();
        let rings: Vec<u32> = splits.iter().map(|split| split.ring).collect();
        let p = &mut self.flow.particles;
        p.visit(&mut Duplicate(&rings));
        own.visit(&mut Duplicate(&rings));
        for (k, split) in splits.iter().enumerate() {
            for (i, side) in [(split.ring as usize, 1.0), (n + k, -1.0)] {
                p.weight[i] *= 0.5;
                p.position[0][i] += side * split.by[0];
                p.position[2][i] += side * split.by[1];
            }
            p.id[n + k] = adaption.ids;
            adaption.ids += 1;
        }
    }
}
