//! Numbers derived from a scene: dimensionless numbers, particle counts, speed of sound, limits of
//! the time step. Printed before a run.

use std::fmt;

use super::driven;
use super::limit;
use super::quantity::{Unit, human};
use super::shape::lattice;
use super::{
    Arrangement, Density, Method, Motion, Pressure, Problem, Scene, Shape, Side, SoundSpeed,
    SpeedOf, Wcsph,
};

/// A number with its name and definition.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Short name: `We`, `acoustic`, or the name of a body.
    pub name: String,
    /// The value in SI units.
    pub value: f64,
    /// The value as text, with its unit.
    pub text: String,
    /// How it is computed, in symbols.
    pub definition: String,
}

/// Result of [`of`], in the order of printing: titles with rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Title and rows of each group.
    pub groups: Vec<(String, Vec<Row>)>,
}

impl Numbers {
    /// The value of the row with this name, in any group.
    pub fn get(&self, name: &str) -> Option<f64> {
        let mut rows = self.groups.iter().flat_map(|(_, rows)| rows);
        rows.find(|row| row.name == name).map(|row| row.value)
    }
}

impl fmt::Display for Numbers {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.groups.iter().flat_map(|(_, rows)| rows);
        let longest = |length: usize, row: &Row| length.max(row.name.chars().count());
        let name_width = rows.clone().fold(0, longest);
        let text_width = rows.fold(0, |length, row| length.max(row.text.chars().count()));
        for (title, rows) in &self.groups {
            writeln!(out, "{title}")?;
            for row in rows {
                let line = format!(
                    "  {:name_width$}  {:>text_width$}   {}",
                    row.name, row.text, row.definition
                );
                writeln!(out, "{}", line.trim_end())?;
            }
        }
        Ok(())
    }
}

/// Everything derived from a scene.
pub fn of(scene: &Scene) -> Numbers {
    let mut groups = vec![dimensionless(scene), particles(scene)];
    if let Some(settings) = wcsph(scene) {
        let factor = settings.sound_speed_factor;
        let speed = short(reference_speed(scene), Unit::Speed);
        let definition = format!("{factor} x reference speed {speed}");
        let sound = row("c", sound_speed(scene), Unit::Speed, &definition);
        groups.push(("Speed of sound".to_string(), vec![sound]));
    }
    let limits = limits(scene);
    groups.push(("Limits of the time step".to_string(), limits));
    groups.retain(|(_, rows)| !rows.is_empty());
    Numbers { groups }
}

/// Reference speed without motion and forces, m/s.
const IDLE: f64 = 0.1;

/// Sound speed of a body at rest in units of its own reference speed: density then varies by 0.1 %
/// where Mach 0.1 allows 1 %, so that the packed spacing survives.
const REST_STIFFNESS: f64 = 31.6;

/// Settings of WCSPH; other methods have no speed of sound.
fn wcsph(scene: &Problem) -> Option<&Wcsph> {
    match &scene.method {
        Method::Wcsph(settings) => Some(settings),
        Method::Isph(_) | Method::Mps(_) => None,
    }
}

/// Smoothing length h, m.
pub fn smoothing_length(scene: &Problem) -> f64 {
    scene.method.sph().smoothing * scene.spacing
}

/// Largest initial speed of a body, or of a body towards another, m/s.
pub fn impact_speed(scene: &Problem) -> f64 {
    let uniform = |motion: &Motion| match motion {
        Motion::Uniform(velocity) => *velocity,
        _ => [0.0; 3],
    };
    let mut speed: f64 = 0.0;
    for (index, body) in scene.bodies.iter().enumerate() {
        let radius = body.shape.equivalent_radius(&scene.domain, scene.dimension);
        speed = speed.max(match body.motion {
            Motion::Uniform(velocity) => length(velocity),
            Motion::TaylorGreen { speed } => speed,
            Motion::Stretch { rate } => rate.abs() * radius,
        });
        for other in &scene.bodies[..index] {
            let (a, b) = (uniform(&body.motion), uniform(&other.motion));
            speed = speed.max(length(std::array::from_fn(|axis| a[axis] - b[axis])));
        }
    }
    speed
}

