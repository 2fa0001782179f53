//! The liquid under every method: particles, cells, rows, walls and images ([`Flow`]), effects,
//! limits of the step, removal, the budget of energy, states and frames.
//!
//! A method has the arrays that its equations need, declared as columns, and hands them over where
//! particles are sorted, removed or saved.

use super::flow::Flow;
use super::frame::{self, Beat};
use super::ledger::Ledger;
use super::limit::Limits;
use super::model::Case;
use super::shifting::LOOSE;
use crate::effect::active::{ActiveEffects, BodyForce};
use crate::effect::wetting::friction::Hold;
use crate::particle::column::{
    Columns, Load, Memory, Reflect, Retain, Role, Save, Scalar, Scalars, Sort, Visitor,
};
use crate::particle::{Frame, State, weight_of};
use crate::space::grid::Scale;
use crate::space::parallel::{max, sum_mut, three};
use crate::space::sweep::{self, Pass};

/// A particle with a kernel sum below this that crosses a periodic side is mist: it has no more
/// neighbours than the tip of a chain of particles, which has 0.19 in 3-D and 0.37 in 2-D (Wendland
/// C2, h = 1.5 s0).
const MIST: f32 = 0.4;

/// Where a run is, and what steps follow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Simulated time, s, and steps taken.
    pub time: f64,
    /// Steps taken.
    pub step: u64,
    /// Length of the last step, s.
    pub last_step: f64,
    /// Largest speed, m/s, and acceleration, m/s^2, of the last step.
    pub max_speed: f64,
    /// Largest acceleration of the last step, m/s^2.
    pub max_acceleration: f64,
    /// Largest speed of what is not spray, m/s: spray meets nothing that could be pressed.
    pub connected_speed: f64,
    /// What left the scene: mass, kg, and particles.
    pub removed_mass: f64,
    /// Particles that left the scene.
    pub removed_particles: u64,
}

impl Scalars for Moment {
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar)) {
        see("removed_mass_kg", &mut self.removed_mass);
        see("removed_particles", &mut self.removed_particles);
        see("time_step_s", &mut self.last_step);
        see("acceleration_m_s2", &mut self.max_acceleration);
        see("connected_speed_m_s", &mut self.connected_speed);
    }
}

/// What every method moves.
pub struct Liquid {
    /// Constants of the run.
    pub case: Case,
    /// Particles, cells, rows, walls, images.
    pub flow: Flow,
    /// What acts on the liquid.
    pub effects: ActiveEffects,
    /// Where the run is.
    pub now: Moment,
    /// At which instants steps end.
    pub beat: Beat,
    /// The budget of energy.
    pub ledger: Ledger,
    /// Uniform accelerations of this step, m/s^2.
    pub body_force: BodyForce,
    /// Of contact lines, by particle; empty without friction.
    pub friction: Vec<Hold>,
    /// Whether single particles that cross a periodic side are removed.
    pub removes_mist: bool,
    /// Energy of the body force that is driven at the start of a step, J.
    pub(super) driven: f64,
    mist: Vec<bool>,
    positions: [Vec<f64>; 3],
    /// Parts of sums.
    pub parts: Vec<[f64; 1]>,
    /// The same of two.
    pub pairs: Vec<[f64; 2]>,
}

impl Liquid {
    /// `removes_mist`: as the field.
    pub fn new(
        case: Case,
        flow: Flow,
        effects: ActiveEffects,
        removes_mist: bool,
        state: &State,
    ) -> Self {
        let mut liquid = Liquid {
            case,
            flow,
            effects,
            now: Moment {
                time: state.time,
                step: state.step,
                ..Moment::default()
            },
            beat: Beat::default(),
            ledger: Ledger::default(),
            body_force: BodyForce::default(),
            friction: Vec::new(),
            removes_mist,
            driven: 0.0,
            mist: Vec::new(),
            positions: Default::default(),
            parts: Vec::new(),
            pairs: Vec::new(),
        };
        liquid.now.max_speed = liquid.max_speed();
        liquid.now.connected_speed = liquid.now.max_speed;
        liquid.now.load(state);
        liquid.ledger.load(state);
        liquid.set_body_force(0.0);
        liquid
    }

    /// Liquid particles.
    pub fn len(&self) -> usize {
        self.flow.liquid()
    }

    /// Whether no particle is left.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// No step is longer than from one frame to the next: half of a rejected one is half of that.
    pub fn longest(&self, dt: f64) -> f64 {
        dt.min(self.beat.interval)
    }

