//! MPS, the moving particle semi-implicit method, as Xie, Koshizuka & Oka (2007) use it.
//!
//! (1) w = r_e / r - 1 for r < r_e                                                Eq. 3
//! (2) n_i = SUM w_ij,  n0: that of the lattice                                   Eq. 4
//! (3) grad p = d / n0 SUM (p_j - p_i) (r_j - r_i) / r^2 w                        Eq. 5
//! (4) lap p = 2 d / (n0 lambda) SUM (p_j - p_i) w,  n0 lambda = SUM r^2 w        Eqs. 6, 7
//! (5) v* = v^n + dt (nu lap v + tension + g),  r* = r^n + dt v*                  Eqs. 2, 9
//! (6) lap p = -rho / dt^2 (n* - n0) / n0; with `source.divergence`
//!     lap p = rho (div v* / dt - gamma (n - n0) / (n0 dt T)), T as in ISPH       Eq. 8
//!     (Tanaka & Masunaga 2010)
//! (7) v^(n+1) = v* - dt grad p / rho,  r^(n+1) = r^n + dt v^(n+1); with `theta` < 1 as ISPH
//!
//! Not in the paper: p = 0 where n < beta n0 (Koshizuka & Oka 1996); in (3) p_i is the least p
//! about i (Koshizuka, Nobe & Oka 1998). `gradient.symmetric` has p_j + p_i in its place (Tanaka &
//! Masunaga 2010): momentum is kept between liquid particles. Taking the least about each away from
//! it (Khayyer & Gotoh 2008) would leave nothing of a linear p on a lattice.
//! `corrected` is (3) times (d / n0 SUM w r r / r^2)^-1, exact for linear p (Khayyer & Gotoh 2011;
//! Tamai & Koshizuka 2014), but p_j + p_i where a surface is in the support; div v* likewise.
//! `transposed` is (3) with p_j + p_i in the pressure equation too: `projection::transposed`.
//! `blended` is `corrected` with the gradient of the smooth kernel in place of w / r^2 where a
//! surface is in the support: spurious currents in a drop at rest are 0.4 of those, a splash is
//! coarser.
//! `closure.completed` is that of ISPH, [`surface`], with the weights of (4); there and in the
//! shifting a smooth kernel of h = r_e / 2 shows the surface. The step, its limits, walls and
//! shifting: [`super::projection`].
//!
//! In (3) and div v* the weight w / r^2 stays, nearer than `core`, what it is there. Else pressure
//! moves a pair at half a spacing by w^2 / r^2 where (4) counts on w: four times as far, and back
//! farther in every step, until a contact line throws off particles.
//!
//! Fails with `threshold` and `source.divergence` in a splash: what is flagged for a moment is let
//! go at p = 0, and no source brings it back; (6) as printed turns noise of n into pressure.
//! The tension of Eqs. 10-16 and the wetting of Eq. 18 are effects: `effect::tension`.
//! Tests: tests/engine/{mps,projection}_*.rs, tests/validation.

mod least;
pub mod pass;
mod rings;

use super::model::Case;
use super::projection::correction::times;
use super::projection::{Projection, Scheme, surface};
use crate::kernel::WendlandC2;
use crate::kernel::ring::Rings;
use crate::scene::{Mps as Settings, MpsClosure, MpsGradient, MpsPressure};
use crate::scene::{Viscosity, ViscosityForm};
use crate::space::parallel::each_mut;
use pass::{
    Around, Coupled, Look, NEAREST, Number, PressureSlope, Steep, Surface, Viscous, Weights,
};

/// The kernel of walls, of the free surface and of the shifting.
pub type Smooth = WendlandC2;

/// Sums of the weight (1) over the lattice, the particle itself left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// n0 = SUM w.
    pub number: f64,
    /// n0 lambda = SUM r^2 w, in squared spacings.
    pub spread: f64,
}

