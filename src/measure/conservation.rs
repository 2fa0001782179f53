//! Checks that hold in every run: mass, momentum, energy, walls, finite numbers.
//!
//! Every figure is a dimensionless deviation, zero at best, so that a promise is an upper bound.
//! Scales: the mass M of the first frame and the reference speed V of the scene (largest of impact,
//! fall and capillary speed, see [`reference_speed`]). A figure that a scene does not have is NaN.
//! For a part of a symmetric scene all figures are those of the whole.

use super::series::Series;
use super::summary::total_energy;
use super::whole::Unfold;
use crate::particle::Frame;
use crate::scene::numbers::{length, reference_speed};
use crate::scene::{Method, Pressure, Scene, Side, TensionForm};

/// Names and meanings of all figures.
pub const FIGURES: [(&str, &str); 10] = [
    (
        "not_a_number",
        "values of all frames that are not finite numbers",
    ),
    (
        "mass_error",
        "largest difference between particles now plus those removed and those at first",
    ),
    (
        "wall_crossing",
        "largest distance of a particle beyond a wall of the box, in spacings",
    ),
    (
        "energy_growth",
        "largest rise of kinetic, potential, compression and surface energy above their first \
         sum, over M V^2 / 2",
    ),
    (
        "energy_unexplained",
        "largest unexplained gain of energy, what the pressure of ISPH and MPS has given \
         included, over the initial energy: kinetic, surface and the fall of potential energy, at \
         least M g s0; not of a tension without an energy",
    ),
    (
        "energy_unexplained_end",
        "unexplained gain or loss of energy at the end, over the initial energy",
    ),
    (
        "momentum_change",
        "largest change of the momentum while no particle has left, over M V",
    ),
    (
        "capillary_number",
        "viscosity times largest speed in the second half of the run, over the tension",
    ),
    (
        "unrest",
        "largest kinetic energy in the last quarter, over M g s0",
    ),
    ("removed", "part of the mass that left the box"),
];

/// Upper bounds of figures in every run that has them, unless its study states another one.
pub const ALWAYS: [(&str, f64); 4] = [
    ("not_a_number", 0.0),
    ("mass_error", 0.0),
    ("wall_crossing", 1.0),
    ("energy_unexplained", 0.005),
];

/// Processes the frames of a run in their order.
pub struct Conservation<'a> {
    scene: &'a Scene,
    unfold: Unfold,
    /// Particles and mass of one, kg, in the first frame.
    first: Option<(f64, f64)>,
    strange: f64,
    mass_error: f64,
    /// m.
    crossing: f64,
}

impl<'a> Conservation<'a> {
    /// A check of the frames of `scene`.
    pub fn new(scene: &'a Scene) -> Self {
        Conservation {
            scene,
            unfold: Unfold::new(scene),
            first: None,
            strange: 0.0,
            mass_error: 0.0,
            crossing: 0.0,
        }
    }

    /// Takes the next frame into account.
    pub fn take(&mut self, frame: &Frame) {
        let whole = self.unfold.whole(frame);
        self.take_whole(&whole);
    }

    fn take_whole(&mut self, frame: &Frame) {
        let fields = frame.position.iter().chain(&frame.velocity);
        let fields = fields.chain([&frame.pressure, &frame.density]);
        let strange = fields.flatten().filter(|value| !value.is_finite()).count();
        let scalars = frame.scalars.iter().filter(|(_, v)| !v.is_finite()).count();
        self.strange += (strange + scalars) as f64;

        let scalar = |name: &str| frame.scalars.iter().find(|s| s.0 == name).map(|s| s.1);
        let ids = frame.id.len() as f64;
        if let (Some(total), Some(removed)) = (scalar("mass_kg"), scalar("mass_removed_kg")) {
            let (first, mass) = *self.first.get_or_insert((ids, total / ids));
            // Rings split and merge: what stays is their mass.
            let count = match self.scene.domain.is_axial() {
                true => total / mass,
                false => ids,
            };
            let error = ((count + removed / mass) - first).abs();
            // Round-off of a sum of masses is not a lost particle.
            let error = if error < 1e-6 * first { 0.0 } else { error };
            self.mass_error = self.mass_error.max(error);
        }

        let (domain, axes) = (&self.scene.whole().domain, self.scene.dimension.axes());
        for &axis in axes {
            let [low, high] = domain.boundary[axis];
            for x in frame.position[axis].iter().map(|x| f64::from(*x)) {
                if low == Side::Wall {
                    self.crossing = self.crossing.max(-x);
                }
                if high == Side::Wall {
                    self.crossing = self.crossing.max(x - domain.size[axis]);
                }
            }
        }
    }