    /// The step of at most `dt` s that the next frame lets be.
    pub fn fit(&self, dt: f64) -> f64 {
        self.beat.fit(self.now.time, dt)
    }

    /// Turns differences in fixed point into separations over h.
    pub fn scale(&self) -> Scale {
        self.flow.grid.scale(self.case.h)
    }

    /// Sums of `pass` over the neighbours of each particle.
    pub fn sum<const N: usize, P: Pass<N>>(&self, pass: &P, out: &mut [P::Out]) {
        sweep::rows(&self.flow.records, &self.flow.rows, self.scale(), pass, out);
    }

    /// Sums of `pass` over the liquid around each wall particle, and over walls if they see walls.
    pub fn sum_at_walls<const N: usize, P: Pass<N>>(&self, pass: &P, out: &mut [P::Out]) {
        let rows = &self.flow.wall_rows;
        sweep::rows(&self.flow.records, rows, self.scale(), pass, out);
    }

    /// Whether the tension is the derivative of an energy.
    pub fn follows_energy(&self) -> bool {
        self.case.follows_energy()
    }

    /// Whether nobody has found the surface yet: at the start of a run.
    pub fn lacks_surface(&self) -> bool {
        match self.follows_energy() {
            true => self.ledger.surface.is_none(),
            false => self.now.step == 0,
        }
    }

    /// Largest speed now, m/s.
    pub fn max_speed(&self) -> f64 {
        max(self.flow.span(), |i| self.flow.particles.speed(i)).max(0.0)
    }

    /// Largest speed now of what is not spray, m/s; `kernel_sum` by particle: 1 inside.
    pub fn max_connected_speed(&self, kernel_sum: impl Fn(usize) -> f32 + Sync) -> f64 {
        let p = &self.flow.particles;
        let speed = |i: usize| match kernel_sum(i) < LOOSE {
            true => 0.0,
            false => p.speed(i),
        };
        max(self.flow.span(), speed).max(0.0)
    }