impl Lattice {
    /// For `radius` = r_e / l0 in `dimension` dimensions.
    pub fn of(radius: f64, dimension: usize) -> Self {
        let reach = radius.ceil() as i64;
        let depth = if dimension == 3 { reach } else { 0 };
        let (mut number, mut spread) = (0.0, 0.0);
        for x in -reach..=reach {
            for y in -depth..=depth {
                for z in -reach..=reach {
                    let r = ((x * x + y * y + z * z) as f64).sqrt();
                    if r > 0.0 && r < radius {
                        number += radius / r - 1.0;
                        spread += (radius / r - 1.0) * r * r;
                    }
                }
            }
        }
        Lattice { number, spread }
    }
}

/// What is MPS's own.
pub(super) struct Mps {
    /// r_e of (2), (3), and of (4), in spacings.
    radius: f64,
    laplacian_radius: f64,
    /// Where the weight of gradients ends to grow, in spacings.
    core: f64,
    beta: f64,
    closure: MpsClosure,
    gradient: MpsGradient,
    pressure: MpsPressure,
    /// The lattice at the two radii.
    lattice: Lattice,
    laplacian: Lattice,
    /// Of rings: kernels of the weights of gradients and of the Laplacian.
    rings: Option<[Rings; 2]>,
    /// 1, or 0 where p = 0 is given, by unknown.
    inside: Vec<f32>,
    /// Least pressure about, Pa, by liquid particle.
    least: Vec<f64>,
}

impl Mps {
    pub fn new(settings: &Settings, case: &Case) -> Self {
        let is_axial = case.domain.is_axial();
        let lattice = |radius: f64| match is_axial {
            true => Lattice::of_rings(radius),
            false => Lattice::of(radius, case.space),
        };
        let lengths = [
            settings.radius,
            settings.laplacian_radius,
            settings.core,
            1.0,
        ];
        let [gradient, laplacian, core, apart] = lengths.map(|x| x / case.sph.smoothing);
        let core = core.max(NEAREST as f64);
        Mps {
            radius: settings.radius,
            laplacian_radius: settings.laplacian_radius,
            core: settings.core,
            beta: settings.beta,
            closure: settings.closure,
            gradient: settings.gradient,
            pressure: settings.pressure,
            lattice: lattice(settings.radius),
            laplacian: lattice(settings.laplacian_radius),
            rings: is_axial.then(|| rings::kernels([gradient, laplacian, core, apart])),
            inside: Vec::new(),
            least: Vec::new(),
        }
    }

    /// r_e / h of number density and gradient, and of the Laplacian.
    fn reach(&self, case: &Case) -> f32 {
        (self.radius / case.sph.smoothing) as f32
    }

    /// Where the weight of gradients ends to grow, in h.
    fn core(&self, case: &Case) -> f32 {
        NEAREST.max((self.core / case.sph.smoothing) as f32)
    }

    fn laplacian_reach(&self, case: &Case) -> f32 {
        (self.laplacian_radius / case.sph.smoothing) as f32
    }

    /// d / n0 of (3).
    fn gradient_factor(&self, case: &Case) -> f64 {
        case.space as f64 / self.lattice.number
    }

    /// 2 d / (n0 lambda) of (4), 1/m^2.
    fn laplacian_factor(&self, case: &Case) -> f64 {
        let spread = self.laplacian.spread * case.spacing.powi(2);
        2.0 * case.space as f64 / spread
    }

    fn look_with<const CORRECTED: bool, const BLENDED: bool>(p: &mut Projection<Self>) {
        let pass = Look::<CORRECTED, BLENDED> {
            reach: p.scheme.reach(&p.liquid.case),
            core: p.scheme.core(&p.liquid.case),
            number: 1.0 / p.scheme.lattice.number,
            value: p.scheme.gradient_factor(&p.liquid.case),
            length: p.liquid.case.h,
            smooth: p.factor(0),
            active: p.active(),
            surface: Surface {
                marks: &p.own.marks,
                even: p.factor(0) / p.scheme.gradient_factor(&p.liquid.case),
            },
        };
        p.liquid.sum(&pass, &mut p.own.local);
    }

