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
//! `CahnHilliard`, Kuri et al., Eqs. 1, 5-7 (after Anderson & McFadden 1998), H = 2.5 h:
//! (7) phi = SUM m / rho0 W^H (Eq. 6 without dimension), S = kappa (|grad phi|^2 I - grad phi grad
//!     phi), kappa = alpha sigma H, a_s = SUM m (S_a / rho_a^2 + S_b / rho_b^2) . grad W^h
//! with the short kernel and its densities, as printed. Flat: kappa = sigma / INT |grad phi|^2 dn
//! over the liquid's side of a flat interface (`select::flat_strength`): alpha = 3.96 for the cubic
//! spline in 3-D. On a lattice of that spline the force it gives is 16 to 24 % too strong.
//!
//! Only liquid within the reach of a surface is looked at: on a lattice the force ends at a depth
//! of 3.3 H (raw colour) or 4.6 H (normalised: (4) ignores normals below 2.6 H). The stress of (6)
//! ends where |n| H = 0.05, 1.2 H under a flat surface, so n is summed to 1.5 H only. The own part
//! of (5), T_a . SUM grad W, needs no sum over pairs of its own; in (6) it vanishes, for there SUM
//! grad W is along n and T . n = 0. What is left runs over the stressed particles alone. Wall
//! particles count as liquid in n: a wetted wall is no surface.
//!
//! The liquid is one-sided, so alpha is not 1: it is calibrated by the virial of the pair forces or
//! by the pressure that they leave in a round body (method::calibrate). The stress acts below the
//! surface, and [`level`] carries it there.
//! Time step: 0.25 sqrt(rho h^3 / (2 pi sigma)). Fails where a sheet is thinner than 2 H; where R
//! is not much larger than H (the stress acts at a depth of 0.46 H); and where H is below 2.6 s0:
//! the stress derives from no energy, its pull along the surface bunches the particles, and a drop
//! at rest has spurious currents (docs/results/validation.md).
//! With [`super::wetting`] walls have a contact angle. Curvature times normal: [`counted`].
//! The derivative of an energy: [`energy`].
//! Tests: tests/engine/effect_tension.rs, tests/validation/drop.rs.

mod account;
mod colour;
mod contract;
pub mod counted;
pub mod energy;
pub mod level;

pub mod pass;
pub mod ringed;
pub mod shore;
mod stressed;
mod virial;
mod walled;

use super::band::Band;
use super::normal::Gradient;
use super::surface::Surface;
use super::wetting::Wetting;
use super::wetting::typed::Typed;
use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::scene::{KernelName, TensionForm};
use crate::space::parallel::each_mut;
use crate::space::ranks::span::Span;
use crate::space::sweep::{self, Field, Kept, Pass};
use counted::Counted;
use energy::Energy;
use pass::{Summed, Tensor, Whole};
use std::marker::PhantomData;
use stressed::Stressed;

/// Below |n| H = this there is no surface (Nishio Eq. 13).
const EPSILON: f64 = 0.01;

/// The same for the raw colour, where |n| H reaches 0.3 at a flat surface and disorder gives 0.02:
/// the stress starts at zero here, so that the inside of the liquid has none.
const FAINT: f64 = 0.05;

/// Depth under a flat surface, in H, to which n of (6) is summed: |n| H is 0.007 there (Wendland
/// C2), so that a surface five times as dense with liquid in reach is still served.
const DEEP: f64 = 1.5;

/// The effect with its scratch memory.
pub struct Tension {
    /// Which of the forces above.
    pub form: TensionForm,
    /// Kernel of all sums.
    pub kernel: KernelName,
    /// H, m.
    pub length: f64,
    /// Smoothing length of the force: H, or h in (7), m.
    pub force_length: f64,
    /// sigma, N/m.
    pub coefficient: f64,
    /// alpha.
    pub strength: f64,
    /// 2 or 3.
    pub dimension: usize,
    /// rho0, kg/m^3.
    pub density: f64,
    /// Whether the tension is sigma at the surface itself ([`level`]; raw colour only).
    pub lifted: bool,
    /// With it walls have a contact angle (raw colour only).
    pub wetting: Option<Wetting>,
    /// The same by types of particles (number-density forms only).
    pub typed: Option<Typed>,
    band: Band,
    near: Vec<u32>,
    reached: Vec<u32>,
    /// The same for sums over those of all ranks.
    spans: [Span; 2],
    /// Rows of those that (1) to (3) are summed for, of this sort.
    kept: Kept,
    kept_of: u64,
    /// Per `near`: n and, for (3), SUM slope d; then u and, for (3), the own part of (5).
    normals: Vec<([f32; 3], [f32; 3])>,
    scalars: Vec<f32>,
    /// Per particle and wall particle: V and c, then u = sqrt(|T|) n / |n| / rho or zero.
    payload: [Vec<f32>; 3],
    stressed: Stressed,
    /// Per stressed particle, then per wall particle near a surface: how the surface bends.
    bends: Vec<level::Bend>,
    /// The particles at contact lines, and which of `near` they are.
    lines: Vec<u32>,
    feet: Vec<u32>,
    /// Acceleration of `reached`, m/s^2.
    force: Vec<[f32; 3]>,
    counted: Counted,
    /// Scratch memory and walls of a tension with an energy.
    pub energy: Energy,
}

