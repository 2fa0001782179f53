//! Contact angle on walls: the liquid seems to go on into the wall at the angle theta.
//!
//! (1) c_w: the part of a wall particle's cell that is filled if the surface goes on straight, at
//!     theta to the wall; c_w = 1/2 + x / s0 in 0 .. 1, x the distance along the wall to the line
//!     in which that surface meets the particle's layer:
//! (2) x = (f - 1/2) / e,  f = 2 SUM m / rho0 W^H(x_ab, sheared): the sum over the liquid with
//!     separations sheared along the wall, x_ab + nu cot theta (z_b - z_a), nu from liquid to gas,
//!     in which a surface at the angle theta is upright, and e = W1(0) its slope across such a
//!     surface, W1 the kernel summed over a plane. It is summed about the point on the face of
//!     the wall that the shear puts above a: about a itself deep layers see one row of liquid.
//! The tension (6 of [`super::tension`]) counts wall particles with c_w in n, has n on wall
//! particles too, and adds what the stress there does to the liquid:
//! (3) a_s = SUM m / rho0^2 (T_a + c_w T_w) . grad W, over liquid and wall
//! so that a surface at the angle theta ends nowhere. At another angle theta_d a contact line feels
//! Young's force, sigma (cos theta - cos theta_d) nu per length (Huber et al. 2016), here with the
//! stress itself as delta function of the surface and W1 as that of the wall, for INT 2 W1 dz = 1:
//! (4) a = 2 |T| |SUM m grad W over the wall| sin theta_d (cos theta - cos theta_d) nu / rho0^2
//! with theta_d from the particle's own n; sin theta_d, because the surface crosses a layer of
//! height dz over the length dz / sin theta_d. A surface that bends is steeper or flatter there
//! than at its foot, so theta is that at the height z of what the stress belongs to:
//! (5) cos theta + z d cos / dz,  d cos / dz = t . B t, t the tangent towards the wall and B the
//!     curvature ([`rise`]); for a circle z / R.
//!
//! A tension that derives from an energy has that of walls in place of all this
//! ([`super::tension::shore`]), and of it the angles of lines with hysteresis, and their friction.
//!
//! With an advancing and a receding angle theta of (2) is that which the line has ([`line`]), (4)
//! has what lies beyond the two, and friction resists the motion of the line ([`friction`]).
//!
//! Measured angles: docs/results/wetting.md. Fails where the wedge of liquid at the contact line is
//! thinner than H over many H (theta below 30 degrees; beyond 15 from flat the cotangent stays as
//! it is there); beside a corner of two walls, which counts as wet. Costs nothing far from contact
//! lines. Time step: that of the tension. Tests: tests/engine/effect_wetting.rs, effect_wedge.rs.

pub mod friction;
mod line;
mod mean;
mod pass;
mod rise;
pub mod survey;
pub mod typed;
mod young;

use super::band::Band;
use super::normal::Gradient;
use super::surface::Surface;
use crate::kernel::{self, Kernel};
use crate::scene::{Domain, KernelName, Side, Wetting as Angle};
use crate::space::sweep::{self, Field};
use friction::Friction;
use line::Lines;
pub(super) use line::TIMES;
pub(super) use pass::Walls;
use pass::{Sheared, Weighed};
use rise::Rises;
use std::f64::consts::TAU;
use std::marker::PhantomData;
use survey::{Place, survey};

/// Depth in a wall, in H, from which its stress reaches liquid: that of all that is deeper comes to
/// less than 0.001 sigma.
const DEEP: f64 = 1.5;

/// Distance from a surface, in H, to which colours of walls are needed: the stress of those within
/// 2 H acts on liquid, and has its normal from those within 2 H of them.
const FAR: f64 = 4.0;

/// |grad C| times its smoothing length below which a wall particle lies off every contact line, and
/// at how many smoothing lengths from one it is that; beyond there is but the noise of disorder.
const FLAT: f64 = 0.01;
const REACH: f64 = 1.4;

/// Lengths, m, and what else is fixed.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The contact angle, or two.
    pub angle: Angle,
    /// The box, which says where walls are.
    pub domain: Domain,
    /// Kernel of all sums.
    pub kernel: KernelName,
    /// 2 or 3; 2 for rings, of which the half-plane counts.
    pub dimension: usize,
    /// s0, m.
    pub spacing: f64,
    /// Smoothing length H of the tension, m.
    pub length: f64,
    /// rho0, kg/m^3.
    pub density: f64,
}

