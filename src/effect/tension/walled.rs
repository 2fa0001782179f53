//! The tension of liquid on walls with a contact angle: numbers as in [`crate::effect::wetting`].

use super::level::{Bend, Curvature, LEAST, curvature};
use super::pass::Summed;
use super::{FAINT, Tension};
use crate::effect::depth::depths;
use crate::effect::normal::Gradient;
use crate::effect::surface::Surface;
use crate::effect::wetting::friction::Hold;
use crate::effect::wetting::survey::{direction, nearest};
use crate::effect::wetting::{TIMES, Walls, Wetting};
use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::scene::KernelName;
use crate::space::mirror::PAIRS;
use crate::space::parallel::each_mut;
use crate::space::sweep;
use std::marker::PhantomData;

impl Tension {
    /// Colours of walls and normals; with hysteresis for the angles that lines have.
    pub(super) fn wet<K: Kernel>(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool + Sync,
    ) {
        let Some(mut wetting) = self.wetting.take() else {
            return;
        };
        self.find_lines::<K>(flow, is_surface, &mut wetting);
        wetting.colour::<K>(flow);
        wetting.leave_out();
        self.sum_walls::<K>(flow, &mut wetting);
        self.join_walls::<K>(flow, &mut wetting);
        self.wetting = Some(wetting);
    }

    /// Wall particles near a surface, n of the liquid, and with hysteresis the angles of lines.
    pub(super) fn find_lines<K: Kernel>(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool + Sync,
        wetting: &mut Wetting,
    ) {
        wetting.find::<K>(flow, is_surface);
        self.sum_liquid::<K>(flow, wetting);
        for _ in 0..if wetting.rubs() { TIMES } else { 0 } {
            wetting.colour::<K>(flow);
            self.sum_walls::<K>(flow, wetting);
            self.measure_lines::<K>(flow, wetting);
        }
    }

    /// n of the liquid by itself.
    fn sum_liquid<K: Kernel>(&mut self, flow: &Surface, wetting: &Wetting) {
        let mut normals = std::mem::take(&mut self.normals);
        normals.resize(self.near.len(), Default::default());
        let (liquid, areas) = (flow.of_liquid(), &wetting.areas);
        if areas[0].is_empty() {
            let field = flow.about(flow.position, liquid, &[], self.length);
            let pass = Gradient::<K>(PhantomData);
            sweep::runs_shared(field, &self.spans[0], &self.near, &pass, &mut normals);
        } else {
            let field = flow.about(flow.position, liquid, areas, self.length);
            sweep::runs(field, &self.near, &Walls::<K>(PhantomData), &mut normals);
        }
        self.normals = normals;
    }

    /// What the walls' colours add to it.
    fn sum_walls<K: Kernel>(&mut self, flow: &Surface, wetting: &mut Wetting) {
        let n = flow.density.len();
        self.payload[0][..n].fill(1.0);
        self.payload[0][n..n + wetting.colour.len()].copy_from_slice(&wetting.colour);
        flow.share(&mut self.payload[0]);
        wetting.walls.resize(self.near.len(), Default::default());
        let field = flow.about(flow.position, flow.of_wall(), &self.payload, self.length);
        let pass = Walls::<K>(PhantomData);
        sweep::runs_shared(field, &self.spans[0], &self.near, &pass, &mut wetting.walls);
    }

    /// The angles of contact lines from the normals of the liquid at them.
    fn measure_lines<K: Kernel>(&mut self, flow: &Surface, wetting: &mut Wetting) {
        let dimension = wetting.setting.dimension;
        let gradient = K::norm(dimension) / self.length.powi(dimension as i32 + 1);
        let factor = gradient * wetting.mass(flow) / self.density * self.length;
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        wetting.lines.clear(flow);
        for (k, (normal, _)) in self.normals.iter().enumerate() {
            let (coloured, wall) = wetting.walls[k];
            let wall = wall.map(f64::from);
            let n = [0, 1, 2].map(|a| factor * (normal[a] + coloured[a]) as f64);
            let (size, stress) = (dot(wall, wall).sqrt(), dot(n, n) - FAINT * FAINT);
            if size == 0.0 || stress <= 0.0 {
                continue;
            }
            let cosine = (dot(n, wall) / (dot(n, n).sqrt() * size)).clamp(-1.0, 1.0);
            let i = self.near[k] as usize;
            let at = [0, 1, 2].map(|a| flow.position[a][i]);
            let height = wetting.above(at, wall) / self.length;
            wetting.lines.add(i, height, stress * size, cosine);
        }
        wetting.take_angles::<K>(flow);
    }

