//! Incompressible SPH: the two-step projection of Kuri et al.
//!
//! (1) v* = v^n + dt (viscosity + tension + g),  r* = r^n + dt v*                 Kuri Eqs. 1, 2
//! (2) rho_a = SUM m W_ab at r*                                                   Eq. 4
//! (3) SUM m 8 / (rho_a + rho_b)^2 (r . grad W) / r^2 (p_a - p_b) = right-hand side    Eq. 8
//!     right-hand side, as printed: (rho0 - rho) / (rho0 dt^2); with `source.divergence`:
//!     div v* / dt + gamma (rho0 - rho) / (rho0 dt T), rho = rho0 in the weights (Cummins & Rudman
//!     1999; gamma: Asai et al. 2012), T the step at the speed that the scene suggests, or dt if
//!     that is longer
//! (4) at a free surface: [`surface`]                                             Eq. 11
//! (5) v^(n+1) = v* - dt grad p / rho                                             Eq. 9
//! (6) r^(n+1) = r^n + dt (v^n + v^(n+1)) / 2                                     Eq. 10
//!
//! `gradient.symmetric` is Eq. 9 as printed, which keeps momentum; `corrected` is
//! SUM V (p_b - p_a) L grad W with the matrix L of Bonet & Lok 1999, exact for linear p, but Eq. 9
//! where a surface is in the support: differences do not hold a surface together. `transposed` is
//! Eq. 9 in the pressure equation too, as `projection::transposed` has it; near a surface whose
//! tension has an energy it is [`super::completed`].
//!
//! The step, its limits, walls and shifting: [`super::projection`]. The paper gives steps of 5 to
//! 20 us "by the largest speed" and no law.
//! Fails where: Eq. 8 as printed turns noise of density into pressure (0.1 % at 10 us: 100 to
//! 700 Pa). Tests: tests/engine/{isph,projection}_*.rs,
//! tests/validation.

pub mod pass;

use super::flow::Flow;
use super::model::Case;
use super::pass::Summation;
use super::projection::correction::times;
use super::projection::look::Sums;
use super::projection::transposed::OfKernel;
use super::projection::{Projection, Scheme, surface};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::kernel::ring::Rings;
use crate::scene::{Closure, Gradient, Isph as Settings, PoissonSource};
use crate::space::grid::Scale;
use crate::space::parallel::each_mut;
use crate::space::sweep;
use pass::{Around, Coupled, Look, Pressed, PressureSlope, Weights};
use std::marker::PhantomData;

/// A sweep of [`Around`] with the viscosity of the scene, which nothing else depends on.
type Explicit = Box<dyn Fn(&Flow, Scale, &mut [Sums<[f32; 3]>]) + Send + Sync>;

/// `K`: kernel.
pub(super) struct Isph<K> {
    closure: Closure,
    gradient: Gradient,
    explicit: Explicit,
    is_viscous: bool,
    /// Flags of the first closure.
    mirrored: Vec<bool>,
    kernel: PhantomData<K>,
}

impl<K: Kernel> Isph<K> {
    /// `V`: viscosity, `()` for none; `mass` of a particle, kg.
    pub fn new<V: PairViscosity>(
        settings: &Settings,
        viscosity: V,
        case: &Case,
        mass: f64,
    ) -> Self {
        let (d, volume) = (case.space, mass / case.density);
        let pass = Around::<K, V> {
            factor: volume * K::norm(d) / case.h.powi(d as i32 + 1) * case.density,
            viscosity,
            kernel: PhantomData,
        };
        let explicit = move |flow: &Flow, scale, out: &mut [Sums<[f32; 3]>]| {
            sweep::rows(&flow.records, &flow.rows, scale, &pass, out)
        };
        Isph {
            closure: settings.closure,
            gradient: settings.gradient,
            explicit: Box::new(explicit),
            is_viscous: V::PRESENT,
            mirrored: Vec::new(),
            kernel: PhantomData,
        }
    }

    fn look_with<const CORRECTED: bool>(p: &mut Projection<Self>) {
        let full = match p.is_printed() {
            true => 1.0,
            false => p.closure.lattice(),
        };
        let pass = Look::<K, CORRECTED> {
            value: p.factor(0),
            gradient: p.factor(1),
            full: full as f32,
            active: p.active(),
            marks: &p.own.marks,
            kernel: PhantomData,
        };
        p.liquid.sum(&pass, &mut p.own.local);
    }

    /// Flags of the first closure.
    fn detect(p: &mut Projection<Self>) {
        let n = p.liquid.len();
        p.scheme.mirrored.resize(n, false);
        let planar = p.liquid.case.dimension.count() == 2;
        let scene = (&p.liquid.flow.grid, p.liquid.case.h, planar);
        let (local, records, rows) = (&p.own.local, &p.liquid.flow.records, &p.liquid.flow.rows);
        each_mut(&mut p.scheme.mirrored[..n], |i, out| {
            *out = surface::is_surface(&local[i], i, rows.row(i).indices(), records, scene)
        });
    }

    fn slope_with<const SYMMETRIC: bool>(p: &mut Projection<Self>) {
        let pass = PressureSlope::<K, SYMMETRIC>(PhantomData);
        p.liquid.sum(&pass, &mut p.own.push);
    }
}

impl<K: Kernel> Scheme for Isph<K> {
    const NAME: &'static str = "isph";
    const TRAPEZOIDAL: bool = true;
    type Kernel = K;
    /// Viscous acceleration, m/s^2.
    type Own = [f32; 3];
    type Weight = OfKernel<K>;
    type Row = [f32; 6];
    const COMPLETES: bool = true;

    fn completion(&self, case: &Case) -> surface::Completion {
        surface::Completion::of::<K>(case.sph.kernel, case.space, case.sph.smoothing)
    }