/// The effect with its scratch memory.
pub struct Wetting {
    /// What does not change.
    pub setting: Setting,
    /// Cosine of the angle; with hysteresis the mean one.
    pub cosine: f64,
    /// e of (2), 1/m.
    edge: f64,
    band: Band,
    /// Per wall particle; empty before the first update.
    places: Vec<Place>,
    /// Of which walls: see [`Surface::wall_changes`].
    known: Option<u64>,
    /// c_w per wall particle.
    pub colour: Vec<f32>,
    /// nu cot theta per wall particle, towards the liquid's side of the wall; the point above it.
    shear: [Vec<f32>; 3],
    foot: [Vec<f64>; 3],
    /// Wall particles near a surface, after [`Wetting::leave_out`] those with a stress; those of
    /// each axis.
    pub near: Vec<u32>,
    /// cos theta of (2) of every wall particle, with hysteresis only.
    pub cosines: Vec<f64>,
    /// Contact lines and their angles.
    pub lines: Lines,
    facing: [Vec<u32>; 3],
    slopes: Vec<([f32; 3], [f32; 3])>,
    sums: Vec<f32>,
    /// Areas of rings in the half-plane over that of a lattice cell; empty for particles.
    pub areas: [Vec<f32>; 1],
    /// Per `near`: n of wall particles, then sqrt(c_w |T|) n / |n| / rho0.
    pub normals: Vec<([f32; 3], [f32; 3])>,
    /// The latter of every wall particle, in three dimensions only.
    pub roots: [Vec<f32>; 3],
    /// Per particle that the tension looks at: SUM slope d over the wall, with c_w and without.
    pub walls: Vec<([f32; 3], [f32; 3])>,
    /// Smoothing length of the gradients by which particles are shifted, m; `None`: they are not.
    pub short: Option<f64>,
    /// Who is beside a wall, and the same two sums with that length.
    pub beside: Vec<u32>,
    /// Per `beside`: the same with the short kernel, with c_w and without.
    pub shorter: Vec<([f32; 3], [f32; 3])>,
    /// What wall particles add to the force.
    pub force: Vec<[f32; 3]>,
    /// Friction of contact lines.
    pub friction: Friction,
    /// How the surface bends at contact lines.
    pub rises: Rises,
}

