//! Rays through the field of a surface: where they enter the liquid and where they leave it.

use nalgebra::Vector3;

use super::walk::{Blocks, Ray, Walk};
use crate::draw::surface::{Field, LEVEL};

/// A vector of a picture.
pub type V = Vector3<f32>;

/// A point at which a ray crosses the surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, m.
    pub distance: f32,
    /// Where, m.
    pub at: V,
    /// Unit normal, out of the liquid.
    pub normal: V,
    /// Whether it is on a side of the box of the field: a wall, or a cut.
    pub is_side: bool,
}

/// Where a ray crosses the surface: at a distance on a side of the box, or between two distances,
/// each with its phi.
enum Found {
    Side(f32),
    Between([(f32, f32); 2]),
}

/// A field with what rays need of it. A field of revolution fills a cylinder about its axis.
pub struct Tracer<'a> {
    field: &'a Field,
    low: V,
    high: V,
    inverse: V,
    /// Length of a step, m.
    step: f32,
    /// Of a field in three dimensions; without them no ray meets it.
    blocks: Option<Blocks>,
    /// The last cell along each axis.
    last: [i32; 3],
}

impl<'a> Tracer<'a> {
    /// Of a field in three dimensions, or of one of revolution.
    pub fn new(field: &'a Field) -> Tracer<'a> {
        let mut tracer = Tracer::without_rays(field);
        let is_solid = field.axis.is_none();
        tracer.blocks = is_solid.then(|| Blocks::new(field, tracer.step));
        tracer
    }

    /// The same for normals and colours alone.
    pub fn without_rays(field: &'a Field) -> Tracer<'a> {
        let (mut low, mut high) = (field.low, field.high());
        if let Some([x, y]) = field.axis {
            (low.x, low.y) = (x - high.x, y - high.x);
            (high.x, high.y) = (x + high.x, y + high.x);
        }
        let step = 0.6 * field.step.min();
        Tracer {
            field,
            low,
            high,
            inverse: field.step.map(|s| 1.0 / s),
            step,
            blocks: None,
            last: field.count.map(|count| count.saturating_sub(2) as i32),
        }
    }

    /// Corners of the box of the field, m.
    pub fn corners(&self) -> [V; 2] {
        [self.low, self.high]
    }

    /// Distance by which rays start off a surface, m.
    pub fn offset(&self) -> f32 {
        0.05 * self.step
    }

    /// Of the cylinder that a field of revolution fills, m.
    fn radius(&self) -> f32 {
        0.5 * (self.high.x - self.low.x)
    }

    /// Vector from the axis to a point of a body of revolution, its height left out.
    #[inline]
    fn off_axis(&self, p: &V) -> Option<V> {
        let [x, y] = self.field.axis?;
        Some(V::new(p.x - x, p.y - y, 0.0))
    }

    /// The cell of a point, and its place in it: of one outside those at the sides.
    #[inline(always)]
    fn cell(&self, p: &V) -> ([usize; 3], [f32; 3]) {
        let mut cell = [0; 3];
        let mut part = [0.0; 3];
        for a in 0..3 {
            // Signed numbers of 32 bits become numbers and come from them with the least work.
            let place = ((p[a] - self.low[a]) * self.inverse[a]).max(0.0);
            let at = (place as i32).min(self.last[a]);
            cell[a] = at as usize;
            part[a] = (place - at as f32).min(1.0);
        }
        (cell, part)
    }

    /// phi between nodes; at the sides if outside.
    #[inline]
    pub fn value(&self, p: &V) -> f32 {
        if let Some(off) = self.off_axis(p) {
            return self.field.at(off.norm(), p.z, &self.inverse).0;
        }
        let (cell, part) = self.cell(p);
        let count = self.field.count;
        let (row, layer) = (count[2], count[1] * count[2]);
        let start = self.field.index(cell);
        let near = &self.field.values[start..][..row + 2];
        let far = &self.field.values[start + layer..][..row + 2];
        let line = |values: &[f32], at: usize| values[at] + part[2] * (values[at + 1] - values[at]);
        let face = |values: &[f32]| {
            let (a, b) = (line(values, 0), line(values, row));
            a + part[1] * (b - a)
        };
        let (a, b) = (face(near), face(far));
        a + part[0] * (b - a)
    }

    /// Whether a point is in the box of the field.
    pub fn is_within(&self, p: &V) -> bool {
        let in_reach = |off: V| off.norm() <= self.radius();
        self.off_axis(p).is_none_or(in_reach)
            && (0..3).all(|a| p[a] >= self.low[a] && p[a] <= self.high[a])
    }

    /// Normal out of the liquid: minus the gradient over a step to each side.
    pub fn normal(&self, p: &V) -> V {
        if let Some(off) = self.off_axis(p) {
            return self.turned_normal(off, p.z);
        }
        let mut gradient = V::zeros();
        for a in 0..3 {
            let reach = self.field.step[a];
            let (mut low, mut high) = (*p, *p);
            low[a] = (p[a] - reach).max(self.low[a]);
            high[a] = (p[a] + reach).min(self.high[a]);
            gradient[a] = (self.value(&low) - self.value(&high)) / (high[a] - low[a]);
        }
        gradient.try_normalize(0.0).unwrap_or(V::z())
    }

    /// The same of a field of revolution, which goes on beyond its axis; `off`: vector from it.
    fn turned_normal(&self, off: V, z: f32) -> V {
        let (field, r) = (self.field, off.norm());
        let last = field.high();
        let outward = off.try_normalize(0.0).unwrap_or(V::x());
        let (near, far) = (r - field.step.x, (r + field.step.x).min(last.x));
        let (low, high) = (
            (z - field.step.z).max(self.low.z),
            (z + field.step.z).min(last.z),
        );
        let at = |r: f32, z: f32| field.at(r, z, &self.inverse).0;
        let away = (at(near.abs(), z) - at(far, z)) / (far - near);
        let up = (at(r, low) - at(r, high)) / (high - low);
        let normal = outward * away + V::z() * up;
        normal.try_normalize(0.0).unwrap_or(V::z())
    }

    /// Normal of a mesh where it is closed by a side of the box: that of the side.
    pub fn closing_normal(&self, p: &V) -> Option<V> {
        let near = |a: f32, b: f32| (a - b).abs() < self.offset();
        if let Some(off) = self.off_axis(p) {
            return match () {
                () if near(p.z, self.low.z) => Some(-V::z()),
                () if near(p.z, self.high.z) => Some(V::z()),
                () if near(off.norm(), self.radius()) => off.try_normalize(0.0),
                () => None,
            };
        }
        let axis = (0..3).find(|&a| near(p[a], self.low[a]) || near(p[a], self.high[a]))?;
        // Where the surface meets the side, half-way to what is inside, its own normal counts.
        let is_inside = self.value(p) > 0.5 * (1.0 + LEVEL);
        let sign = if near(p[axis], self.low[axis]) {
            -1.0
        } else {
            1.0
        };
        is_inside.then(|| V::ith(axis, sign))
    }

    /// Colour of the liquid at a point of its surface.
    pub fn colour(&self, p: &V) -> [f32; 3] {
        let (low, count) = (self.field.low, self.field.count);
        let off = self.off_axis(p);
        let p = &off.map_or(*p, |off| V::new(off.norm(), low.y, p.z));
        let node = [0, 1, 2].map(|a| {
            let place = ((p[a] - low[a]) * self.inverse[a]).max(0.0);
            (place as usize).min(count[a].saturating_sub(2))
        });
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for corner in 0..8 {
            let n = [0, 1, 2].map(|a| node[a] + (corner >> a & 1));
            if n[1] == count[1] {
                continue;
            }
            let d = (self.field.node(n) - p).component_mul(&self.inverse);
            let place = self.field.index(n);
            let weight = d.map(|d| (1.0 - d.abs()).max(0.0)).product() * self.field.values[place];
            let Some(colour) = self.field.colours.get(place) else {
                return [0.5; 3];
            };
            sum.iter_mut()
                .zip(colour)
                .for_each(|(s, c)| *s += weight * c);
            total += weight;
        }
        sum.map(|s| s / total.max(1e-9))
    }

    /// Distances at which a ray enters and leaves the box; the first is at least 0.
    fn range(&self, from: &V, inverse: &V) -> Option<[f32; 2]> {
        let (mut near, mut far) = (0.0f32, f32::MAX);
        for a in 0..3 {
            let (l, h) = (
                (self.low[a] - from[a]) * inverse[a],
                (self.high[a] - from[a]) * inverse[a],
            );
            if l.is_nan() || h.is_nan() {
                continue;
            }
            near = near.max(l.min(h));
            far = far.min(l.max(h));
        }
        if let Some(off) = self.off_axis(from) {
            let along = V::new(1.0 / inverse.x, 1.0 / inverse.y, 0.0);
            let (a, b) = (along.norm_squared(), off.dot(&along));
            let beyond = off.norm_squared() - self.radius().powi(2);
            let square = b * b - a * beyond;
            if square < 0.0 || (a == 0.0 && beyond > 0.0) {
                return None;
            }
            if a > 0.0 {
                near = near.max((-b - square.sqrt()) / a);
                far = far.min((-b + square.sqrt()) / a);
            }
        }
        (near < far).then_some([near, far])
    }

    /// The first point at which a ray enters the liquid, or, from inside, leaves it.
    pub fn hit(&self, from: &V, along: &V, is_inside: bool) -> Option<Hit> {
        let found = self.find(from, along, is_inside)?;
        Some(match found {
            Found::Side(t) => self.side(from, along, t),
            Found::Between(ends) => self.root(from, along, ends),
        })
    }

    /// Whether a ray from outside meets the liquid.
    pub fn is_hit(&self, from: &V, along: &V) -> bool {
        self.find(from, along, false).is_some()
    }

    fn find(&self, from: &V, along: &V, is_inside: bool) -> Option<Found> {
        let inverse = along.map(|c| 1.0 / c);
        let [near, far] = self.range(from, &inverse)?;
        if self.field.axis.is_some() {
            return self.find_turned(from, along, [near, far], is_inside);
        }
        let blocks = self.blocks.as_ref()?;
        let on_this_side = |value: f32| (value > LEVEL) == is_inside;
        let start = near.max(self.offset());
        if !is_inside && near > 0.0 && !on_this_side(self.value(&(from + near * along))) {
            return Some(Found::Side(near));
        }
        let look = |t: f32| self.value(&(from + t * along));
        let (mut before, mut last) = (start, Some(look(start)));
        let mut is_off = !last.is_some_and(on_this_side);
        let mut t = start;
        let (ray, mut walk) = (Ray::new(from, along, &inverse), Walk::new());
        while t < far {
            let (end, block, next) = blocks.at(&ray, walk, t);
            walk = next;
            let end = end.min(far);
            if blocks.is_plain(block, is_inside) {
                (before, last, is_off) = (t, Some(if is_inside { 1.0 } else { 0.0 }), false);
                t = end;
                continue;
            }
            while t < end {
                t = (t + self.step).min(end);
                let (cell, _) = self.cell(&(from + t * along));
                if blocks.is_sure(cell, is_inside) {
                    (before, last, is_off) = (t, None, false);
                    continue;
                }
                let value = look(t);
                // A ray that starts just beyond the surface is on its side a step later.
                if is_off && (on_this_side(value) || t - start < 1.5 * self.step) {
                    is_off = !on_this_side(value);
                } else if !on_this_side(value) {
                    let last = last.unwrap_or_else(|| look(before));
                    return Some(Found::Between([(before, last), (t, value)]));
                }
                (before, last) = (t, Some(value));
            }
            t += 1e-4 * self.step;
        }
        is_inside.then_some(Found::Side(far))
    }

    /// The same in a field of revolution, where a ray goes as far as no surface is near.
    fn find_turned(
        &self,
        from: &V,
        along: &V,
        [near, far]: [f32; 2],
        is_inside: bool,
    ) -> Option<Found> {
        let on_this_side = |value: f32| (value > LEVEL) == is_inside;
        let look = |t: f32| {
            let p = from + t * along;
            let r = self.off_axis(&p).map_or(0.0, |off| off.norm());
            self.field.at(r, p.z, &self.inverse)
        };
        if !is_inside && near > 0.0 && !on_this_side(look(near).0) {
            return Some(Found::Side(near));
        }
        let start = near.max(self.offset());
        let (mut t, (mut last, mut free)) = (start, look(start));
        let mut is_off = !on_this_side(last);
        while t < far {
            let before = t;
            t = (t + free.max(self.step)).min(far);
            let (value, next) = look(t);
            // A ray that starts just beyond the surface is on its side a step later.
            if is_off && (on_this_side(value) || t - start < 1.5 * self.step) {
                is_off = !on_this_side(value);
            } else if !on_this_side(value) {
                return Some(Found::Between([(before, last), (t, value)]));
            }
            (last, free) = (value, next);
        }
        is_inside.then_some(Found::Side(far))
    }

    fn root(&self, from: &V, along: &V, [mut a, mut b]: [(f32, f32); 2]) -> Hit {
        for _ in 0..4 {
            let part = ((LEVEL - a.1) / (b.1 - a.1)).clamp(0.05, 0.95);
            let t = a.0 + part * (b.0 - a.0);
            let value = self.value(&(from + t * along));
            if (value > LEVEL) == (a.1 > LEVEL) {
                a = (t, value);
            } else {
                b = (t, value);
            }
        }
        let part = ((LEVEL - a.1) / (b.1 - a.1)).clamp(0.0, 1.0);
        let distance = a.0 + part * (b.0 - a.0);
        let at = from + distance * along;
        Hit {
            distance,
            at,
            normal: self.normal(&at),
            is_side: false,
        }
    }

    /// A hit on the side of the box at distance `t`.
    fn side(&self, from: &V, along: &V, t: f32) -> Hit {
        let at = from + t * along;
        let mut best = (f32::MAX, V::z());
        let off = self.off_axis(&at);
        if let Some(off) = off {
            let outward = off.try_normalize(0.0).unwrap_or(V::x());
            best = ((self.radius() - off.norm()).abs(), outward);
        }
        for a in if off.is_some() { 2..3 } else { 0..3 } {
            for (plane, sign) in [(self.low[a], -1.0), (self.high[a], 1.0)] {
                let away = (at[a] - plane).abs();
                if away < best.0 {
                    best = (away, V::ith(a, sign));
                }
            }
        }
        Hit {
            distance: t,
            at,
            normal: best.1,
            is_side: true,
        }
    }
}