/// Length of a vector.
pub fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|each| each * each).sum::<f64>().sqrt()
}

/// The speed V of Nishio et al. 2010, Eq. 8, m/s: as set, or the largest of the impact speed, the
/// speed of a fall through the liquid's height sqrt(2 g T), the speed sqrt(8 sigma / (rho R)) at
/// which the smallest drop oscillates, and those of sliding walls and of [`driven`] liquid.
pub fn reference_speed(scene: &Problem) -> f64 {
    match wcsph(scene).map(|settings| settings.reference_speed) {
        Some(SpeedOf::Given(speed)) => speed,
        _ => impact_speed(scene)
            .max(standing_speed(scene))
            .max(driven::speed(scene)),
    }
}

/// [`reference_speed`] without the impact, m/s.
fn standing_speed(scene: &Problem) -> f64 {
    let walls = scene.domain.wall_velocity.iter().flatten();
    let sliding = walls.fold(0.0, |speed: f64, wall| speed.max(length(*wall)));
    let shapes = scene.bodies.iter().map(|body| &body.shape);
    let speed = shapes.fold(sliding.max(scene.layer_speed()), |speed, shape| {
        let fall = fall_speed(scene, shape);
        speed.max(fall).max(RIPPLE * capillary_speed(scene, shape))
    });
    moving(speed)
}

/// Least and largest speed of sound in the impact, m/s.
pub fn sound_speeds(scene: &Problem) -> [f64; 2] {
    let most = sound_speed(scene);
    let Some(settings) = wcsph(scene) else {
        return [most; 2];
    };
    let follows = settings.sound_speed == SoundSpeed::Adaptive
        && settings.pressure != Pressure::Clipped
        && matches!(settings.density, Density::Continuity { .. })
        && settings.time_stepping.is_dual();
    let [least, driven] = [standing_speed(scene), driven::most(scene)]
        .map(|speed| settings.sound_speed_factor * speed);
    match settings.reference_speed {
        _ if !follows => [most; 2],
        SpeedOf::Given(_) => [least.min(most), most],
        SpeedOf::Scene => [least, most.max(driven)],
    }
}

/// Speed of sound, m/s: factor x reference speed; infinite in an incompressible liquid.
pub fn sound_speed(scene: &Problem) -> f64 {
    wcsph(scene).map_or(f64::INFINITY, |settings| {
        settings.sound_speed_factor * reference_speed(scene)
    })
}

/// Speed of sound for the relaxation of one body at rest, m/s. It does not depend on the impact
/// speed, the stiffness of the impact or other bodies, and for a free body not on gravity, so
/// that a relaxed body can start every impact.
pub fn rest_sound_speed(scene: &Problem) -> f64 {
    let shape = &scene.bodies[0].shape;
    let fall = if shape.is_free() {
        0.0
    } else {
        fall_speed(scene, shape)
    };
    let stiff = REST_STIFFNESS * moving(capillary_speed(scene, shape).max(fall));
    stiff.max(10.0 * scene.layer_speed())
}

/// sqrt(2 a T) of the strongest body force a, T from the downhill side of the box to the far end of
/// the shape. An axis that is periodic has no downhill side.
fn fall_speed(scene: &Problem, shape: &Shape) -> f64 {
    let (low, high) = shape.bounds(&scene.domain, scene.dimension);
    let walled = |axis: &&usize| scene.domain.boundary[**axis][0] != Side::Periodic;
    let fall = |force: [f64; 3]| {
        let energy = scene.dimension.axes().iter().filter(walled).map(|&axis| {
            let height = match force[axis] < 0.0 {
                true => high[axis],
                false => scene.domain.size[axis] - low[axis],
            };
            force[axis].abs() * height
        });
        (2.0 * energy.sum::<f64>()).sqrt()
    };
    let forces = scene.effects.body_forces().into_iter();
    forces.map(fall).fold(0.0, f64::max)
}