    /// All figures in the order of [`FIGURES`]; `measures`: the table of the run.
    pub fn figures(&self, measures: &Series) -> Vec<(&'static str, f64)> {
        let scene = self.scene;
        let mass = self.first.map_or(f64::NAN, |(count, mass)| count * mass);
        let speed = reference_speed(scene);
        let viscosity = scene.effects.mu().unwrap_or(f64::NAN);
        let tension = scene.effects.sigma().unwrap_or(f64::NAN);
        let gravity = scene.effects.gravity.map_or(f64::NAN, length);
        let removed = last(measures, "mass_removed_kg");
        let end = measures.time().last().copied().unwrap_or(f64::NAN);
        let late = |part: f64, column: &str| {
            let window = measures.window(part * end, f64::INFINITY);
            window.maximum(column).map_or(f64::NAN, |(value, _)| value)
        };
        let unexplained = unexplained_part(scene, measures, mass);
        let values = [
            self.strange,
            self.mass_error,
            self.crossing / scene.spacing,
            energy_growth(measures, &scene.method) / (0.5 * mass * speed * speed),
            unexplained[0],
            unexplained[1],
            momentum_change(measures) / (mass * speed),
            viscosity * late(0.5, "speed_max_m_s") / tension,
            late(0.75, "kinetic_energy_J") / (mass * gravity * scene.spacing),
            removed / mass,
        ];
        let names = FIGURES.iter().map(|(name, _)| *name);
        names.zip(values).collect()
    }
}

fn last(measures: &Series, column: &str) -> f64 {
    let values = measures.column(column).unwrap_or(&[]);
    values.last().copied().unwrap_or(f64::NAN)
}

/// Compression energy, J. Where negative pressure is clipped, a thinned surface stores no energy:
/// it is left out there.
fn energy_growth(measures: &Series, method: &Method) -> f64 {
    let Some(mut total) = total_energy(measures) else {
        return f64::NAN;
    };
    let stores = !matches!(method, Method::Wcsph(s) if s.pressure == Pressure::Clipped);
    if let Some(compression) = measures.column("compression_energy_J").filter(|_| stores) {
        total.iter_mut().zip(compression).for_each(|(e, c)| *e += c);
    }
    let first = total.first().copied().unwrap_or(f64::NAN);
    total.iter().fold(0.0, |most: f64, e| most.max(e - first))
}

/// The largest unexplained gain of energy and its size at the end, over the initial energy; NaN
/// with a tension that is a stress, which has no energy for the budget. `mass`: of the first frame,
/// kg.
pub fn unexplained_part(scene: &Scene, measures: &Series, mass: f64) -> [f64; 2] {
    let unexplained = measures.column("energy_unexplained_J");
    let (Some(unexplained), Some(whole)) = (unexplained, turnover(scene, measures, mass)) else {
        return [f64::NAN; 2];
    };
    // A pressure that should do no work gives energy only at the cost of what it took.
    let pressed = measures.column("pressure_work_J").unwrap_or(&[]);
    let pressed = pressed.iter().map(|work| work.max(0.0));
    let gains = unexplained
        .iter()
        .zip(pressed.chain(std::iter::repeat(0.0)));
    let most = gains.map(|(gain, given)| gain + given).fold(0.0, f64::max);
    [most, last(measures, "energy_unexplained_J").abs()].map(|e| e / whole)
}

/// The most work of the pressure of a projection, which should do none, and the most that it gave,
/// over the same energy; `None` without it.
pub fn pressed_parts(scene: &Scene, measures: &Series, mass: f64) -> Option<[f64; 2]> {
    let pressed = measures.column("pressure_work_J")?;
    let whole = turnover(scene, measures, mass)?;
    let most = pressed
        .iter()
        .fold([0.0; 2], |[most, given]: [f64; 2], work| {
            [most.max(work.abs()), given.max(*work)]
        });
    Some(most.map(|work| work / whole))
}

/// The initial energy or, if that is more, the work of what drives or slows a flow, or the motion,
/// J; `None` if there is none, or with a tension without an energy. `mass`: of the first frame, kg.
fn turnover(scene: &Scene, measures: &Series, mass: f64) -> Option<f64> {
    let has_energy =
        scene.effects.tension.is_none() || scene.effects.has_tension(TensionForm::SurfaceEnergy);
    let gravity = scene.effects.gravity.map_or(f64::NAN, length);
    let least = mass * gravity * scene.spacing;
    let first = |name: &str| measures.column(name).map_or(0.0, |e| e[0]);
    let potential = measures.column("potential_energy_J").unwrap_or(&[]);
    let lowest = potential.iter().copied().fold(f64::INFINITY, f64::min);
    let fall = potential.first().map_or(0.0, |start| start - lowest);
    let start = first("kinetic_energy_J") + first("surface_energy_J") + fall;
    // What drives a flow, or slows it, may do more work than that; what should do none does not
    // count.
    let drives = |name: &&String| {
        name.ends_with("_work_J") && !["pressure_work_J", "removal_work_J"].contains(&name.as_str())
    };
    let driven = measures.names.iter().filter(drives);
    let work = driven.filter_map(|name| measures.column(name)).flatten();
    let moved = measures.column("kinetic_energy_J").unwrap_or(&[]);
    let whole = work
        .chain(moved)
        .fold(start.max(least), |most, e| e.abs().max(most));
    (has_energy && whole > 0.0).then_some(whole)
}

/// kg m/s.
fn momentum_change(measures: &Series) -> f64 {
    let parts = ["x", "y", "z"].map(|a| measures.column(&format!("momentum_{a}_kg_m_s")));
    let [Some(x), Some(y), Some(z)] = parts else {
        return f64::NAN;
    };
    let removed = measures.column("mass_removed_kg").unwrap_or(&[]);
    let whole = removed.iter().take_while(|mass| **mass == 0.0).count();
    let change = |k: usize| length([x[k] - x[0], y[k] - y[0], z[k] - z[0]]);
    (0..whole.min(x.len())).map(change).fold(0.0, f64::max)
}
