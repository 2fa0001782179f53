//! Settings of the box, the effects and the method.

use super::super::resolve::{AXES, ENDS};
use super::super::{
    Colour, Density, KernelName, Mass, Method, Pairs, Precision, Pressure, Scene, Side, SoundSpeed,
    TensionForm, TensionStrength, TimeStepping, ViscosityForm, WallPressure, Wcsph, WettingForm,
};
use super::body::{form, motion, place};
use super::{List, Unit};
use super::{isph, mps};

/// Everything that the motion of the liquid depends on.
pub(super) fn physics(list: &mut List, scene: &Scene) {
    particle(list, scene);
    walls(list, scene);
    effects(list, scene, true);
    for (index, body) in scene.bodies.iter().enumerate() {
        let tag = format!("body[{index}]");
        form(list, scene, body, &tag);
        place(list, scene, body, &tag);
        motion(list, scene, body, &tag);
    }
    flow(list, scene, true);
    if let Method::Wcsph(settings) = &scene.method {
        sound(list, settings);
    }
}

/// What sets the speed of sound; bodies at rest have their own.
fn sound(list: &mut List, settings: &Wcsph) {
    list.number(
        "method.wcsph.sound_speed_factor",
        settings.sound_speed_factor,
        Unit::One,
    );
    if let Some(speed) = settings.reference_speed {
        list.number("method.wcsph.reference_speed", speed, Unit::Speed);
    }
}

pub(super) fn particle(list: &mut List, scene: &Scene) {
    list.count("dimension", scene.dimension.count() as u64);
    list.number("pack.spacing", scene.pack.spacing, Unit::Length);
    list.number("liquid.density", scene.density, Unit::Density);
    let mass = match scene.method.sph().mass {
        Mass::Nominal => "nominal",
        Mass::LatticeSum => "lattice-sum",
    };
    list.text(&own(scene, "mass"), SHARED[0], mass);
}

/// Mass, kernel and smoothing in canonical form: one for all methods, so that they share what they
/// pack, and the words of the first, so that what it packed stays fresh.
const SHARED: [&str; 3] = [
    "method.wcsph.mass",
    "method.wcsph.kernel",
    "method.wcsph.smoothing",
];

/// Name of a setting of the scene's method.
fn own(scene: &Scene, key: &str) -> String {
    format!("method.{}.{key}", scene.method.name())
}

pub(super) fn kernel(list: &mut List, scene: &Scene) {
    let settings = scene.method.sph();
    let kernel = match settings.kernel {
        KernelName::CubicSpline => "cubic-spline",
        KernelName::WendlandC2 => "wendland-c2",
    };
    list.text(&own(scene, "kernel"), SHARED[1], kernel);
    let (name, smoothing) = (own(scene, "smoothing"), settings.smoothing);
    list.numbers(&name, SHARED[2], &[smoothing], Unit::One);
}

/// The box and what its sides do.
pub(super) fn walls(list: &mut List, scene: &Scene) {
    let domain = &scene.domain;
    let axes = scene.dimension.axes();
    let size: Vec<f64> = axes.iter().map(|&axis| domain.size[axis]).collect();
    list.numbers("box.size", "box.size", &size, Unit::Length);
    for &axis in axes {
        let [low, high] = domain.boundary[axis].map(side);
        list.word(&format!("box.{}", AXES[axis]), &format!("{low}, {high}"));
        for (end, velocity) in domain.wall_velocity[axis].iter().enumerate() {
            if velocity.iter().any(|component| *component != 0.0) {
                let name = format!("box.wall_velocity.{}_{}", AXES[axis], ENDS[end]);
                let values: Vec<f64> = axes.iter().map(|&axis| velocity[axis]).collect();
                list.numbers(&name, &name, &values, Unit::Speed);
            }
        }
    }
}

fn side(side: Side) -> &'static str {
    match side {
        Side::Periodic => "periodic",
        Side::Open => "open",
        Side::Wall => "wall",
        Side::Mirror => "mirror",
    }
}