/// omega R of the second mode of a drop over [`capillary_speed`], omega^2 = 8 sigma / (rho R^3)
/// (Lamb 1932, art. 275): at Mach 0.1 of this the period is that of an incompressible drop within
/// 1 %.
const RIPPLE: f64 = 2.0;

/// sqrt(2 sigma / (rho R)), m/s: the speed whose rho v^2 is the pressure in a drop.
fn capillary_speed(scene: &Problem, shape: &Shape) -> f64 {
    match (scene.effects.sigma(), shape) {
        (None, _) | (_, Shape::Layer { .. }) => 0.0,
        (Some(tension), _) => {
            let radius = shape.equivalent_radius(&scene.domain, scene.dimension);
            (2.0 * tension / (scene.density * radius)).sqrt()
        }
    }
}

/// `speed`, or [`IDLE`] if nothing moves. Not from `impact.end`: a longer run continues a shorter
/// one.
fn moving(speed: f64) -> f64 {
    if speed > 0.0 { speed } else { IDLE }
}

/// Number of particles of a body. Exact for lattices; else the body's volume over that of a
/// particle.
pub fn count(scene: &Scene, body: usize) -> u64 {
    let shape = &scene.bodies[body].shape;
    let spacing = scene.spacing;
    if scene.pack.arrangement == Arrangement::Poisson {
        let cell = spacing.powi(scene.dimension.count() as i32);
        let volume = shape.volume(&scene.domain, scene.dimension);
        return (volume / cell).round() as u64;
    }
    let [x, y, _] = shape.cuts(&scene.domain).map(|side| side.is_some());
    match shape {
        Shape::Sphere { radius, .. } => lattice(scene.dimension, [radius / spacing; 3], [x, y]),
        Shape::Ellipsoid { semi_axes, .. } => {
            let semi_axes = semi_axes.map(|axis| axis / spacing);
            lattice(scene.dimension, semi_axes, [x, y])
        }
        _ => {
            let (low, high) = shape.bounds(&scene.domain, scene.dimension);
            let along = |&axis: &usize| ((high[axis] - low[axis]) / spacing).round() as u64;
            scene.dimension.axes().iter().map(along).product()
        }
    }
}

/// Limits of the time step ([`limit`]), s, least first; those of absent effects are absent.
pub fn limits(scene: &Problem) -> Vec<Row> {
    let h = smoothing_length(scene);
    let speed = reference_speed(scene);
    let sound = sound_speed(scene);
    let of = |name: &str, value: f64, definition: &str| row(name, value, Unit::Time, definition);
    let cross = scene.spacing / speed;
    let mut limits = match scene.method.projection() {
        None => vec![
            of(
                "acoustic",
                limit::acoustic(h, sound, speed),
                "0.25 h / (c + V)",
            ),
            of("advective", 0.25 * cross, "0.25 s0 / V"),
        ],
        Some(settings) => {
            let value = (settings.courant * cross).clamp(settings.shortest, settings.longest);
            vec![of("advective", value, "courant s0 / V")]
        }
    };
    if let Some(stiff) = scene.stiff_viscosity() {
        let value = limit::viscous(h, scene.density, stiff);
        limits.push(of(
            "viscous",
            value,
            "0.125 h^2 / nu, less of stiffer forms",
        ));
    }
    if let Some(tension) = scene.effects.sigma() {
        let value = limit::capillary(h, scene.density, tension);
        limits.push(of("capillary", value, "0.25 sqrt(rho h^3 / (2 pi sigma))"));
    }
    let forces = scene.effects.body_forces().into_iter().map(length);
    if let Some(strongest) = forces.reduce(f64::max) {
        let value = limit::force(h, strongest);
        limits.push(of("force", value, "0.25 sqrt(h / g)"));
    }
    limits.sort_by(|a, b| a.value.total_cmp(&b.value));
    limits
}

