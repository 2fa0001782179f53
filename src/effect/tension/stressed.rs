//! The particles with a stress: the sources of the force.

use crate::effect::surface::Surface;
use crate::space::lane::WIDTH;
use crate::space::mirror::{Code, sign, sign_of_tensor};
use crate::space::row::Sources;
use crate::space::sweep::{Field, Source};

/// Images of particles with a stress, along cells.
#[derive(Default)]
pub struct Images {
    /// First of each cell, and the number of all; empty without mirror planes.
    start: Vec<u32>,
    /// Which stressed particle each is of, and how it is reflected.
    source: Vec<u32>,
    code: Vec<Code>,
}

impl Images {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        4 * self.start.capacity() + 5 * self.source.capacity()
    }
}

/// The particles with a stress, along cells.
#[derive(Default)]
pub struct Stressed {
    /// First of each cell, and the number of all.
    pub start: Vec<u32>,
    /// Their indices.
    pub index: Vec<u32>,
    /// Of the particles, then of their images.
    pub at: [Vec<i32>; 3],
    pub u: [Vec<f32>; 3],
    /// T / rho^2: xx, yy, zz, yz, xz, xy; kept by [`super::level`] only.
    pub stress: [Vec<f32>; 6],
    pub images: Images,
}

impl Stressed {
    /// The particles and, if there are mirror planes, their images.
    pub fn sources(&self) -> Sources<'_> {
        let own = Source {
            start: &self.start,
            offset: 0,
        };
        let images = Source {
            start: &self.images.start,
            offset: self.index.len(),
        };
        let kinds = 1 + usize::from(!self.images.start.is_empty());
        Sources::of(&[own, images][..kinds])
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

    /// Picks those whose `root` is not zero.
    pub fn gather(&mut self, flow: &Surface, root: &[Vec<f32>; 3]) {
        (0..3).for_each(|a| {
            self.at[a].clear();
            self.u[a].clear();
        });
        self.start.clear();
        self.index.clear();
        let cells = &flow.liquid.start;
        for i in 0..flow.density.len() {
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
        self.gather_images(flow, root);
        let count = self.at[0].len();
        for a in 0..3 {
            self.at[a].resize(count + WIDTH, 0);
            self.u[a].resize(count + WIDTH, 0.0);
        }
    }

    /// Appends the images of those that were picked.
    fn gather_images(&mut self, flow: &Surface, root: &[Vec<f32>; 3]) {
        let Some(mirror) = flow.mirror else {
            return;
        };
        let images = &mut self.images;
        images.start.clear();
        images.source.clear();
        images.code.clear();
        let cells = &mirror.liquid.cells.start;
        for k in 0..mirror.liquid.len() {
            let i = mirror.liquid.source[k];
            if root.iter().all(|u| u[i as usize] == 0.0) {
                continue;
            }
            // As for the particles.
            let count = images.source.len() as u32;
            while cells[images.start.len()] as usize <= k {
                images.start.push(count);
            }
            let code = mirror.liquid.code[k];
            images
                .source
                .push(self.index.partition_point(|j| *j < i) as u32);
            images.code.push(code);
            for a in 0..3 {
                self.at[a].push(flow.at[a][mirror.first + k]);
                self.u[a].push(sign(code, a) * root[a][i as usize]);
            }
        }
        images.start.resize(cells.len(), images.source.len() as u32);
    }

    /// The stress of the images from that of the particles.
    pub fn turn_stress(&mut self) {
        let (images, own) = (&self.images, self.index.len());
        for (c, stress) in self.stress.iter_mut().enumerate() {
            for (k, (&source, &code)) in images.source.iter().zip(&images.code).enumerate() {
                stress[own + k] = sign_of_tensor(code, c) * stress[source as usize];
            }
        }
    }
}