    /// n with the walls' colours: of the liquid, and of wall particles; what shifts beside walls.
    fn join_walls<K: Kernel>(&mut self, flow: &Surface, wetting: &mut Wetting) {
        let sums = &wetting.walls;
        each_mut(&mut self.normals[..self.near.len()], |k, slots| {
            let (normal, _) = slots;
            (0..3).for_each(|a| normal[a] += sums[k].0[a]);
        });
        let pass = Walls::<K>(PhantomData);
        if let Some(short) = wetting.short {
            let beside = self.near.iter().zip(&wetting.walls);
            let beside = beside.filter_map(|(&i, sums)| (sums.1 != [0.0; 3]).then_some(i));
            wetting.beside.clear();
            wetting.beside.extend(beside);
            let field = flow.about(flow.position, flow.of_wall(), &self.payload, short);
            let shorter = &mut wetting.shorter;
            shorter.resize(wetting.beside.len(), Default::default());
            sweep::runs(field, &wetting.beside, &pass, shorter);
        }
        let normals = &mut wetting.normals;
        normals.resize(wetting.near.len(), Default::default());
        let field = flow.about(flow.wall, flow.sources, &self.payload, self.length);
        sweep::runs(field, &wetting.near, &pass, normals);
        self.root_walls::<K>(flow, wetting);
    }

    /// Turns n of wall particles into sqrt(c_w |T|) n / |n| / rho0.
    fn root_walls<K: Kernel>(&self, flow: &Surface, wetting: &mut Wetting) {
        let gradient = K::norm(self.dimension) / self.length.powi(self.dimension as i32 + 1);
        let factor = gradient * flow.mass / self.density;
        let (tension, epsilon) = (self.strength * self.coefficient, FAINT / self.length);
        for k in 0..wetting.near.len() {
            let colour = wetting.colour[wetting.near[k] as usize] as f64;
            let sum = &mut wetting.normals[k].0;
            let n = sum.map(|sum| factor * sum as f64);
            let square = n.iter().map(|n| n * n).sum::<f64>();
            let stress = colour * tension * (square - epsilon * epsilon).max(0.0) * self.length;
            let scale = stress.sqrt() / self.density / square.sqrt().max(f64::MIN_POSITIVE);
            *sum = n.map(|n| (scale * n) as f32);
        }
    }

    /// Young's force on contact lines, (4) and (5), in place of the own part of the stress's.
    pub(super) fn pull_lines<K: Kernel>(&mut self, flow: &Surface) {
        let Some(mut wetting) = self.wetting.take() else {
            return;
        };
        let mut lines = std::mem::take(&mut self.lines);
        let mut feet = std::mem::take(&mut self.feet);
        lines.clear();
        feet.clear();
        for (k, (u, own)) in self.normals.iter_mut().enumerate() {
            *own = [0.0; 3];
            if *u != [0.0; 3] && wetting.walls[k].1 != [0.0; 3] {
                lines.push(self.near[k]);
                feet.push(k as u32);
            }
        }
        let sources = self.stressed.sources();
        let field = self.field(flow, self.length);
        let field = self.stressed.field(field, &sources, &self.stressed.u);
        let place = |line: usize| {
            let k = feet[line] as usize;
            [self.normals[k].0, wetting.walls[k].1]
        };
        let count = flow.density.len();
        wetting.rises.measure::<K>(field, &lines, count, place);
        let factor = self.force_factor::<K>(flow.mass);
        let rubs = wetting.rubs();
        let mut hold = std::mem::take(&mut wetting.friction.hold);
        hold.resize(feet.len(), Hold::default());
        for (line, hold) in hold.iter_mut().enumerate() {
            let (k, i) = (feet[line] as usize, lines[line] as usize);
            let (u, own) = &mut self.normals[k];
            let at = [0, 1, 2].map(|a| flow.position[a][i]);
            let wall = wetting.walls[k].1.map(f64::from);
            let rise = wetting.rises.of[line] as f64;
            let (young, held) = wetting.young(u.map(f64::from), wall, at, rise);
            *own = young.map(|y| (factor * y) as f32);
            if rubs {
                let [most, drive] = held.map(|f| f.map(|f| (factor * f) as f32));
                let (normal, wall) = nearest(&wetting.setting.domain, at);
                let tilt = [0, 1, 2].map(|a| if a == normal { 0.0 } else { u[a] });
                let across = direction(wetting.setting.dimension, tilt);
                *hold = Hold {
                    most,
                    drive,
                    across,
                    wall,
                };
            }
        }
        if !rubs {
            hold.clear();
        }
        wetting.friction.hold = hold;
        (self.lines, self.feet) = (lines, feet);
        self.wetting = Some(wetting);
    }