/// Diameter of equal volume of the drop, m: of the fastest free body.
pub fn drop_diameter(scene: &Problem) -> Option<f64> {
    let speed = |motion: &Motion| match motion {
        Motion::Uniform(velocity) => length(*velocity),
        _ => 0.0,
    };
    let drops = scene.bodies.iter().filter(|body| body.shape.is_free());
    let fastest = drops.fold(None, |best: Option<&super::Body>, body| match best {
        Some(other) if speed(&other.motion) >= speed(&body.motion) => best,
        _ => Some(body),
    });
    let radius = |body: &super::Body| body.shape.equivalent_radius(&scene.domain, scene.dimension);
    fastest.map(|body| 2.0 * radius(body))
}

fn dimensionless(scene: &Scene) -> (String, Vec<Row>) {
    let Some(d) = drop_diameter(scene) else {
        return (String::new(), Vec::new());
    };
    let u = impact_speed(scene);
    let rho = scene.density;
    let moving = u > 0.0;
    let mut rows = Vec::new();
    let mut push = |name: &str, value: f64, definition: &str| {
        rows.push(Row {
            name: name.to_string(),
            value,
            text: digits(value),
            definition: definition.to_string(),
        });
    };
    let gravity = scene.effects.gravity.map(length);
    if let (Some(sigma), true) = (scene.effects.sigma(), moving) {
        push("We", rho * u * u * d / sigma, "rho U^2 d / sigma");
    }
    if let (Some(mu), true) = (scene.effects.mu(), moving) {
        push("Re", rho * u * d / mu, "rho U d / mu");
    }
    if let (Some(mu), Some(sigma)) = (scene.effects.mu(), scene.effects.sigma()) {
        push(
            "Oh",
            mu / (rho * sigma * d).sqrt(),
            "mu / sqrt(rho sigma d)",
        );
    }
    if let (Some(g), true) = (gravity, moving) {
        push("Fr", u * u / (g * d), "U^2 / (g d)");
    }
    if let (Some(g), Some(sigma)) = (gravity, scene.effects.sigma()) {
        push("Bo", rho * g * d * d / 4.0 / sigma, "rho g (d/2)^2 / sigma");
    }
    if let Some(depth) = scene.pool_depth() {
        push("T/d", depth / d, "depth of the layer / d");
    }
    push("d/s0", d / scene.spacing, "particles across the drop");
    let title = format!(
        "Dimensionless numbers (d = {}, U = {})",
        short(d, Unit::Length),
        short(u, Unit::Speed)
    );
    (title, rows)
}

fn particles(scene: &Scene) -> (String, Vec<Row>) {
    let rows = scene.bodies.iter().enumerate().map(|(index, body)| {
        let count = count(scene, index);
        Row {
            name: body.name.clone(),
            value: count as f64,
            text: count.to_string(),
            definition: String::new(),
        }
    });
    let title = format!("Particles (s0 = {})", short(scene.spacing, Unit::Length));
    (title, rows.collect())
}

fn row(name: &str, value: f64, unit: Unit, definition: &str) -> Row {
    Row {
        name: name.to_string(),
        value,
        text: short(value, unit),
        definition: definition.to_string(),
    }
}

/// Three digits with a unit.
pub(super) fn short(value: f64, unit: Unit) -> String {
    human(format!("{value:.2e}").parse().unwrap_or(value), unit)
}

/// Three digits, plain unless far from 1; whole above 100.
fn digits(value: f64) -> String {
    let magnitude = value.abs();
    if (100.0..1e7).contains(&magnitude) {
        format!("{value:.0}")
    } else if (1e-2..100.0).contains(&magnitude) {
        format!("{}", format!("{value:.2e}").parse().unwrap_or(value))
    } else {
        format!("{value:.2e}")
    }
}