impl Tension {
    /// A tension that has found nothing yet; `length`: H and `short`: h, m.
    pub fn new(
        form: TensionForm,
        kernel: KernelName,
        [length, short]: [f64; 2],
        coefficient: f64,
        strength: f64,
        dimension: usize,
        density: f64,
    ) -> Self {
        Tension {
            form,
            kernel,
            length,
            force_length: match form {
                TensionForm::CahnHilliard => short,
                _ => length,
            },
            coefficient,
            strength,
            dimension,
            density,
            lifted: false,
            wetting: None,
            typed: None,
            band: Band::default(),
            near: Vec::new(),
            reached: Vec::new(),
            spans: [0.into(), 0.into()],
            kept: Kept::default(),
            kept_of: 0,
            normals: Vec::new(),
            scalars: Vec::new(),
            payload: Default::default(),
            stressed: Stressed::default(),
            bends: Vec::new(),
            lines: Vec::new(),
            feet: Vec::new(),
            force: Vec::new(),
            counted: Counted::default(),
            energy: Energy::default(),
        }
    }

    /// The normals alone, for a method that shifts particles without tension; `length`: H, m.
    pub fn normals(kernel: KernelName, length: f64, dimension: usize, density: f64) -> Self {
        let form = TensionForm::RawColour;
        Tension::new(form, kernel, [length; 2], 0.0, 1.0, dimension, density)
    }

    /// Whether there is a force.
    pub fn pulls(&self) -> bool {
        self.coefficient > 0.0
    }

    /// Support radius 2 H, m.
    pub fn support(&self) -> f64 {
        2.0 * self.length
    }

