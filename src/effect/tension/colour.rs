//! The normalised colour, (1)-(3) of [`super`].

use super::Tension;
use super::pass::{Colour, Difference, Volume};
use crate::effect::surface::Surface;
use crate::kernel::Kernel;
use crate::space::parallel::each_mut;
use crate::space::row::Search;
use crate::space::sweep::Pass;
use std::array::from_ref;
use std::marker::PhantomData;

/// Depth in H to which (1)-(3) are summed. Volumes differ from m / rho to 2 H, as the support of
/// the kernel is; colours from 1 by 2e-5 at 2.6 H, and (4) takes normals to 2.1 H, both under a
/// flat surface on a lattice.
const DEEP: f64 = 2.9;

impl Tension {
    /// (1)-(3): volumes, then colours, then normals, of the same particles: those that were near a
    /// surface at the last sort. Deeper volumes are m / rho and deeper colours 1.
    pub(super) fn colour<K: Kernel>(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool + Sync,
    ) {
        if self.kept_of != flow.sorted {
            self.kept_of = flow.sorted;
            self.keep(flow, is_surface);
        }
        self.kept.place(flow.at);
        // A wall particle has the bulk's volume, and colour 1.
        self.payload[0].fill((flow.mass / self.density) as f32);
        each_mut(&mut self.payload[0][..flow.density.len()], |i, volumes| {
            *volumes = (flow.mass / flow.density[i]) as f32;
        });
        flow.share(&mut self.payload[0]);
        self.payload[1].fill(1.0);
        let norm = K::norm(self.dimension) / self.length.powi(self.dimension as i32);
        self.sum_scalar(flow, &[], &Volume::<K>(PhantomData));
        self.set(flow, 0, |sum| (1.0 / (norm * sum as f64)) as f32);
        let [volumes, colours, rest] = std::mem::take(&mut self.payload);
        self.sum_scalar(flow, from_ref(&volumes), &Colour::<K>(PhantomData));
        self.payload = [volumes, colours, rest];
        self.set(flow, 1, |sum| (norm * sum as f64) as f32);
        let [volumes, colours, rest] = std::mem::take(&mut self.payload);
        let mut normals = std::mem::take(&mut self.normals);
        self.sum(
            flow,
            from_ref(&colours),
            &Difference::<K>(PhantomData),
            &mut normals,
        );
        self.normals = normals;
        self.payload = [volumes, colours, rest];
    }

    /// Rows of the particles near a surface, until the next sort.
    fn keep(&mut self, flow: &Surface, is_surface: impl Fn(usize) -> bool + Sync) {
        let support = self.support();
        let search = Search {
            grid: flow.grid,
            at: flow.at,
            sources: flow.sources,
            cutoff: support + flow.extra.most,
            each: &[],
        };
        let (band, deep) = (&mut self.band, DEEP * self.length);
        let cutoff = |i: usize| support + flow.extra.of(i);
        self.kept.build(search, flow.position, cutoff, |targets| {
            band.mark(flow.liquid, is_surface);
            band.grow(flow.grid, deep);
            band.members(flow.grid, flow.liquid, targets);
        });
        self.near.clear();
        self.near.extend_from_slice(self.kept.targets());
    }

    /// Sums over kept rows into `scalars`.
    fn sum_scalar<const W: usize, P: Pass<1, Out = f32>>(
        &mut self,
        flow: &Surface,
        payload: &[Vec<f32>; W],
        pass: &P,
    ) {
        let mut sums = std::mem::take(&mut self.scalars);
        self.sum(flow, payload, pass, &mut sums);
        self.scalars = sums;
    }

    /// Sums over kept rows.
    fn sum<const N: usize, const W: usize, P: Pass<N>>(
        &mut self,
        flow: &Surface,
        payload: &[Vec<f32>; W],
        pass: &P,
        out: &mut Vec<P::Out>,
    ) where
        P::Out: Clone + Default,
    {
        out.resize(self.near.len(), P::Out::default());
        let field = flow.about(flow.position, flow.sources, payload, self.length);
        self.kept.sum(field, pass, out);
    }

    /// Sets a word of the particles near a surface from `scalars`, and of their images.
    fn set(&mut self, flow: &Surface, word: usize, of: impl Fn(f32) -> f32 + Sync) {
        let words = &mut self.payload[word];
        for (i, sum) in self.near.iter().zip(&self.scalars) {
            words[*i as usize] = of(*sum);
        }
        flow.share(&mut self.payload[word]);
    }
}