    /// Limits of a step now; `sound_speed` in m/s.
    pub fn limits(&self, sound_speed: f64) -> Limits<'_> {
        Limits {
            h: self.case.h,
            density: self.case.density,
            sound_speed,
            speed: self.now.connected_speed,
            acceleration: self.now.max_acceleration,
            effects: &self.effects,
        }
    }

    /// Marks mist beyond a periodic side, to be removed. `kernel_sum` by particle, 1 inside; empty
    /// before the first step.
    pub fn find_mist(&mut self, kernel_sum: &[f32]) {
        self.mist.clear();
        if self.removes_mist && self.now.step > 0 && !kernel_sum.is_empty() {
            let is = |i: usize| self.flow.crosses(i) && kernel_sum[i] < MIST;
            self.mist.extend((0..self.flow.liquid()).map(is));
        }
    }

    /// Wraps periodic axes, puts back what is behind walls and mirror planes, removes what left
    /// and what is mist.
    pub fn confine(&mut self, own: &mut impl Columns) {
        let mist = &self.mist;
        let doomed = |i: usize| !mist.is_empty() && mist[i];
        let kept = self.flow.confine(doomed);
        own.visit(&mut Reflect(&self.flow.reflected));
        self.friction.clear();
        let (gone, before) = (self.flow.gone(kept.as_deref()), self.flow.total_mass());
        self.ledger.displaces = self.flow.any(self.flow.held_back || gone > 0);
        if let Some(kept) = kept {
            self.flow.particles.visit(&mut Retain(&kept));
            own.visit(&mut Retain(&kept));
        }
        if gone > 0 {
            self.flow.count();
            self.now.removed_particles += gone;
            self.now.removed_mass += self.flow.lost(gone, before);
        }
    }

    /// Sorts particles along cells; every column follows.
    pub fn sort(&mut self, own: &mut impl Columns) {
        self.flow.migrate(own, &mut self.friction);
        self.flow.sort();
        let mut sort = Sort {
            cells: &self.flow.liquid_cells,
            spare: &mut self.flow.spare,
        };
        sort.visit(Role::Held, &mut self.friction);
        own.visit(&mut sort);
    }

    /// Takes the uniform accelerations as they are `ahead` s from now.
    pub fn set_body_force(&mut self, ahead: f64) {
        self.body_force = self.effects.body_force(self.now.time + ahead);
    }

    /// Finds what effects do to particles where they will be `ahead` s from now, and adds it to
    /// `into`. `is_surface`: whether a particle is at the free surface.
    pub fn add_effects(
        &mut self,
        ahead: f64,
        is_surface: &(dyn Fn(usize) -> bool + Sync),
        into: &mut [[f32; 3]],
    ) {
        if !self.effects.has_updates() {
            return;
        }
        let mut now = std::mem::take(&mut self.positions);
        if ahead > 0.0 {
            self.flow.look_ahead(ahead, &mut now);
        } else if self.flow.has_moved() {
            self.flow.place();
        }
        let sources = self.flow.sources();
        let surface = super::surface_of(&self.flow, &sources);
        self.friction.clear();
        let (particles, friction) = (&self.flow.particles, &mut self.friction);
        let effects = &mut self.effects;
        let account = effects.update(&surface, is_surface, particles, friction);
        self.ledger.see(account, ahead);
        self.effects.add(into);
        if ahead > 0.0 {
            self.flow.look_back(&mut now);
        }
        self.positions = now;
    }

    /// Lets friction act on contact lines for `dt` s, in which particles move by the mean of the
    /// velocities at its ends; `pushed`: what they were given since its start, m/s.
    pub fn rub(&mut self, dt: f64, pushed: impl Fn(usize) -> [f64; 3] + Sync) {
        if !self.flow.any(!self.friction.is_empty()) {
            return;
        }
        let span = self.flow.span();
        let (friction, p) = (&self.friction, &mut self.flow.particles);
        let weights = &p.weight;
        let [work] = sum_mut(
            &mut self.parts,
            span,
            three(&mut p.velocity, friction.len()),
            |i, v| {
                let [x, y, z] = v;
                let (free, push) = ([*x, *y, *z], pushed(i));
                let before = [0, 1, 2].map(|a| free[a] - push[a]);
                [*x, *y, *z] = friction[i].slowed(free, dt);
                [weight_of(weights, i) * frame::work(before, free, [*x, *y, *z])]
            },
        );
        self.ledger.walls += p.mass * work;
    }

    /// A state with the particles and what the liquid needs; the method adds its own scalars.
    pub fn state(&self, own: &impl Columns) -> State {
        let mut state = State {
            time: self.now.time,
            step: self.now.step,
            particles: self.flow.particles.clone(),
            ..State::default()
        };
        self.now.save(&mut state);
        for (name, value) in self.effects.kept() {
            state.scalars.push((name.to_string(), value));
        }
        own.view(&mut Save(&mut state));
        state
    }

    /// Gives columns what a state has of them.
    pub fn load(state: &State, own: &mut impl Columns) {
        own.visit(&mut Load(state));
    }

    /// A frame with `named` scalars after those of the liquid: pairs of a name and a value.
    pub fn frame(
        &self,
        fields: &frame::Fields,
        named: impl IntoIterator<Item = (&'static str, f64)>,
    ) -> Frame {
        let named = named.into_iter().map(|(name, x)| (name.to_string(), x));
        let p = &self.flow.particles;
        frame::of(self.now.time, p, fields, named.collect())
    }

    /// What every frame has of mass, momentum, kg m/s, and the last step.
    pub fn progress(&self, [x, y, z]: [f64; 3]) -> [(&'static str, f64); 8] {
        let now = &self.now;
        [
            ("mass_kg", self.flow.total_mass()),
            ("mass_removed_kg", now.removed_mass),
            ("momentum_x_kg_m_s", x),
            ("momentum_y_kg_m_s", y),
            ("momentum_z_kg_m_s", z),
            ("speed_max_m_s", now.max_speed),
            ("time_step_s", now.last_step),
            ("steps", now.step as f64),
        ]
    }

    /// Bytes per particle: without neighbour rows, with them. `own`: columns of the method;
    /// `more`: bytes that it holds beside.
    pub fn memory(&self, own: &impl Columns, more: usize) -> (f64, f64) {
        let mut memory = Memory::default();
        own.view(&mut memory);
        let of_liquid = std::mem::size_of::<Hold>() * self.friction.capacity()
            + self.mist.capacity()
            + 24 * self.positions[0].capacity()
            + self.effects.memory();
        let bytes = (memory.bytes + of_liquid + more) as f64;
        let own = bytes / self.len().max(1) as f64;
        let (bare, whole) = self.flow.memory();
        (bare + own, whole + own)
    }
}
