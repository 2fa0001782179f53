//! The jobs of a scene: for each body pack and relax, then calibrate, impact and post.

use std::path::Path;

use anyhow::Result;
use coronet::method;
use coronet::pipeline::{Identity, Pipeline, Setting, Stage, Work};
use coronet::scene::Scene;
use coronet::scene::file::Loaded;
use coronet::scene::input::RelaxInput;

use crate::calibrate::Calibrate;
use crate::impact::Impact;
use crate::pack::Pack;
use crate::post::Post;
use crate::relax::Relax;
use crate::settings::{self, Forecast};
use crate::{forecast, probe};

/// VERSION of each stage: is increased when the same settings give another result. The golden
/// digests in `tests/pipeline/golden.rs` fail when numbers change without a new version.
pub mod version {
    use coronet::scene::{Density, Gradient, Method, Problem, TensionForm, TimeStepping};

    pub const PACK: u32 = 2;
    const CALIBRATE: u32 = 7;
    pub const POST: u32 = 10;
    const FLOW: u32 = 19;

    /// Of what only scenes with a contact angle, with its hysteresis, with the normalised colour,
    /// with a tension that has an energy, with MPS, with a corrected gradient, with WCSPH or with
    /// the continuity equation at one rate have.
    const WETTING: u32 = 2;
    const HYSTERESIS: u32 = 1;
    const NORMALISED: u32 = 1;
    const ENERGY: u32 = 1;
    const MPS: u32 = 1;
    const CORRECTED: u32 = 1;
    const WCSPH: u32 = 1;
    const ONE_RATE: u32 = 1;

    fn normalised(problem: &Problem) -> u32 {
        let form = TensionForm::NormalisedColour;
        NORMALISED * u32::from(problem.effects.has_tension(form))
    }

    fn energetic(problem: &Problem) -> u32 {
        let form = TensionForm::SurfaceEnergy;
        ENERGY * u32::from(problem.effects.has_tension(form))
    }

    pub fn calibrate(scene: &Problem) -> u32 {
        CALIBRATE + normalised(scene) + energetic(scene)
    }

    /// Of relaxation and impact: the sum of what a scene has, so that a change leaves the results
    /// of other scenes fresh.
    pub fn flow(scene: &Problem) -> u32 {
        let wets = scene.effects.wetting.is_some();
        let rubs = scene
            .effects
            .wetting
            .is_some_and(|w| w.hysteresis.is_some());
        let of_method = match &scene.method {
            Method::Wcsph(settings) => match (settings.time_stepping, settings.density) {
                (TimeStepping::Dual { .. }, _) | (_, Density::Summation) => WCSPH,
                (_, Density::Continuity { .. }) => WCSPH + ONE_RATE,
            },
            Method::Isph(settings) => {
                CORRECTED * u32::from(settings.gradient == Gradient::Corrected)
            }
            Method::Mps(settings) => MPS + CORRECTED * u32::from(settings.gradient.is_corrected()),
        };
        FLOW + of_method
            + WETTING * u32::from(wets)
            + HYSTERESIS * u32::from(rubs)
            + normalised(scene)
            + energetic(scene)
    }
}

/// The jobs of a scene, in an order in which they can run.
pub fn pipeline(loaded: &Loaded) -> Result<Pipeline<'_>> {
    let scene = &loaded.scene;
    let mut jobs: Vec<Box<dyn Stage + '_>> = Vec::new();
    let (mut packed, mut bodies) = (Vec::new(), Vec::new());
    for body in 0..scene.bodies.len() {
        jobs.push(pack(scene, body)?);
        packed.push(jobs.len() - 1);
        if let Some(input) = scene.relax_input(body) {
            jobs.push(relax(scene, body, input, jobs.len() - 1)?);
        }
        bodies.push(jobs.len() - 1);
    }
    let mut calibration = None;
    if let Some(input) = scene.calibrate_input() {
        let settings = settings::list(&input, scene)?;
        jobs.push(Box::new(Calibrate {
            input,
            bodies: match method::is_of_packing(scene) {
                true => packed,
                false => bodies.clone(),
            },
            forecast: later(move || forecast::calibrate(scene)),
            identity: identity("calibrate", "", version::calibrate(scene), settings),
        }));
        calibration = Some(jobs.len() - 1);
    }
    let input = scene.impact_input();
    let settings = settings::list(&input, scene)?;
    jobs.push(Box::new(Impact {
        input,
        checkpoint_every: scene.impact.checkpoint_every,
        text: &loaded.text,
        bodies,
        calibration,
        forecast: later(move || forecast::impact(scene)),
        identity: identity("impact", "", version::flow(scene), settings),
    }));
    let folder = loaded.path.parent().unwrap_or(Path::new("."));
    let input = scene.post_input(folder)?;
    let settings = settings::list(&input, scene)?;
    jobs.push(Box::new(Post {
        input,
        folder,
        text: &loaded.text,
        impact: jobs.len() - 1,
        forecast: later(move || forecast::post(scene)),
        identity: identity("post", "", version::POST, settings),
    }));
    Ok(Pipeline {
        name: scene.name.clone(),
        jobs,
    })
}

/// The cost of a job, computed on demand.
fn later<'a>(work: impl Fn() -> Option<Work> + Sync + 'a) -> Forecast<'a> {
    Box::new(move || work().map(probe::adjusted))
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
    let settings = settings::list(&input, &scene.resting(body))?;
    Ok(Box::new(Pack {
        identity: identity("pack", &input.name, version::PACK, settings),
        input,
        forecast: later(move || forecast::pack(scene, body)),
    }))
}

fn relax(
    scene: &Scene,
    body: usize,
    input: RelaxInput,
    pack: usize,
) -> Result<Box<dyn Stage + '_>> {
    let settings = settings::list(&input, &input.problem)?;
    let part = &scene.bodies[body].name;
    Ok(Box::new(Relax {
        identity: identity("relax", part, version::flow(&input.problem), settings),
        input,
        checkpoint_every: scene.impact.checkpoint_every,
        pack,
        forecast: later(move || forecast::relax(scene, body)),
    }))
}