    fn is_symmetric(&self) -> bool {
        self.gradient != Gradient::Corrected
    }

    fn is_transposed(&self) -> bool {
        self.gradient == Gradient::Transposed
    }

    fn is_corrected(&self) -> bool {
        self.gradient == Gradient::Corrected
    }

    fn walls_are_dense(p: &Projection<Self>) -> bool {
        p.is_printed()
    }

    fn look_around(p: &mut Projection<Self>) {
        let rho0 = p.liquid.case.density;
        let weight = (1.0 / (rho0 * rho0)) as f32;
        p.pack_velocity(weight);
        if p.scheme.is_viscous {
            p.pack_no_slip(weight);
        }
        let n = p.liquid.len();
        p.own.around.resize(n, Default::default());
        let scale = p.liquid.scale();
        (p.scheme.explicit)(&p.liquid.flow, scale, &mut p.own.around);
        let around = &p.own.around;
        each_mut(&mut p.own.held[..n], |i, held| *held = around[i].own);
    }

    fn threshold(_: &Projection<Self>, _: usize) -> Option<bool> {
        None
    }

    fn look(p: &mut Projection<Self>) {
        match p.scheme.gradient {
            Gradient::Corrected => Self::look_with::<true>(p),
            _ => Self::look_with::<false>(p),
        }
    }

    fn look_at_walls(p: &mut Projection<Self>) {
        let pass = Summation::<K> {
            factor: p.factor(0),
            own: 0.0,
            kernel: PhantomData,
        };
        p.liquid.sum_at_walls(&pass, &mut p.walls.density);
    }

    fn wall_to_wall(p: &Projection<Self>, q: f64) -> f64 {
        p.factor(0) * K::w(q)
    }

    /// The weights of Eq. 8 in units of 2 m norm / (rho0^2 h^(d+2)).
    fn couple(p: &mut Projection<Self>) {
        if p.liquid.flow.is_axial() {
            return p.couple_rings();
        }
        let (local, walls) = (&p.own.local, &p.walls);
        p.liquid.flow.pack(
            |_, i| Coupled {
                density: local[i].kernel_sum,
                volume: 1.0 / local[i].density,
                offset: 0.0,
            },
            |_, j| Coupled {
                density: walls.density[j] as f32,
                volume: 1.0,
                offset: walls.offset[j],
            },
        );
        p.walls.number(&p.liquid.flow);
        let layout = p.walls.layout(&p.liquid.flow, p.liquid.case.h);
        let e = &mut p.equation;
        let (sparse, degree, sums) = (&mut e.coupling, &mut e.diagonal, &mut p.sums);
        match p.settings.source {
            PoissonSource::Density => {
                sparse.build(&layout, &Weights::<K, true>(PhantomData), degree, sums)
            }
            PoissonSource::Divergence { .. } => {
                sparse.build(&layout, &Weights::<K, false>(PhantomData), degree, sums)
            }
        }
        if p.scheme.closure == Closure::Mirrored {
            Self::detect(p);
        }
    }

    fn flagged(p: &Projection<Self>, i: usize, degree: f64) -> Option<f64> {
        if p.scheme.closure == Closure::Completed {
            return None;
        }
        let is = p.scheme.mirrored.get(i).copied().unwrap_or(false);
        Some(if is { degree } else { 0.0 })
    }

    fn given(_: &Projection<Self>, _: usize) -> bool {
        false
    }

    fn dense(p: &Projection<Self>, i: usize) -> [f64; 2] {
        [p.own.local[i].density as f64; 2]
    }

    fn unit(p: &Projection<Self>) -> f64 {
        2.0 * p.factor(2) / p.liquid.case.density
    }

    fn slope(p: &mut Projection<Self>) {
        let n = p.liquid.len();
        let printed = p.is_printed();
        let (x, walls, local) = (&p.unknown, &p.walls, &p.own.local);
        let thin = |dense: f64| if printed { 1.0 / (dense * dense) } else { 1.0 };
        p.liquid.flow.pack(
            |_, i| {
                let pressure = (x[i] * thin(local[i].kernel_sum as f64)) as f32;
                Pressed { pressure }
            },
            |_, j| {
                let p = x[n + walls.group[j] as usize] + walls.offset[j] as f64;
                let pressure = (p * thin(walls.density[j])) as f32;
                Pressed { pressure }
            },
        );
        p.own.push.resize(n, [0.0; 3]);
        let symmetric = p.scheme.gradient == Gradient::Symmetric;
        match symmetric {
            true => Self::slope_with::<true>(p),
            false => Self::slope_with::<false>(p),
        }
        let (factor, rho0) = (-p.factor(1) / p.liquid.case.density, p.liquid.case.density);
        let (local, marks) = (&p.own.local, &p.own.marks);
        let x = &p.unknown;
        each_mut(&mut p.own.push[..n], |i, push| {
            let sum = push.map(|s| factor * s as f64);
            let corrected = if symmetric {
                sum
            } else if marks[i] > 0.0 {
                // The sum of pressures from their difference: 2 p_a SUM V grad W more.
                [0, 1, 2].map(|a| sum[a] - 2.0 * x[i] / rho0 * local[i].slope[a] as f64)
            } else {
                times(&local[i].correction, sum)
            };
            *push = corrected.map(|a| a as f32);
        });
    }

    fn of_rings(&self) -> [Rings; 2] {
        [Rings::default(); 2]
    }

    fn weight(p: &Projection<Self>) -> (OfKernel<K>, f64) {
        (OfKernel(PhantomData), p.factor(1))
    }

    fn memory(&self) -> usize {
        self.mirrored.capacity()
    }
}
