//! The jobs of a scene: for each body pack and relax, then calibrate, impact and post.

use std::path::Path;
use std::sync::OnceLock;

use anyhow::Result;
use coronet::method;
use coronet::pipeline::{Identity, Pipeline, Setting, Stage, Work};
use coronet::scene::Scene;
use coronet::scene::file::Loaded;
use coronet::scene::input::RelaxInput;

use crate::calibrate::Calibrate;
use crate::forecast;
use crate::impact::Impact;
use crate::live::Viewers;
use crate::pack::Pack;
use crate::post::Post;
use crate::probe::{self, Like};
use crate::relax::{LIMITS, Relax};
use crate::settings::{self, Forecast};

/// VERSION of each stage: is increased when the same settings give another result. What only some
/// scenes have is versioned by name, beside their settings, so that a change leaves the results of
/// other scenes fresh. The golden digests in `tests/pipeline/golden.rs` fail when numbers change
/// without a new version.
pub mod version {
    use coronet::particle::wall::Lattice;
    use coronet::particle::{completion, crowd};
    use coronet::pipeline::Setting;
    use coronet::scene::input::PackInput;
    use coronet::scene::{
        Density, Dimension, Domain, Method, Problem, Side, TensionForm, TimeStepping, driven,
    };

    /// Of packing.
    pub const PACK: u32 = 2;
    /// Of the calibration of the tension.
    pub const CALIBRATE: u32 = 9;
    /// Of relaxation and impact.
    pub const FLOW: u32 = 25;
    /// Of the evaluation.
    pub const POST: u32 = 26;

    /// Versions of the parts of the program that a relaxation or an impact uses.
    pub fn flow(problem: &Problem) -> Vec<Setting> {
        let mut parts = tension(problem);
        // Of how the work of a step is booked. 1: with the velocities at both its ends.
        parts.push(part("budget", 1));
        match &problem.method {
            Method::Wcsph(settings) => {
                parts.push(part("wcsph", 1));
                let is_dual = matches!(settings.time_stepping, TimeStepping::Dual { .. });
                if !is_dual && matches!(settings.density, Density::Continuity { .. }) {
                    parts.push(part("one-rate", 1));
                }
                if settings.exponent.fract() != 0.0 {
                    parts.push(part("exponent", 1));
                }
                let is_energetic = problem.effects.has_tension(TensionForm::SurfaceEnergy);
                let shifts = settings.shifting > 0.0 && !is_energetic;
                let is_inviscid = problem.effects.viscosity.is_none();
                if shifts && (is_inviscid || problem.effects.wetting.is_some()) {
                    parts.push(part("shifting", 1));
                }
            }
            // 3 and 4 were trials (docs/lab.md). 6: near pairs of spray, short limits.
            Method::Isph(_) => parts.push(part("isph", 6)),
            // 4: short limits.
            Method::Mps(_) => parts.push(part("mps", 4)),
        }
        if problem.domain.is_axial() {
            // 2: as often as rings cross a spacing; columns of stretched lattices.
            parts.push(part("adaption", 2));
        }
        if let Some(wetting) = problem.effects.wetting {
            parts.push(part("wetting", 2));
            if wetting.hysteresis.is_some() {
                // 2: relative to the wall, and across the line alone.
                parts.push(part("hysteresis", 2));
            }
        }
        // 1: of the eigenvalues of the form, and of the radius that MPS has for it.
        let dynamic = problem.effects.viscosity.map(|viscosity| viscosity.dynamic);
        if problem.stiff_viscosity() > dynamic {
            parts.push(part("viscous-limit", 1));
        }
        if problem.effects.vibration.is_some() {
            parts.push(part("vibration", 1));
        }
        if problem.has_wall() {
            parts.push(walls());
        }
        let has_wall = |axis: &&usize| problem.domain.boundary[**axis].contains(&Side::Wall);
        let walled = problem.dimension.axes().iter().filter(has_wall).count();
        // Of what is put back out of walls. 1: apart in corners, farther without a tension.
        if walled > 1 || walled > 0 && problem.effects.tension.is_none() {
            parts.push(part("put-back", 1));
        }
        if driven::speed(problem) > 0.0 {
            parts.push(part("driven", 1));
        }
        if problem.domain.wall_velocity.as_flattened().as_flattened() != [0.0; 18] {
            parts.push(part("sliding-walls", 1));
        }
        parts
    }

    /// Of the packing of a body.
    pub fn pack(input: &PackInput) -> Vec<Setting> {
        let mut parts = Vec::new();
        parts.extend(stretched(&input.domain, input.dimension, input.spacing));
        if crowd::wall_shift(input) != [0.0; 3] {
            parts.push(part("wall-rows", 1));
        }
        if completion::is_sharp(input) {
            parts.push(part("sharp", 1));
        }
        parts
    }

    /// Of walls in a box that is no whole number of spacings, for what else sees them.
    pub fn stretched(domain: &Domain, dimension: Dimension, spacing: f64) -> Option<Setting> {
        let is_stretched = Lattice::new(domain, dimension, spacing).is_stretched();
        (domain.has_wall() && is_stretched).then(walls)
    }

    fn walls() -> Setting {
        part("walls", 1)
    }