    /// Fills `into`, by liquid particle, with the friction of contact lines as of the last update
    /// (empty without hysteresis); velocity in m/s.
    pub fn friction(&mut self, flow: &Surface, velocity: &[Vec<f64>; 3], into: &mut Vec<Hold>) {
        into.clear();
        if let Some(typed) = &self.typed {
            into.resize(flow.density.len(), Hold::default());
            typed.hold(flow, into);
        }
        let (lines, length) = (self.lines.as_slice(), self.length);
        let wetting = self.wetting.as_mut();
        if let Some(wetting) = wetting.filter(|w| w.rubs()) {
            into.resize(flow.density.len(), Hold::default());
            let (friction, lines) = (&mut wetting.friction, (lines, length));
            match self.kernel {
                KernelName::CubicSpline => {
                    friction.share::<CubicSpline>(flow, lines, velocity, into);
                }
                KernelName::WendlandC2 => {
                    friction.share::<WendlandC2>(flow, lines, velocity, into);
                }
            }
        }
    }

    /// Adds what the stress on wall particles does to the liquid in reach, (3).
    pub(super) fn add_walls<K: Kernel>(
        &mut self,
        flow: &Surface,
        pass: &Summed<K>,
        force: &mut [[f32; 3]],
    ) {
        let Some(mut wetting) = self.wetting.take() else {
            return;
        };
        let n = flow.density.len();
        for (&j, (root, _)) in wetting.near.iter().zip(&wetting.normals) {
            (0..3).for_each(|a| self.payload[a][n + j as usize] = root[a]);
        }
        flow.turn(&mut self.payload);
        if self.lifted && self.dimension == 3 {
            self.lift_walls::<K>(flow, &mut wetting);
        }
        wetting.force.resize(force.len(), [0.0; 3]);
        let field = flow.about(flow.position, flow.of_wall(), &self.payload, self.length);
        sweep::runs(field, &self.reached, pass, &mut wetting.force);
        each_mut(&mut force[..wetting.force.len()], |k, sum| {
            (0..3).for_each(|a| sum[a] += wetting.force[k][a]);
        });
        self.wetting = Some(wetting);
    }

    /// Divides the stress of walls by 1 + b k, k the curvature of the surface along the contact
    /// line: what |n|^2 has grown by, as (2) of [`super::level`] does for the liquid. Across the
    /// line the surface goes on straight.
    fn lift_walls<K: Kernel>(&mut self, flow: &Surface, wetting: &mut Wetting) {
        let (n, count) = (flow.density.len(), flow.wall[0].len());
        for (roots, words) in wetting.roots.iter_mut().zip(&self.payload) {
            roots.clear();
            roots.extend_from_slice(&words[n..n + count]);
        }
        let mut bends = std::mem::take(&mut self.bends);
        bends.resize(wetting.near.len(), Bend::default());
        let field = flow.about(flow.wall, flow.sources, &self.payload, self.length);
        let (field, pass) = (field.owning(&wetting.roots), Curvature::<K>(PhantomData));
        sweep::runs(field, &wetting.near, &pass, &mut bends);
        let [_, b] = depths(self.kernel, self.dimension);
        for (&j, bend) in wetting.near.iter().zip(&bends) {
            let j = j as usize;
            let root = [0, 1, 2].map(|a| wetting.roots[a][j] as f64);
            let bent = along(&curvature(bend, self.dimension), wetting.along(j, root));
            let scale = 1.0 / (1.0 + (b * bent).max(LEAST)).sqrt();
            (0..3).for_each(|a| self.payload[a][n + j] = (scale * root[a]) as f32);
        }
        flow.turn(&mut self.payload);
        self.bends = bends;
    }
}

/// t . B t.
fn along(b: &[f64; 6], t: [f64; 3]) -> f64 {
    let terms = PAIRS.iter().zip(b).map(|(&(i, j), b)| {
        let times = if i == j { 1.0 } else { 2.0 };
        times * b * t[i] * t[j]
    });
    terms.sum()
}
