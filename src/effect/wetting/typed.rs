//! Contact angle by types of particles, Xie, Koshizuka & Oka (2007), Section 2.5, in 2-D.
//!
//! At a distance z from a wall:
//! (1) boundary particles, z < L1, do not move along the wall: a film that is the no-slip wall
//! (2) signal particles: the outermost on either side with L1 < z < L2 that are not at the surface
//! (3) contact line particles are boundary ones at the surface within L3 of a signal particle,
//!     contact line free particles the others at the surface within L3
//! (4) n = n_wall cos theta + n_t sin theta of both                                  Eq. 18
//! (5) kappa of a contact line particle is that of the nearest contact line free one
//!
//! The paper does not say where n_wall points: n of [`crate::effect::tension`] points into the
//! liquid, and so n_wall into the wall. With an advancing and a receding angle theta is the angle
//! of the n that (4) replaces, kept between the two (the paper: one of them, by a
//! motion that it does not state).
//!
//! A line that advances rolls over its film, and one that recedes leaves it behind. L1, L2, L3:
//! 2.1, 4.1, 4.1 l0. Fails where the drop is not much higher than L2 or in several pieces on one
//! wall. Test: tests/engine/effect_counted.rs.

use super::friction::Hold;
use crate::effect::surface::Surface;
use crate::scene::{Domain, Side, Wetting};

/// The angle, and the particles at contact lines.
#[derive(Clone, Debug)]
pub struct Typed {
    /// The contact angle.
    pub angle: Wetting,
    /// The box, which says where walls are.
    pub domain: Domain,
    /// L1, L2, L3, m.
    pub lengths: [f64; 3],
    /// Those about a signal particle, by place in a list of the surface's.
    pub here: Vec<usize>,
}

/// A wall: its axis, that along it, and which side.
#[derive(Clone, Copy)]
struct Wall {
    across: usize,
    along: usize,
    side: usize,
}

impl Typed {
    /// (2) to (5), for the particles `reached` at the surface: changes n and kappa, 1/m.
    pub fn prescribe(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool,
        reached: &[u32],
        (normal, curvature): (&mut [[f64; 3]], &mut [f64]),
    ) {
        let mut here = std::mem::take(&mut self.here);
        for wall in self.walls() {
            let Some(signals) = self.signals(flow, &is_surface, wall) else {
                continue;
            };
            for (signal, inward) in signals.into_iter().zip([1.0, -1.0]) {
                let nearest = |k: usize| {
                    let apart = |other: usize| distance(flow, reached[k] as usize, other, wall);
                    let other = signals[usize::from(inward > 0.0)];
                    let [own, beyond] = [signal, other].map(apart);
                    let wins = own < beyond || inward > 0.0 && own == beyond;
                    wins && own < self.lengths[2]
                };
                here.clear();
                here.extend((0..reached.len()).filter(|k| nearest(*k)));
                let is_free =
                    |k: &&usize| self.height(flow, reached[**k] as usize, wall) >= self.lengths[0];
                for &k in &here {
                    normal[k] = self.normal(normal[k], wall, inward);
                    let i = reached[k] as usize;
                    let apart = |f: &usize| distance(flow, i, reached[*f] as usize, wall);
                    let free = here.iter().filter(is_free);
                    let nearest = free.min_by(|a, b| apart(a).total_cmp(&apart(b)));
                    if let Some(&nearest) = nearest {
                        curvature[k] = curvature[nearest];
                    }
                }
            }
        }
        self.here = here;
    }

    /// Fills `into`, by liquid particle, with a friction along walls that stops every boundary
    /// particle (1), m/s^2.
    pub fn hold(&self, flow: &Surface, into: &mut [Hold]) {
        for wall in self.walls() {
            for (i, hold) in into.iter_mut().enumerate() {
                if self.height(flow, i, wall) < self.lengths[0] {
                    hold.most[wall.along] = f32::MAX;
                }
            }
        }
    }

    fn walls(&self) -> impl Iterator<Item = Wall> {
        let sides = [(0, 2), (2, 0)].into_iter().flat_map(|(across, along)| {
            [0, 1].map(|side| Wall {
                across,
                along,
                side,
            })
        });
        sides.filter(|wall| self.domain.boundary[wall.across][wall.side] == Side::Wall)
    }

    /// Distance from the wall, m.
    fn height(&self, flow: &Surface, i: usize, wall: Wall) -> f64 {
        let x = flow.position[wall.across][i];
        [x, self.domain.size[wall.across] - x][wall.side]
    }

    /// (2): the first and the last along the wall.
    fn signals(
        &self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool,
        wall: Wall,
    ) -> Option<[usize; 2]> {
        let [low, high, _] = self.lengths;
        let along = &flow.position[wall.along];
        let layer = |i: &usize| {
            let z = self.height(flow, *i, wall);
            low < z && z < high && !is_surface(*i)
        };
        let widened = |[first, last]: [usize; 2], i: usize| {
            let first = if along[i] < along[first] { i } else { first };
            [first, if along[i] < along[last] { last } else { i }]
        };
        let ends = (0..flow.density.len()).filter(layer).map(|i| [i; 2]);
        ends.reduce(|ends, [i, _]| widened(ends, i))
    }

    /// (4); `inward`: the sign of n_t.
    fn normal(&self, counted: [f64; 3], wall: Wall, inward: f64) -> [f64; 3] {
        let into_wall = [-1.0, 1.0][wall.side];
        let [least, most] = self.angle.cosines();
        let cosine = (into_wall * counted[wall.across]).clamp(least, most);
        let mut normal = [0.0; 3];
        normal[wall.across] = into_wall * cosine;
        normal[wall.along] = inward * (1.0 - cosine * cosine).max(0.0).sqrt();
        normal
    }
}

/// Distance of two particles in the plane, m.
fn distance(flow: &Surface, a: usize, b: usize, wall: Wall) -> f64 {
    let apart = |axis: usize| flow.position[axis][a] - flow.position[axis][b];
    apart(wall.across).hypot(apart(wall.along))
}
