//! Surface tension from a colour function, in two forms.
//!
//! `NormalisedColour`, the surface stress of Nishio et al. (2010):
//! (1) rho_a^H = SUM m W^H                          long kernel, H = 1.5 h
//! (2) c_a = SUM m / rho_b^H W^H                    Eq. 11
//! (3) n_a = SUM m / rho_a^h (c_b - c_a) grad W^H   Eq. 12; the kernel is W^H
//! (4) T = alpha sigma |n| (I - nn/|n|^2), 0 for |n| <= 0.01 / H   Eqs. 10, 13
//! (5) a_s = SUM m (T_a / (rho_a^H)^2 + T_b / (rho_b^H)^2) . grad W^H   Eq. 9
//!
//! `RawColour`: the same with
//! (6) n_a = SUM m / rho0 grad W^H,  T = alpha sigma H (|n|^2 - (0.05/H)^2) (I - nn/|n|^2),  rho0
//! for the densities in (5)
//! (the stress of a colour-gradient energy, as in Kuri et al., Eq. 7): smooth where n vanishes.
//!
//! Only liquid within the reach of a surface is looked at. On a lattice the force ends at a depth
//! of 3.3 H (raw colour) or 4.6 H (normalised: volumes, colours and normals reach 2 H each, and (4)
//! ignores what is left). Wall particles count as liquid in n, so that a wetted wall is no surface.
//!
//! The liquid is one-sided, so alpha is not 1: it is calibrated by the virial of the pair forces,
//! sigma_eff A_s = -(W_tangential / (d-1) - W_normal), into which an isotropic pressure does not
//! enter; A_s is the area of the surface of tension (method::calibrate).
//! Time step: 0.25 sqrt(rho h^3 / (2 pi sigma)). Fails where a sheet is thinner than 2 H; where R
//! is not much larger than H (the stress acts at a depth of 0.65 H); and where H is below 2.6 s0:
//! the stress derives from no energy, its pull along the surface bunches the particles, and a drop
//! at rest stirs by itself (docs/validation.md).
//! Tests: tests/engine/effect_tension.rs, tests/validation/drop.rs.

mod pass;

use super::band::Band;
use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::scene::{KernelName, TensionForm};
use crate::space::grid::Grid;
use crate::space::lane::Record;
use crate::space::parallel::{Slots, each};
use crate::space::sort::Cells;
use crate::space::sweep::{self, Field, Pass};
use pass::{Colour, Difference, Gradient, Summed, Virial, Volume};
use rayon::prelude::*;
use std::marker::PhantomData;

/// Below |n| H = this there is no surface (Nishio Eq. 13).
const EPSILON: f64 = 0.01;

/// The same for the raw colour, where |n| H reaches 0.3 at a flat surface and disorder gives 0.02:
/// the stress starts at zero here, so that the inside of the liquid has none.
const FAINT: f64 = 0.05;

/// What the effect reads of a flow.
pub struct Surface<'a> {
    pub grid: &'a Grid,
    pub liquid: &'a Cells,
    /// Wall cells and the index of the first wall record, if there is a wall.
    pub wall: Option<(&'a Cells, usize)>,
    pub position: &'a [Vec<f64>; 3],
    pub density: &'a [f64],
    pub mass: f64,
    /// What two particles may have approached since the sort, m.
    pub slack: f64,
}

/// The effect with its scratch memory.
pub struct Tension {
    pub form: TensionForm,
    pub kernel: KernelName,
    /// H, m.
    pub length: f64,
    /// sigma, N/m.
    pub coefficient: f64,
    /// alpha.
    pub strength: f64,
    pub dimension: usize,
    /// rho0, kg/m^3.
    pub density: f64,
    band: Band,
    near: Vec<u32>,
    reached: Vec<u32>,
    /// Particles whose volumes, then whose colours are needed.
    wider: [Vec<u32>; 2],
    vectors: Vec<[f32; 3]>,
    scalars: Vec<f32>,
    /// Acceleration of `reached`, m/s^2.
    force: Vec<[f32; 3]>,
}