/// The effects that are there. A body that hangs free relaxes without gravity.
pub(super) fn effects(list: &mut List, scene: &Scene, falls: bool) {
    if let (Some(gravity), true) = (scene.effects.gravity, falls) {
        match gravity {
            [x, y, z] if x == 0.0 && y == 0.0 && z < 0.0 => {
                list.number("effects.gravity.acceleration", -z, Unit::Acceleration);
            }
            _ => {
                let name = "effects.gravity.direction";
                let axes = scene.dimension.axes().iter();
                let values: Vec<f64> = axes.map(|&axis| gravity[axis]).collect();
                list.numbers(name, name, &values, Unit::Acceleration);
            }
        }
    }
    if let Some(viscosity) = scene.effects.viscosity {
        list.number("effects.viscosity.dynamic", viscosity, Unit::Viscosity);
        // The Laplacian of MPS has one form.
        if let Method::Mps(_) = scene.method {
            tension(list, scene);
            return wetting(list, scene, falls);
        }
        let form = match scene.method.sph().viscosity_form {
            ViscosityForm::TwoTerm => "two-term",
            ViscosityForm::TwoTermExact => "two-term-exact",
            ViscosityForm::Morris => "morris",
            ViscosityForm::Cleary => "cleary",
        };
        list.word("effects.viscosity.form", form);
    }
    tension(list, scene);
    wetting(list, scene, falls);
}

/// The tension, if the scene has it.
pub(super) fn tension(list: &mut List, scene: &Scene) {
    let Some(coefficient) = scene.effects.tension else {
        return;
    };
    let settings = scene.method.sph();
    list.number("effects.tension.coefficient", coefficient, Unit::Tension);
    let form = match settings.tension_form {
        TensionForm::NormalisedColour => "normalised-colour",
        TensionForm::RawColour => "raw-colour",
        TensionForm::SurfaceEnergy => "surface-energy",
        TensionForm::CahnHilliard => "cahn-hilliard",
        TensionForm::NumberDensity => "number-density",
        TensionForm::NumberDensityExact => "number-density-exact",
    };
    list.word("effects.tension.form", form);
    list.number(
        "effects.tension.smoothing",
        settings.tension_smoothing,
        Unit::One,
    );
    if settings.lifts_tension() {
        list.word("effects.tension.level", "surface");
    }
    match settings.tension_strength {
        TensionStrength::Fixed(strength) => {
            list.number("effects.tension.strength", strength, Unit::One);
        }
        TensionStrength::Flat => list.word("effects.tension.strength", "flat"),
        TensionStrength::Virial => list.word("effects.tension.strength", "virial"),
    }
}

/// The contact angles, if the scene has them and the body meets walls.
pub(super) fn wetting(list: &mut List, scene: &Scene, walled: bool) {
    if let (Some(wetting), true) = (scene.effects.wetting, walled) {
        match wetting.hysteresis {
            None => list.number("effects.wetting.angle", wetting.angle, Unit::Angle),
            Some([advancing, receding]) => {
                list.number("effects.wetting.advancing", advancing, Unit::Angle);
                list.number("effects.wetting.receding", receding, Unit::Angle);
            }
        }
        // The other form is not named: results that are older than this one stay fresh.
        if let WettingForm::ParticleTypes(layers) = scene.method.sph().wetting_form {
            list.word("effects.wetting.form", "particle-types");
            for (k, layer) in layers.into_iter().enumerate() {
                list.number(&format!("effects.wetting.layers.{k}"), layer, Unit::One);
            }
        }
    }
}

/// Settings of the solver. `walled`: the body can meet walls.
pub(super) fn flow(list: &mut List, scene: &Scene, walled: bool) {
    list.word("method.name", scene.method.name());
    pairs(list, scene);
    kernel(list, scene);
    match &scene.method {
        Method::Wcsph(settings) => {
            let has = [walled && has_wall(scene), scene.effects.tension.is_some()];
            wcsph(list, settings, has)
        }
        Method::Isph(settings) => isph::settings(list, settings),
        Method::Mps(settings) => mps::settings(list, settings),
    }
    cohesion(list, scene);
}