    /// sqrt(|T|) n / |n| / rho of particle `i` as of the last update; zero far from a surface.
    #[inline(always)]
    pub fn root_of(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|a| self.payload[a][i])
    }

    /// [`Wetting::dry`].
    pub fn dry(&self) -> impl Iterator<Item = (usize, [f32; 3])> {
        self.wetting.iter().flat_map(Wetting::dry)
    }

    /// Evaluates a_s near the surface.
    pub fn update(&mut self, flow: &Surface, is_surface: impl Fn(usize) -> bool + Sync) {
        self.clear(flow);
        match self.kernel {
            KernelName::CubicSpline => self.update_with::<CubicSpline>(flow, is_surface),
            KernelName::WendlandC2 => self.update_with::<WendlandC2>(flow, is_surface),
        }
    }

    fn update_with<K: Kernel>(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool + Sync,
    ) {
        let reach = self.support() + flow.slack;
        if self.form != TensionForm::NormalisedColour {
            self.band.mark(flow.liquid, &is_surface);
            flow.join(self.band.marks());
        }
        match self.form {
            TensionForm::RawColour => {
                let deep = DEEP * self.length + flow.slack;
                self.band.grow(flow.grid, deep);
                self.band.members(flow.grid, flow.liquid, &mut self.near);
                match self.wetting {
                    None => self.sum_normals(flow, &[], &Gradient::<K>(PhantomData)),
                    Some(_) => self.wet::<K>(flow, is_surface),
                }
            }
            TensionForm::CahnHilliard => {
                self.band.grow(flow.grid, reach);
                self.band.members(flow.grid, flow.liquid, &mut self.near);
                self.sum_normals(flow, &[], &Gradient::<K>(PhantomData));
            }
            TensionForm::NormalisedColour => self.colour::<K>(flow, is_surface),
            TensionForm::SurfaceEnergy => return self.pull_by_energy::<K>(flow, is_surface),
            TensionForm::NumberDensity => return self.count::<K, true>(flow, is_surface),
            TensionForm::NumberDensityExact => return self.count::<K, false>(flow, is_surface),
        }
        self.root::<K>(flow);
        if !self.pulls() {
            return;
        }
        self.stressed.gather(flow, &self.payload);
        if self.lifted {
            self.lift::<K>(flow);
        }
        self.pull_lines::<K>(flow);
        self.band.mark_filled(&self.stressed.start);
        self.band
            .grow(flow.grid, 2.0 * self.force_length + flow.slack);
        self.band.members(flow.grid, flow.liquid, &mut self.reached);
        let mut force = std::mem::take(&mut self.force);
        force.resize(self.reached.len(), [0.0; 3]);
        let pass = Summed::<K> {
            factor: self.force_factor::<K>(flow.mass),
            kernel: PhantomData,
        };
        let field = self.field(flow, self.force_length);
        let sources = self.stressed.sources();
        if self.form == TensionForm::CahnHilliard {
            sweep::runs(field, &self.reached, &Whole(pass), &mut force);
        } else if self.lifted {
            let field = self.stressed.field(field, &sources, &self.stressed.stress);
            let field = field.owning(&[]);
            sweep::runs(field, &self.reached, &Tensor(pass), &mut force);
        } else {
            let field = self.stressed.field(field, &sources, &self.stressed.u);
            sweep::runs(field, &self.reached, &pass, &mut force);
        }
        self.add_walls(flow, &pass, &mut force);
        self.force = force;
    }

    /// What turns a sum of pair terms into an acceleration, and d x it into a virial.
    fn force_factor<K: Kernel>(&self, mass: f64) -> f64 {
        mass * K::norm(self.dimension) / self.force_length.powi(self.dimension as i32 + 1)
    }

    /// Adds the accelerations to `into`, indexed by liquid particle.
    pub fn add(&self, into: &mut [[f32; 3]]) {
        let mut give = |i: u32, force: [f32; 3]| {
            let a = &mut into[i as usize];
            (0..3).for_each(|c| a[c] += force[c]);
        };
        // Near a surface only: too few for several threads.
        let reached = self.reached.iter().zip(&self.force);
        reached.for_each(|(i, force)| give(*i, *force));
        let own = self.wetting.is_some() && self.form == TensionForm::RawColour;
        if self.form == TensionForm::NormalisedColour || own {
            let near = self.near.iter().zip(&self.normals);
            near.for_each(|(i, (_, own))| give(*i, *own));
        }
    }

    /// All particles as sources, with the current payload; `length`: smoothing length, m.
    fn field<'a>(&'a self, flow: &'a Surface, length: f64) -> Field<'a> {
        flow.about(flow.position, flow.sources, &self.payload, length)
    }

    /// Sums over all particles, with the long kernel and some of the payload.
    fn runs<const N: usize, const W: usize, P: Pass<N>>(
        &self,
        flow: &Surface,
        payload: &[Vec<f32>; W],
        (targets, span, pass): (&[u32], &Span, &P),
        out: &mut [P::Out],
    ) where
        P::Out: Copy + Default,
    {
        let field = self.field(flow, self.length).owning(payload);
        let field = field.among(flow.at, payload, flow.sources);
        sweep::runs_shared(field, span, targets, pass, out);
    }

    /// Fills `normals` by a pass over `near`.
    fn sum_normals<const N: usize, const W: usize, P: Pass<N, Out = ([f32; 3], [f32; 3])>>(
        &mut self,
        flow: &Surface,
        payload: &[Vec<f32>; W],
        pass: &P,
    ) {
        self.spans[0] = flow.list(self.near.len());
        let mut normals = std::mem::take(&mut self.normals);
        normals.resize(self.near.len(), Default::default());
        let targets = (&self.near[..], &self.spans[0], pass);
        self.runs(flow, payload, targets, &mut normals);
        self.normals = normals;
    }

    /// Zero payload for every particle.
    fn clear(&mut self, flow: &Surface) {
        for words in &mut self.payload {
            words.clear();
            words.resize(flow.at[0].len(), 0.0);
        }
    }

    /// (4): turns `normals` into u and the own part of (5), and the payload into u.
    fn root<K: Kernel>(&mut self, flow: &Surface) {
        let d = self.dimension as i32;
        let gradient = K::norm(self.dimension) / self.length.powi(d + 1);
        let raw = self.form != TensionForm::NormalisedColour;
        let printed = self.form == TensionForm::CahnHilliard;
        // Without a force the roots are normals of any length.
        let tension = if self.pulls() {
            self.strength * self.coefficient
        } else {
            1.0
        };
        let epsilon = match self.form {
            TensionForm::RawColour => FAINT / self.length,
            TensionForm::CahnHilliard => 0.0,
            _ => EPSILON / self.length,
        };
        let own_factor = self.force_factor::<K>(flow.mass);
        let volumes = &self.payload[0];
        let near = &self.near;
        each_mut(&mut self.normals[..near.len()], |k, (v, own)| {
            let i = near[k] as usize;
            let (volume, rho) = if printed {
                (flow.mass / self.density, flow.density[i])
            } else if raw {
                (flow.mass / self.density, self.density)
            } else {
                (flow.mass / flow.density[i], flow.mass / volumes[i] as f64)
            };
            let n = v.map(|v| gradient * volume * v as f64);
            let size = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
            if size <= epsilon {
                (*v, *own) = Default::default();
                return;
            }
            let squared = if raw {
                (size * size - epsilon * epsilon) * self.length
            } else {
                size
            };
            let u = n.map(|n| (tension * squared).sqrt() / rho / size * n);
            let g = own.map(f64::from);
            let (u2, ug) = (
                u.iter().map(|u| u * u).sum::<f64>(),
                (0..3).map(|a| u[a] * g[a]).sum::<f64>(),
            );
            *own = [0, 1, 2].map(|a| (own_factor * (u2 * g[a] - ug * u[a])) as f32);
            *v = u.map(|u| u as f32);
        });
        self.clear(flow);
        for (i, (normal, _)) in self.near.iter().zip(&self.normals) {
            (0..3).for_each(|a| self.payload[a][*i as usize] = normal[a]);
        }
        flow.turn(&mut self.payload);
    }
}
