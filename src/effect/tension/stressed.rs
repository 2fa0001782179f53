//! The particles with a stress: the sources of the force.

use super::Surface;
use crate::space::lane::WIDTH;
use crate::space::sweep::{Field, Source};

/// The particles with a stress, along cells.
#[derive(Default)]
pub struct Stressed {
    /// First of each cell, and the number of all.
    pub start: Vec<u32>,
    /// Their indices.
    pub index: Vec<u32>,
    pub at: [Vec<i32>; 3],
    pub u: [Vec<f32>; 3],
    /// T / rho^2: xx, yy, zz, yz, xz, xy; kept by [`super::level`] only.
    pub stress: [Vec<f32>; 6],
}

impl Stressed {
    pub fn source(&self) -> Source<'_> {
        Source {
            start: &self.start,
            offset: 0,
        }
    }

    /// `field` with these particles and a payload of theirs for sources.
    pub fn field<'a, const W: usize>(
        &'a self,
        field: Field<'a>,
        sources: &'a [Source<'a>],
        payload: &'a [Vec<f32>; W],
    ) -> Field<'a, W> {
        field.among(&self.at, payload, sources)
    }

    /// Picks those of `near` (in cell order) whose `root` is not zero.
    pub fn gather(&mut self, flow: &Surface, near: &[u32], root: &[Vec<f32>; 3]) {
        (0..3).for_each(|a| {
            self.at[a].clear();
            self.u[a].clear();
        });
        self.start.clear();
        self.index.clear();
        let cells = &flow.liquid.start;
        for &i in near {
            let i = i as usize;
            if root.iter().all(|u| u[i] == 0.0) {
                continue;
            }
            // Cells up to and with the particle's begin no later than here.
            let count = self.at[0].len() as u32;
            while cells[self.start.len()] as usize <= i {
                self.start.push(count);
            }
            self.index.push(i as u32);
            for a in 0..3 {
                self.at[a].push(flow.at[a][i]);
                self.u[a].push(root[a][i]);
            }
        }
        let count = self.at[0].len();
        self.start.resize(cells.len(), count as u32);
        for a in 0..3 {
            self.at[a].resize(count + WIDTH, 0);
            self.u[a].resize(count + WIDTH, 0.0);
        }
    }
}