/// What tension holds of a surface. None is not named: older results stay fresh.
fn cohesion(list: &mut List, scene: &Scene) {
    let settings = scene.method.projection();
    let held = settings.map_or(0.0, |settings| settings.cohesion);
    if scene.effects.tension.is_some() && held > 0.0 {
        let name = format!("method.{}.cohesion", scene.method.name());
        list.number(&name, held, Unit::One);
    }
}

/// The defaults are not named: results that are older than these settings stay fresh.
pub(super) fn pairs(list: &mut List, scene: &Scene) {
    let (pairs, usual) = (scene.pairs, Pairs::default());
    if pairs.precision != usual.precision {
        let word = match pairs.precision {
            Precision::Single => "single",
            Precision::Mixed => "mixed",
            Precision::Double => "double",
        };
        list.word("method.precision", word);
    }
    if pairs.slack != usual.slack {
        list.number("method.slack", pairs.slack, Unit::One);
    }
}

fn has_wall(scene: &Scene) -> bool {
    let mut sides = scene.domain.boundary.iter().flatten();
    sides.any(|side| *side == Side::Wall)
}

fn wcsph(list: &mut List, settings: &Wcsph, [walled, pulled]: [bool; 2]) {
    match settings.density {
        Density::Summation => list.word("method.wcsph.density", "summation"),
        Density::Continuity {
            diffusion,
            compaction,
        } => {
            list.word("method.wcsph.density", "continuity");
            list.number(
                "method.wcsph.density.continuity.diffusion",
                diffusion,
                Unit::One,
            );
            if compaction.is_finite() {
                let name = "method.wcsph.density.continuity.compaction";
                list.number(name, compaction, Unit::One);
            }
        }
    }
    let pressure = match settings.pressure {
        Pressure::Clipped => "clipped",
        Pressure::Controlled => "controlled",
        Pressure::Signed => "signed",
        Pressure::Tearing => "tearing",
    };
    list.word("method.wcsph.pressure", pressure);
    let sound = match settings.sound_speed {
        SoundSpeed::Adaptive => "adaptive",
        SoundSpeed::Constant => "constant",
    };
    list.word("method.wcsph.sound_speed", sound);
    list.number("method.wcsph.exponent", settings.exponent, Unit::One);
    if walled {
        let wall_pressure = match settings.wall_pressure {
            WallPressure::Summation => "summation",
            WallPressure::Extrapolated => "extrapolated",
        };
        list.word("method.wcsph.wall_pressure", wall_pressure);
    }
    list.number("method.wcsph.shifting", settings.shifting, Unit::One);
    stepping(list, settings.time_stepping, pulled);
}

fn stepping(list: &mut List, stepping: TimeStepping, pulled: bool) {
    const KEY: &str = "method.wcsph.time_stepping";
    match stepping {
        TimeStepping::Fixed { step } => list.number(&format!("{KEY}.fixed.step"), step, Unit::Time),
        TimeStepping::Adaptive { safety, holds } => {
            list.number(&format!("{KEY}.adaptive.safety"), safety, Unit::One);
            if holds && pulled {
                list.word(&format!("{KEY}.adaptive.tension"), "held");
            }
        }
        TimeStepping::Dual {
            advective,
            acoustic,
        } => {
            list.number(&format!("{KEY}.dual.advective"), advective, Unit::One);
            list.number(&format!("{KEY}.dual.acoustic"), acoustic, Unit::One);
        }
    }
}

pub(super) fn colour(colour: Colour) -> &'static str {
    match colour {
        Colour::Body => "body",
        Colour::Speed => "speed",
        Colour::Pressure => "pressure",
    }
}