    fn slope_with<const SYMMETRIC: bool, const BLENDED: bool>(p: &mut Projection<Self>) {
        let pass = PressureSlope::<SYMMETRIC, BLENDED> {
            reach: p.scheme.reach(&p.liquid.case),
            core: p.scheme.core(&p.liquid.case),
            surface: Surface {
                marks: &p.own.marks,
                even: p.factor(0) / p.scheme.gradient_factor(&p.liquid.case),
            },
        };
        p.liquid.sum(&pass, &mut p.own.push);
    }

    /// Unknowns whose p is zero because n < beta n0.
    fn flag(p: &mut Projection<Self>) {
        let n = p.liquid.len();
        let threshold = p.scheme.closure == MpsClosure::Threshold;
        let (local, walls, beta) = (&p.own.local, &p.walls, p.scheme.beta);
        let inside = |i: usize| {
            let number = match i.checked_sub(n) {
                None => local[i].number as f64,
                Some(g) => walls.density[walls.contact[g] as usize],
            };
            f32::from(!threshold || number >= beta)
        };
        p.scheme.inside.clear();
        p.scheme.inside.extend((0..n + walls.len()).map(inside));
    }
}

impl Scheme for Mps {
    const NAME: &'static str = "mps";
    const TRAPEZOIDAL: bool = false;
    type Kernel = Smooth;
    /// n / n0.
    type Own = f32;
    type Weight = Steep;
    /// The last: w of neighbours with p = 0.
    type Row = [f32; 7];

    fn completion(&self, case: &Case) -> surface::Completion {
        let full = Lattice::of(self.laplacian_radius, case.space).number;
        surface::Completion::of::<Smooth>(case.sph.kernel, case.space, case.sph.smoothing)
            .with_full(full)
    }

    fn is_symmetric(&self) -> bool {
        matches!(
            self.gradient,
            MpsGradient::Symmetric | MpsGradient::Transposed
        )
    }

    fn is_transposed(&self) -> bool {
        self.gradient == MpsGradient::Transposed
    }

    fn is_corrected(&self) -> bool {
        self.gradient.is_corrected()
    }

    fn walls_are_dense(p: &Projection<Self>) -> bool {
        p.is_printed() || p.scheme.closure == MpsClosure::Threshold
    }

    fn look_around(p: &mut Projection<Self>) {
        let n = p.liquid.len();
        p.own.held.fill([0.0; 3]);
        p.pack_velocity(1.0);
        let pass = Around {
            reach: p.scheme.reach(&p.liquid.case),
            number: 1.0 / p.scheme.lattice.number,
        };
        p.own.around.resize(n, Default::default());
        p.liquid.sum(&pass, &mut p.own.around);
        let case = &p.liquid.case;
        if let Some(Viscosity { dynamic, form }) = case.effects.viscosity {
            let is_central = form == ViscosityForm::Central;
            let directions = if is_central { case.space + 2 } else { 1 };
            let nu = directions as f64 * dynamic / case.density;
            let pass = Viscous {
                reach: p.scheme.laplacian_reach(case),
                is_central,
                factor: nu * p.scheme.laplacian_factor(case),
            };
            p.pack_no_slip(1.0);
            p.liquid.sum(&pass, &mut p.own.held);
        }
    }

    fn threshold(p: &Projection<Self>, i: usize) -> Option<bool> {
        let flagged = p.scheme.closure == MpsClosure::Threshold;
        flagged.then(|| (p.own.around[i].own as f64) < p.scheme.beta)
    }

    fn look(p: &mut Projection<Self>) {
        match p.scheme.gradient {
            MpsGradient::Corrected => Self::look_with::<true, false>(p),
            MpsGradient::Blended => Self::look_with::<true, true>(p),
            _ => Self::look_with::<false, false>(p),
        }
    }

    fn look_at_walls(p: &mut Projection<Self>) {
        let pass = Number {
            reach: p.scheme.reach(&p.liquid.case),
            factor: 1.0 / p.scheme.lattice.number,
        };
        p.liquid.sum_at_walls(&pass, &mut p.walls.density);
    }

