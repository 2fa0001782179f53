//! The normalised colour, (1)-(3) of [`super`].

use super::pass::{Colour, Difference};
use super::{Surface, Tension};
use crate::kernel::Kernel;
use std::marker::PhantomData;

impl Tension {
    /// (1)-(3): volumes, then colour, then normals, each in a narrower band.
    pub(super) fn colour<K: Kernel>(&mut self, flow: &Surface, reach: f64) {
        let d = self.dimension as i32;
        let norm = K::norm(self.dimension) / self.length.powi(d);
        let own = K::w(0.0) as f32;
        // A wall particle far inside a wetted wall has the bulk's volume, and colour 1.
        let bulk = (flow.mass / self.density) as f32;
        self.payload[0].fill(1.0);
        self.payload[1][flow.density.len()..].fill(1.0);
        self.nest(flow, reach);
        let wider = std::mem::take(&mut self.wider);
        for (stage, band) in wider.iter().enumerate() {
            let mut sums = std::mem::take(&mut self.scalars);
            sums.resize(band.len(), 0.0);
            self.runs(flow, band, &Colour::<K>(PhantomData), &mut sums);
            if stage == 0 {
                self.payload[0].fill(bulk);
            }
            for (&i, &sum) in band.iter().zip(&sums) {
                let i = i as usize;
                if stage == 0 {
                    self.payload[0][i] = (1.0 / (norm * (sum + own) as f64)) as f32;
                } else {
                    let c = norm * (sum + own * self.payload[0][i]) as f64;
                    self.payload[1][i] = c as f32;
                }
            }
            flow.share(&mut self.payload[stage]);
            self.scalars = sums;
        }
        self.wider = wider;
        self.sum_normals(flow, &Difference::<K>(PhantomData));
    }

    /// Particles within 4, 3 and 2 reaches of the surface.
    fn nest(&mut self, flow: &Surface, reach: f64) {
        let [volumes, colours] = &mut self.wider;
        let bands = [(2.0, &mut self.near), (1.0, colours), (1.0, volumes)];
        for (times, members) in bands {
            self.band.grow(flow.grid, times * reach);
            self.band.members(flow.liquid, members);
        }
    }
}
