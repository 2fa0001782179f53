//! The key light on the floor: shadows, and what the liquid gathers and scatters.

use rayon::prelude::*;

use super::Material;
use super::optics;
use super::trace::{Tracer, V};
use crate::draw::surface::LEVEL;

/// Texels along an edge of the map.
const TEXELS: usize = 640;
/// Rays along an edge of the beam.
const RAYS: usize = 640;
/// Part of the light that a block of clear liquid takes from the floor beside it.
const SHADE: f32 = 0.35;

/// Part of the key light that reaches each point of the floor.
pub struct Lit {
    map: Vec<f32>,
    /// Corner of the map and size of a texel, m.
    corner: [f32; 2],
    texel: f32,
}

impl Lit {
    /// Sends a beam through the liquid: what it would have lit without the liquid is taken away,
    /// and what arrives is added.
    pub fn new(tracer: &Tracer, key: V, floor: f32, material: &Material) -> Lit {
        let [low, high] = tracer.corners();
        let (centre, size) = (0.5 * (low + high), high - low);
        let radius = 0.5 * size.max();
        let mut lit = Lit {
            map: vec![1.0; TEXELS * TEXELS],
            corner: [centre.x - 3.0 * radius, centre.y - 3.0 * radius],
            texel: 6.0 * radius / TEXELS as f32,
        };
        let is_clear = material.absorption().is_some();
        let is_block = tracer.value(&V::new(low.x, low.y, floor)) > LEVEL;
        // The beam covers the shadow of the box.
        let reach = (high.z - floor) / key.z;
        let start = [0, 1].map(|a| low[a] - (key[a] * reach).max(0.0));
        let end = [0, 1].map(|a| high[a] - (key[a] * reach).min(0.0));
        let cell = [0, 1].map(|a| (end[a] - start[a]) / RAYS as f32);
        let energy = cell[0] * cell[1] / (lit.texel * lit.texel);
        let ray = |i: usize, j: usize, found: &mut Vec<([f32; 2], f32)>| {
            let at = [i, j].map(|n| n as f32 + 0.5);
            let target = [0, 1].map(|a| start[a] + at[a] * cell[a]);
            let from = V::new(target[0], target[1], floor) + key * (1.5 * reach + radius);
            if !is_clear {
                // Where light meets what is opaque is no matter.
                if tracer.is_hit(&from, &-key) {
                    found.push((target, -energy));
                }
                return;
            }
            let Some(hit) = tracer.hit(&from, &-key, false) else {
                return;
            };
            let is_under = tracer.is_within(&V::new(target[0], target[1], low.z));
            let is_beside = is_block && !is_under;
            found.push((target, -energy * if is_beside { SHADE } else { 1.0 }));
            if !hit.is_side {
                let arrival = optics::arrival(tracer, -key, hit, floor);
                found.extend(arrival.map(|(at, light)| ([at.x, at.y], light * energy)));
            }
        };
        let rows: Vec<_> = (0..RAYS)
            .into_par_iter()
            .map(|i| {
                let mut found = Vec::new();
                (0..RAYS).for_each(|j| ray(i, j, &mut found));
                found
            })
            .collect();
        rows.into_iter()
            .flatten()
            .for_each(|(at, light)| lit.add(at, light));
        let width = 0.014 * radius / lit.texel;
        let passes = (width * width).ceil() as usize;
        (0..passes.clamp(1, 12)).for_each(|_| lit.blur());
        lit
    }

    /// Place on the map, in texels.
    fn place(&self, at: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|a| (at[a] - self.corner[a]) / self.texel - 0.5)
    }

    /// At a point of the floor.
    pub fn at(&self, at: &V) -> f32 {
        let place = self.place([at.x, at.y]);
        let last = (TEXELS - 1) as f32;
        if place.iter().any(|p| !(*p >= 0.0 && *p < last)) {
            return 1.0;
        }
        let [i, j] = place.map(|p| p as usize);
        let (x, y) = (place[0] - i as f32, place[1] - j as f32);
        let row = |i: usize| {
            let row = &self.map[i * TEXELS + j..];
            row[0] + y * (row[1] - row[0])
        };
        row(i) + x * (row(i + 1) - row(i))
    }

    fn add(&mut self, at: [f32; 2], light: f32) {
        let place = self.place(at);
        let cell = place.map(f32::floor);
        for (i, j) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
            let (x, y) = (cell[0] + i, cell[1] + j);
            let weight = (1.0 - (place[0] - x).abs()) * (1.0 - (place[1] - y).abs());
            if x >= 0.0 && y >= 0.0 && x < TEXELS as f32 && y < TEXELS as f32 {
                self.map[x as usize * TEXELS + y as usize] += light * weight;
            }
        }
    }

    /// Means over three by three texels, weights 1 2 1: a lamp has a size.
    fn blur(&mut self) {
        for stride in [1, TEXELS] {
            let old = self.map.clone();
            let new = self.map.par_iter_mut().enumerate();
            new.for_each(|(i, value)| {
                let before = old[i.saturating_sub(stride)];
                let after = old[(i + stride).min(old.len() - 1)];
                *value = (before + old[i] * 2.0 + after) * 0.25;
            });
        }
    }
}