    fn wall_to_wall(p: &Projection<Self>, q: f64) -> f64 {
        let reach = p.scheme.reach(&p.liquid.case) as f64;
        let weight = if q > 0.0 {
            (reach / q - 1.0).max(0.0)
        } else {
            0.0
        };
        weight / p.scheme.lattice.number
    }

    /// The weights of (4).
    fn couple(p: &mut Projection<Self>) {
        if p.liquid.flow.is_axial() {
            return p.couple_rings();
        }
        Self::flag(p);
        let (local, walls, inside) = (&p.own.local, &p.walls, &p.scheme.inside);
        let n = p.liquid.len();
        p.liquid.flow.pack(
            |_, i| Coupled {
                inside: inside[i],
                volume: 1.0 / local[i].density,
                offset: 0.0,
            },
            |_, j| Coupled {
                inside: inside[n + walls.group[j] as usize],
                volume: 1.0,
                offset: walls.offset[j],
            },
        );
        p.walls.number(&p.liquid.flow);
        let layout = p.walls.layout(&p.liquid.flow, p.liquid.case.h);
        let reach = p.scheme.laplacian_reach(&p.liquid.case);
        let e = &mut p.equation;
        let (sparse, degree, sums) = (&mut e.coupling, &mut e.diagonal, &mut p.sums);
        match p.scheme.closure {
            MpsClosure::Threshold => {
                sparse.build(&layout, &Weights::<true> { reach }, degree, sums)
            }
            MpsClosure::Completed => {
                sparse.build(&layout, &Weights::<false> { reach }, degree, sums)
            }
        }
    }

    fn flagged(p: &Projection<Self>, i: usize, _: f64) -> Option<f64> {
        (p.scheme.closure == MpsClosure::Threshold).then(|| p.sums[i][6] as f64)
    }

    fn given(p: &Projection<Self>, i: usize) -> bool {
        p.scheme.inside[i] == 0.0
    }

    fn dense(p: &Projection<Self>, i: usize) -> [f64; 2] {
        let local = &p.own.local[i];
        match p.scheme.closure {
            MpsClosure::Completed => [local.density as f64; 2],
            MpsClosure::Threshold => [1.0, local.number as f64],
        }
    }

    fn unit(p: &Projection<Self>) -> f64 {
        p.scheme.laplacian_factor(&p.liquid.case) / p.liquid.case.density
    }

    fn slope(p: &mut Projection<Self>) {
        let n = p.liquid.len();
        if p.scheme.pressure == MpsPressure::Clipped {
            p.unknown.iter_mut().for_each(|p| *p = p.max(0.0));
            p.own.pressure.copy_from_slice(&p.unknown[..n]);
        }
        p.own.push.resize(n, [0.0; 3]);
        p.pack_pressure();
        match p.scheme.gradient {
            MpsGradient::Symmetric => Self::slope_with::<true, false>(p),
            MpsGradient::Blended => Self::slope_with::<false, true>(p),
            _ => Self::slope_with::<false, false>(p),
        }
        // d = r_i - r_j: the sign of (3) and that of the acceleration cancel.
        let factor =
            p.scheme.gradient_factor(&p.liquid.case) / (p.liquid.case.h * p.liquid.case.density);
        let corrected = p.scheme.is_corrected();
        let local = &p.own.local;
        each_mut(&mut p.own.push[..n], |i, push| {
            let mut sum = push.map(|s| factor * s as f64);
            if corrected {
                sum = times(&local[i].correction, sum);
            }
            *push = sum.map(|a| a as f32);
        });
    }

    fn of_rings(&self) -> [Rings; 2] {
        self.rings.unwrap_or_default()
    }

    fn weight(p: &Projection<Self>) -> (Steep, f64) {
        let case = &p.liquid.case;
        let weight = Steep {
            reach: p.scheme.reach(case),
            core: p.scheme.core(case),
        };
        (weight, p.scheme.gradient_factor(case) / case.h)
    }

    fn memory(&self) -> usize {
        4 * self.inside.capacity() + 8 * self.least.capacity()
    }
}