impl Tension {
    pub fn new(
        form: TensionForm,
        kernel: KernelName,
        length: f64,
        coefficient: f64,
        strength: f64,
        dimension: usize,
        density: f64,
    ) -> Self {
        Tension {
            form,
            kernel,
            length,
            coefficient,
            strength,
            dimension,
            density,
            band: Band::default(),
            near: Vec::new(),
            reached: Vec::new(),
            wider: Default::default(),
            vectors: Vec::new(),
            scalars: Vec::new(),
            force: Vec::new(),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let [volumes, colours] = &self.wider;
        let indices = [&self.near, &self.reached, volumes, colours];
        4 * indices.iter().map(|list| list.capacity()).sum::<usize>()
            + 12 * (self.vectors.capacity() + self.force.capacity())
            + 4 * self.scalars.capacity()
            + self.band.memory()
    }

    /// Support radius 2 H, m.
    pub fn support(&self) -> f64 {
        2.0 * self.length
    }

    /// Evaluates a_s near the surface. `records`: positions current; payloads are overwritten with
    /// the root of the stress, u = sqrt(|T|) n / |n| / rho, zero elsewhere.
    pub fn update(
        &mut self,
        flow: &Surface,
        records: &mut [Record],
        is_surface: &(dyn Fn(usize) -> bool + Sync),
    ) {
        match self.kernel {
            KernelName::CubicSpline => self.update_with::<CubicSpline>(flow, records, is_surface),
            KernelName::WendlandC2 => self.update_with::<WendlandC2>(flow, records, is_surface),
        }
    }

    fn update_with<K: Kernel>(
        &mut self,
        flow: &Surface,
        records: &mut [Record],
        is_surface: &(dyn Fn(usize) -> bool + Sync),
    ) {
        let reach = self.support() + flow.slack;
        self.band.mark(flow.liquid, is_surface);
        match self.form {
            TensionForm::RawColour => {
                self.band.grow(flow.grid, reach);
                self.band.members(flow.liquid, &mut self.near);
                self.sweep(flow, records, &Gradient::<K>(PhantomData));
            }
            TensionForm::NormalisedColour => self.colour::<K>(flow, records, reach),
        }
        self.root::<K>(flow, records);
        let stressed = |i: usize| records[i].0[3..6] != [0; 3];
        self.band.mark(flow.liquid, &stressed);
        self.band.grow(flow.grid, reach);
        self.band.members(flow.liquid, &mut self.reached);
        let mut force = std::mem::take(&mut self.force);
        force.resize(self.reached.len(), [0.0; 3]);
        let factor = self.force_factor::<K>(flow.mass);
        let pass = Summed::<K> {
            factor,
            kernel: PhantomData,
        };
        self.runs(flow, records, &self.reached, &pass, &mut force);
        self.force = force;
    }

    /// What turns a sum of pair terms into an acceleration, and d x it into a virial.
    fn force_factor<K: Kernel>(&self, mass: f64) -> f64 {
        mass * K::norm(self.dimension) / self.length.powi(self.dimension as i32 + 1)
    }

    /// Adds the accelerations to `into`, indexed by liquid particle.
    pub fn add(&self, into: &mut [[f32; 3]]) {
        let into = Slots::new(into);
        each(self.reached.len(), |k| {
            let a = unsafe { into.at(self.reached[k] as usize) };
            (0..3).for_each(|c| a[c] += self.force[k][c]);
        });
    }

    /// sigma_eff A, J (N in 2-D), of the last update; `records` as it left them.
    pub fn virial(&self, flow: &Surface, records: &[Record]) -> f64 {
        self.virial_moment(flow, records, &|_| 1.0)
    }

    /// The same with the share of every particle times `weight`.
    pub fn virial_moment(
        &self,
        flow: &Surface,
        records: &[Record],
        weight: &dyn Fn(usize) -> f64,
    ) -> f64 {
        match self.kernel {
            KernelName::CubicSpline => self.virial_with::<CubicSpline>(flow, records, weight),
            KernelName::WendlandC2 => self.virial_with::<WendlandC2>(flow, records, weight),
        }
    }

    fn virial_with<K: Kernel>(
        &self,
        flow: &Surface,
        records: &[Record],
        weight: &dyn Fn(usize) -> f64,
    ) -> f64 {
        let mut parts = vec![0.0f64; self.reached.len()];
        let scale = 1.0 / (self.dimension as f32 - 1.0);
        let pass = Virial::<K> {
            scale,
            kernel: PhantomData,
        };
        self.runs(flow, records, &self.reached, &pass, &mut parts);
        let share = |(part, &i): (&f64, &u32)| part * weight(i as usize);
        let sum: f64 = parts.iter().zip(&self.reached).map(share).sum();
        -0.5 * flow.mass * self.length * self.force_factor::<K>(flow.mass) * sum
    }

    fn runs<const N: usize, P: Pass<N>>(
        &self,
        flow: &Surface,
        records: &[Record],
        targets: &[u32],
        pass: &P,
        out: &mut [P::Out],
    ) {
        let liquid = sweep::Source {
            cells: flow.liquid,
            offset: 0,
        };
        let wall = flow
            .wall
            .map(|(cells, offset)| sweep::Source { cells, offset });
        let both = [liquid, wall.unwrap_or(liquid)];
        let field = Field {
            grid: flow.grid,
            records,
            sources: if wall.is_some() { &both } else { &both[..1] },
            position: flow.position,
            cutoff: self.support() + flow.slack,
            scale: flow.grid.scale(self.length),
        };
        sweep::runs(field, targets, pass, out);
    }

    fn sweep<P: Pass<3, Out = [f32; 3]>>(&mut self, flow: &Surface, records: &[Record], pass: &P) {
        let mut vectors = std::mem::take(&mut self.vectors);
        vectors.resize(self.near.len(), [0.0; 3]);
        self.runs(flow, records, &self.near, pass, &mut vectors);
        self.vectors = vectors;
    }

    /// (1)-(3): volumes, then colour, then normals, each in a narrower band.
    fn colour<K: Kernel>(&mut self, flow: &Surface, records: &mut [Record], reach: f64) {
        let d = self.dimension as i32;
        let norm = K::norm(self.dimension) / self.length.powi(d);
        let own = K::w(0.0) as f32;
        let wall = flow.wall.map_or(records.len(), |(_, offset)| offset);
        // A wall particle far inside a wetted wall has the bulk's volume.
        let bulk = (flow.mass / self.density) as f32;
        for (i, record) in records.iter_mut().enumerate() {
            let [x, y, z] = [record.at(0), record.at(1), record.at(2)];
            let colour = if i >= wall { 1.0 } else { 0.0 };
            *record = Record::new([x, y, z], [0.0, bulk, colour, 0.0, 0.0]);
        }
        self.nest(flow, reach);
        let wider = std::mem::take(&mut self.wider);
        for (stage, band) in wider.iter().enumerate() {
            let mut sums = std::mem::take(&mut self.scalars);
            sums.resize(band.len(), 0.0);
            if stage == 0 {
                self.runs(flow, records, band, &Volume::<K>(PhantomData), &mut sums);
            } else {
                self.runs(flow, records, band, &Colour::<K>(PhantomData), &mut sums);
            }
            for (&i, &sum) in band.iter().zip(&sums) {
                let r = &mut records[i as usize];
                let at = [r.at(0), r.at(1), r.at(2)];
                let volume = if stage == 0 {
                    (1.0 / (norm * (sum + own) as f64)) as f32
                } else {
                    r.payload(1)
                };
                let colour = if stage == 1 {
                    (norm * (sum + own * volume) as f64) as f32
                } else {
                    0.0
                };
                *r = Record::new(at, [0.0, volume, colour, 0.0, 0.0]);
            }
            self.scalars = sums;
        }
        self.wider = wider;
        self.sweep(flow, records, &Difference::<K>(PhantomData));
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

    /// (4): makes u of the normals of `near` and writes it into the records, zero elsewhere.
    fn root<K: Kernel>(&mut self, flow: &Surface, records: &mut [Record]) {
        let d = self.dimension as i32;
        let gradient = K::norm(self.dimension) / self.length.powi(d + 1);
        let raw = self.form == TensionForm::RawColour;
        let tension = self.strength * self.coefficient;
        let epsilon = if raw { FAINT } else { EPSILON } / self.length;
        let (density, length) = (self.density, self.length);
        self.vectors
            .par_iter_mut()
            .zip(&self.near)
            .for_each(|(v, &i)| {
                let i = i as usize;
                let (volume, rho) = if raw {
                    (flow.mass / density, density)
                } else {
                    (
                        flow.mass / flow.density[i],
                        flow.mass / records[i].payload(1) as f64,
                    )
                };
                let n = v.map(|v| gradient * volume * v as f64);
                let size = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
                if size <= epsilon {
                    *v = [0.0; 3];
                    return;
                }
                let squared = if raw {
                    (size * size - epsilon * epsilon) * length
                } else {
                    size
                };
                let u = (tension * squared).sqrt() / rho / size;
                *v = n.map(|n| (u * n) as f32);
            });
        records
            .par_iter_mut()
            .for_each(|record| record.0[3..].fill(0));
        for (&i, u) in self.near.iter().zip(&self.vectors) {
            let r = &mut records[i as usize];
            *r = Record::new([r.at(0), r.at(1), r.at(2)], [u[0], u[1], u[2], 0.0, 0.0]);
        }
    }
}
