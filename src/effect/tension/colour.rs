//! The normalised colour, (1)-(3) of [`super`].

use super::pass::{Colour, Difference, Volume};
use super::{Surface, Tension};
use crate::kernel::Kernel;
use std::array::from_ref;
use std::marker::PhantomData;

/// Depths in H. Volumes differ from the bulk's to 2 H, colours from 1 to 4 H, and (4) takes normals
/// to 2.6 H on a lattice.
const NORMALS: f64 = 3.0;
const COLOURS: f64 = 4.0;
const VOLUMES: f64 = 6.0;

impl Tension {
    /// (1)-(3): volumes, then colour, then normals, each in a narrower band.
    pub(super) fn colour<K: Kernel>(&mut self, flow: &Surface) {
        let d = self.dimension as i32;
        let norm = K::norm(self.dimension) / self.length.powi(d);
        // A wall particle far inside a wetted wall has the bulk's volume, and colour 1, as has
        // liquid far from a surface.
        let bulk = (flow.mass / self.density) as f32;
        self.payload[0].fill(bulk);
        self.payload[1].fill(1.0);
        self.nest(flow);
        let wider = std::mem::take(&mut self.wider);
        for (stage, band) in wider.iter().enumerate() {
            let mut sums = std::mem::take(&mut self.scalars);
            sums.resize(band.len(), 0.0);
            if stage == 0 {
                self.runs(flow, &[], (band, &Volume::<K>(PhantomData)), &mut sums);
            } else {
                let volumes = from_ref(&self.payload[0]);
                self.runs(flow, volumes, (band, &Colour::<K>(PhantomData)), &mut sums);
            }
            for (&i, &sum) in band.iter().zip(&sums) {
                let i = i as usize;
                if stage == 0 {
                    self.payload[0][i] = (1.0 / (norm * sum as f64)) as f32;
                } else {
                    self.payload[1][i] = (norm * sum as f64) as f32;
                }
            }
            flow.share(&mut self.payload[stage]);
            self.scalars = sums;
        }
        self.wider = wider;
        let colours = std::mem::take(&mut self.payload[1]);
        self.sum_normals(flow, from_ref(&colours), &Difference::<K>(PhantomData));
        self.payload[1] = colours;
    }

    /// Particles near a surface: of normals, of the colours that differ from 1 but by disorder, and
    /// of the volumes that those see.
    fn nest(&mut self, flow: &Surface) {
        let [volumes, colours] = &mut self.wider;
        let bands = [
            (NORMALS, &mut self.near),
            (COLOURS, colours),
            (VOLUMES, volumes),
        ];
        let mut before = 0.0;
        for (depth, members) in bands {
            let slack = if before == 0.0 { flow.slack } else { 0.0 };
            self.band
                .grow(flow.grid, (depth - before) * self.length + slack);
            self.band.members(flow.grid, flow.liquid, members);
            before = depth;
        }
    }
}