    /// Of the form of the tension.
    pub fn tension(problem: &Problem) -> Vec<Setting> {
        match problem.effects.tension.map(|tension| tension.form) {
            Some(TensionForm::NormalisedColour) => vec![part("normalised-colour", 1)],
            // 2: all the liquid counts.
            Some(TensionForm::SurfaceEnergy) => match problem.dimension {
                Dimension::Two => vec![part("surface-energy", 2)],
                Dimension::Three => vec![part("surface-energy", 1)],
            },
            _ => Vec::new(),
        }
    }

    /// Of what the log of an impact holds besides the particles. Rings have areas.
    pub fn log(problem: &Problem) -> Setting {
        match problem.domain.is_axial() {
            true => part("log", 5),
            false => part("log", 4),
        }
    }

    fn part(name: &str, version: u32) -> Setting {
        let name = format!("version.{name}");
        Setting {
            canonical: format!("{name}={version}").into_bytes(),
            shown: version.to_string(),
            name,
        }
    }
}

/// The jobs of a scene, in an order in which they can run.
pub fn pipeline(loaded: &Loaded) -> Result<Pipeline<'_>> {
    watched(loaded, None)
}

/// [`pipeline`], for viewers of the impact.
pub fn watched(loaded: &Loaded, viewers: Option<Viewers>) -> Result<Pipeline<'_>> {
    let scene = &loaded.scene;
    let mut jobs: Vec<Box<dyn Stage + '_>> = Vec::new();
    let (mut packed, mut bodies, mut relaxed) = (Vec::new(), Vec::new(), Vec::new());
    for body in 0..scene.bodies.len() {
        jobs.push(pack(scene, body)?);
        packed.push(jobs.len() - 1);
        if let Some(input) = scene.relax_input(body) {
            jobs.push(relax(scene, body, input, jobs.len() - 1)?);
            relaxed.push(jobs.len() - 1);
        }
        bodies.push(jobs.len() - 1);
    }
    let mut calibration = None;
    if let Some(input) = scene.calibrate_input() {
        let mut settings = settings::list(&input, scene)?;
        settings.extend(version::tension(scene));
        settings.extend(version::stretched(
            &scene.domain,
            scene.dimension,
            scene.spacing,
        ));
        jobs.push(Box::new(Calibrate {
            input,
            bodies: match method::is_of_packing(scene) {
                true => packed,
                false => bodies.clone(),
            },
            forecast: later(scene, Like::Machine, forecast::calibrate),
            identity: identity("calibrate", "", version::CALIBRATE, settings),
        }));
        calibration = Some(jobs.len() - 1);
    }
    let input = scene.impact_input();
    let mut settings = settings::list(&input, scene)?;
    settings.extend(version::flow(scene));
    settings.push(version::log(scene));
    jobs.push(Box::new(Impact {
        input,
        checkpoint_every: scene.impact.checkpoint_every,
        text: &loaded.text,
        bodies,
        calibration,
        viewers,
        forecast: later(scene, Like::Impact, forecast::impact),
        identity: identity("impact", "", version::FLOW, settings),
    }));
    let folder = loaded.path.parent().unwrap_or(Path::new("."));
    let input = scene.post_input(folder)?;
    let mut settings = settings::list(&input, scene)?;
    // It tells whether the bodies were at rest, by limits that are the same for all.
    if let Some(first) = relaxed.first() {
        let all = jobs[*first].settings().into_iter();
        settings.extend(all.filter(|setting| LIMITS.contains(&&*setting.name)));
    }
    jobs.push(Box::new(Post {
        input,
        folder,
        text: &loaded.text,
        impact: jobs.len() - 1,
        relaxed,
        forecast: later(scene, Like::Machine, forecast::post),
        identity: identity("post", "", version::POST, settings),
    }));
    Ok(Pipeline {
        name: scene.name.clone(),
        jobs,
    })
}

/// The cost of a job, computed once, on demand.
fn later<'a>(
    scene: &'a Scene,
    like: Like,
    work: impl Fn(&Scene) -> Option<Work> + Sync + 'a,
) -> Forecast<'a> {
    let known = OnceLock::new();
    Box::new(move || {
        let known = known.get_or_init(|| work(scene).map(|w| probe::adjusted(w, scene, like)));
        *known
    })
}

fn identity(name: &'static str, part: &str, version: u32, settings: Vec<Setting>) -> Identity {
    Identity {
        name,
        part: part.to_string(),
        version,
        settings,
    }
}

fn pack(scene: &Scene, body: usize) -> Result<Box<dyn Stage + '_>> {
    let input = scene.pack_input(body);
    let mut settings = settings::list(&input, &scene.resting(body))?;
    settings.extend(version::pack(&input));
    Ok(Box::new(Pack {
        identity: identity("pack", &input.name, version::PACK, settings),
        input,
        body,
        forecast: later(scene, Like::Machine, move |scene| {
            forecast::pack(scene, body)
        }),
    }))
}

fn relax(
    scene: &Scene,
    body: usize,
    input: RelaxInput,
    pack: usize,
) -> Result<Box<dyn Stage + '_>> {
    let mut settings = settings::list(&input, &input.problem)?;
    settings.extend(version::flow(&input.problem));
    let part = &scene.bodies[body].name;
    Ok(Box::new(Relax {
        identity: identity("relax", part, version::FLOW, settings),
        input,
        body,
        checkpoint_every: scene.impact.checkpoint_every,
        pack,
        forecast: later(scene, Like::Relax(body), move |scene| {
            forecast::relax(scene, body)
        }),
    }))
}