impl Wetting {
    /// Walls of which nothing is known yet.
    pub fn new(setting: Setting) -> Self {
        let edge = kernel::plane(setting.kernel, setting.dimension, 0.0) / setting.length;
        Wetting {
            edge,
            cosine: setting.angle.angle.to_radians().cos(),
            setting,
            band: Band::default(),
            places: Vec::new(),
            known: None,
            colour: Vec::new(),
            shear: Default::default(),
            foot: Default::default(),
            near: Vec::new(),
            cosines: Vec::new(),
            lines: Lines::default(),
            facing: Default::default(),
            slopes: Vec::new(),
            sums: Vec::new(),
            areas: Default::default(),
            normals: Vec::new(),
            roots: Default::default(),
            walls: Vec::new(),
            short: None,
            beside: Vec::new(),
            shorter: Vec::new(),
            force: Vec::new(),
            friction: Friction::default(),
            rises: Rises::default(),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let facing = self.facing.iter().map(Vec::capacity).sum::<usize>();
        let lists = facing + self.near.capacity() + self.beside.capacity();
        let roots = 3 * self.roots[0].capacity();
        let of_liquid = self.walls.capacity() + self.shorter.capacity();
        let pairs = self.slopes.capacity() + self.normals.capacity() + of_liquid;
        std::mem::size_of::<Place>() * self.places.capacity()
            + 4 * (self.colour.capacity() + self.sums.capacity() + lists + roots)
            + 4 * self.areas[0].capacity()
            + 12 * (self.shear[0].capacity() + self.force.capacity())
            + 24 * self.foot[0].capacity()
            + 8 * self.cosines.capacity()
            + 24 * pairs
            + self.band.memory()
            + self.friction.memory()
            + self.lines.memory()
            + self.rises.memory()
    }

    /// Finds the wall particles near a surface, the others are wet or far from liquid, and which
    /// way the liquid is from them. Every line has the angle of the mean cosine from now on.
    pub fn find<K: Kernel>(&mut self, flow: &Surface, is_surface: impl Fn(usize) -> bool + Sync) {
        let Some(wall) = flow.of_wall().first() else {
            return;
        };
        let count = flow.wall[0].len();
        if self.known != Some(flow.wall_changes) {
            self.known = Some(flow.wall_changes);
            self.places = survey(&self.setting, flow.wall);
            self.shear = std::array::from_fn(|_| vec![0.0; count]);
            self.foot = flow.wall.clone();
        }
        self.colour.clear();
        self.colour.resize(count, 1.0);
        self.cosines.clear();
        self.cosines
            .resize(if self.rubs() { count } else { 0 }, self.cosine);
        self.band.mark(flow.liquid, is_surface);
        flow.join(self.band.marks());
        let far = FAR * self.setting.length + flow.slack;
        self.band.grow(flow.grid, far);
        self.band.members_of(flow.grid, wall.start, &mut self.near);
        let (places, own) = (&self.places, flow.own_walls());
        let is_near = |j: usize| own.contains(&j) && places[j].axis.is_some();
        self.near.retain(|&j| is_near(j as usize));
        for (axis, facing) in self.facing.iter_mut().enumerate() {
            facing.clear();
            let here = |j: &&u32| places[**j as usize].axis == Some(axis);
            facing.extend(self.near.iter().filter(here));
        }
        for &j in &self.near {
            let j = j as usize;
            (0..3).for_each(|a| self.foot[a][j] = places[j].face(flow.wall, j, a));
        }
        self.measure_areas(flow);
        self.slopes.resize(self.near.len(), Default::default());
        let length = self.sideways();
        let (near, slopes) = (&self.near, &mut self.slopes);
        let span = flow.list(near.len());
        match self.areas[0].is_empty() {
            true => {
                let field = flow.about(&self.foot, flow.of_liquid(), &[], length);
                let pass = Gradient::<K>(PhantomData);
                sweep::runs_shared(field, &span, near, &pass, slopes);
            }
            false => {
                let field = flow.about(&self.foot, flow.of_liquid(), &self.areas, length);
                sweep::runs(field, near, &Walls::<K>(PhantomData), slopes);
            }
        }
    }

    /// Finds the areas of rings in the half-plane.
    fn measure_areas(&mut self, flow: &Surface) {
        let Some([liquid, _]) = flow.weights else {
            return;
        };
        let (spacing, areas) = (self.setting.spacing, &mut self.areas[0]);
        let circle = |r: &f64| TAU * (r / spacing).max(0.5);
        let of = liquid.iter().zip(&flow.position[0]);
        areas.clear();
        areas.extend(of.map(|(weight, r)| (weight / circle(r)) as f32));
        areas.resize(flow.at[0].len(), 1.0);
    }

    /// Mass of a particle of `flow`, kg; of rings that of a cell of the half-plane, kg/m.
    pub fn mass(&self, flow: &Surface) -> f64 {
        match flow.weights {
            None => flow.mass,
            Some(_) => self.setting.density * self.setting.spacing.powi(2),
        }
    }

    /// (1): colours of what was found.
    pub fn colour<K: Kernel>(&mut self, flow: &Surface) {
        self.lean::<K>(flow);
        let (dimension, spacing) = (self.setting.dimension, self.setting.spacing);
        let length = self.setting.length;
        let cutoff = 2.0 * length * self.setting.angle.stretch() + flow.slack;
        let is_plain = self.areas[0].is_empty();
        let norm = K::norm(dimension) / length.powi(dimension as i32);
        let factor = 2.0 * self.mass(flow) / self.setting.density * norm;
        let (lean, kernel) = (&self.shear, PhantomData::<K>);
        for axis in 0..3 {
            let facing = &self.facing[axis];
            let span = flow.list(facing.len());
            self.sums.resize(facing.len(), 0.0);
            let pass = Sheared { axis, lean, kernel };
            if is_plain {
                let field = flow.about(&self.foot, flow.of_liquid(), &[], length);
                let field = Field { cutoff, ..field };
                sweep::runs_shared(field, &span, facing, &pass, &mut self.sums);
            } else {
                let field = flow.about(&self.foot, flow.of_liquid(), &self.areas, length);
                let field = Field { cutoff, ..field };
                sweep::runs(field, facing, &Weighed(pass), &mut self.sums);
            }
            for (&j, sum) in facing.iter().zip(&self.sums) {
                let beyond = (factor * *sum as f64 - 0.5) / self.edge;
                let part = 0.5 + beyond / spacing;
                self.colour[j as usize] = part.clamp(0.0, 1.0) as f32;
            }
        }
    }

    /// Leaves those without a stress out of what was found.
    pub fn leave_out(&mut self) {
        let (places, colour) = (&self.places, &self.colour);
        let deep = DEEP * self.setting.length;
        let pulls = |j: usize| colour[j] > 0.0 && places[j].depth < deep;
        self.near.retain(|&j| pulls(j as usize));
    }

    /// nu cot theta along the wall towards the liquid, and the points that it puts above wall
    /// particles: behind a mirror plane, their images.
    fn lean<K: Kernel>(&mut self, flow: &Surface) {
        let (setting, d) = (&self.setting, self.setting.dimension);
        let mean = Angle::cotangent(setting.angle.angle);
        let volume = self.mass(flow) / setting.density / self.sideways().powi(d as i32);
        let least = FLAT / (K::norm(d) * volume);
        let domain = &self.setting.domain;
        for (&j, (slope, _)) in self.near.iter().zip(&self.slopes) {
            let j = j as usize;
            let place = &self.places[j];
            let Some(normal) = place.axis else {
                continue;
            };
            let cotangent = match self.cosines.get(j) {
                Some(cosine) => Angle::cotangent(cosine.acos().to_degrees()),
                None => mean,
            };
            let along = [0, 1, 2].map(|a| if a == normal { 0.0 } else { slope[a] as f64 });
            let size = along.iter().map(|g| g * g).sum::<f64>().sqrt();
            for a in 0..3 {
                let unit = if size > least { along[a] / size } else { 0.0 };
                let mut shear = -cotangent * place.side * unit;
                let mut x = place.face(flow.wall, j, a) - shear * place.side * place.depth;
                let [low, high] = domain.boundary[a];
                let image = match x {
                    x if x < 0.0 && matches!(low, Side::Mirror | Side::Axis) => -x,
                    x if x > domain.size[a] && high == Side::Mirror => 2.0 * domain.size[a] - x,
                    x => x,
                };
                if image != x {
                    (x, shear) = (image, -shear);
                }
                self.foot[a][j] = x;
                self.shear[a][j] = shear as f32;
            }
        }
    }

    /// Smoothing length of what looks for lines from under a wall, m: a flat or overhanging surface
    /// meets the last layer, at 2 H, far from its foot.
    fn sideways(&self) -> f64 {
        let longer = 2.0 / REACH * self.setting.angle.steepest();
        longer.clamp(1.0, 0.5 * FAR) * self.setting.length
    }

    /// Unit vector along the wall of wall particle `j` and across `normal`; zero without one.
    pub fn along(&self, j: usize, normal: [f64; 3]) -> [f64; 3] {
        let Some(axis) = self.places[j].axis else {
            return [0.0; 3];
        };
        let mut along = [0.0; 3];
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let size = normal[next].hypot(normal[last]).max(f64::MIN_POSITIVE);
        (along[next], along[last]) = (normal[last] / size, -normal[next] / size);
        along
    }

    /// Whether lines have hysteresis.
    pub fn rubs(&self) -> bool {
        self.setting.angle.hysteresis.is_some()
    }

    /// Takes the angles of `lines` from now on.
    pub fn take_angles<K: Kernel>(&mut self, flow: &Surface) {
        let (length, within) = (self.sideways(), self.setting.angle.cosines());
        let (lines, feet) = (&mut self.lines, (&self.foot, self.near.as_slice()));
        lines.measure::<K>(flow, feet, length, within, &mut self.cosines);
    }

    /// Particles beside walls, and what the part of those that is dry adds to their SUM slope d,
    /// which would shift them off a contact line along their surface.
    pub fn dry(&self) -> impl Iterator<Item = (usize, [f32; 3])> {
        let dry = |(wet, all): &([f32; 3], [f32; 3])| std::array::from_fn(|a| all[a] - wet[a]);
        let sums = self.shorter.iter().map(dry);
        self.beside.iter().map(|i| *i as usize).zip(sums)
    }
}
