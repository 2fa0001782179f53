//! The jobs of a scene: for each body pack and relax, then calibrate, impact and post.

use std::path::Path;

use anyhow::Result;
use coronet::method;
use coronet::pipeline::{Identity, Pipeline, Stage};
use coronet::scene::file::Loaded;
use coronet::scene::key::{self, Setting};

use crate::calibrate::Calibrate;
use crate::impact::Impact;
use crate::pack::Pack;
use crate::post::Post;
use crate::relax::Relax;
use crate::settings::list;

/// VERSION of each stage: grows whenever the same settings give another result. The golden digests
/// in `tests/pipeline/golden.rs` fail when numbers change while these stand still.
pub mod version {
    use coronet::scene::{Density, Gradient, Method, Scene, TensionForm, TimeStepping};

    pub const PACK: u32 = 2;
    const CALIBRATE: u32 = 7;
    pub const POST: u32 = 10;
    const FLOW: u32 = 18;

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

    fn normalised(scene: &Scene) -> u32 {
        let form = scene.method.sph().tension_form;
        let is = scene.effects.tension.is_some() && form == TensionForm::NormalisedColour;
        NORMALISED * u32::from(is)
    }

    fn energetic(scene: &Scene) -> u32 {
        let form = scene.method.sph().tension_form;
        let is = scene.effects.tension.is_some() && form == TensionForm::SurfaceEnergy;
        ENERGY * u32::from(is)
    }

    pub fn calibrate(scene: &Scene) -> u32 {
        CALIBRATE + normalised(scene) + energetic(scene)
    }

    /// Of relaxation and impact: the sum of what a scene has, so that a change leaves the results
    /// of other scenes fresh.
    pub fn flow(scene: &Scene) -> u32 {
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

fn identity(name: &'static str, part: &str, version: u32, settings: Vec<Setting>) -> Identity {
    Identity {
        name,
        part: part.to_string(),
        version,
        settings: list(settings),
    }
}

/// The jobs of a scene, in an order in which they can run.
pub fn pipeline(loaded: &Loaded) -> Result<Pipeline<'_>> {
    let scene = &loaded.scene;
    let mut jobs: Vec<Box<dyn Stage + '_>> = Vec::new();
    let (mut packed, mut bodies) = (Vec::new(), Vec::new());
    for body in 0..scene.bodies.len() {
        let part = scene.bodies[body].name.as_str();
        jobs.push(Box::new(Pack {
            loaded,
            body,
            identity: identity("pack", part, version::PACK, key::pack(scene, body)?),
        }));
        packed.push(jobs.len() - 1);
        if scene.relax.is_some() {
            jobs.push(Box::new(Relax {
                loaded,
                body,
                pack: jobs.len() - 1,
                identity: identity(
                    "relax",
                    part,
                    version::flow(scene),
                    key::relax(scene, body)?,
                ),
            }));
        }
        bodies.push(jobs.len() - 1);
    }
    let mut calibration = None;
    if let Some(settings) = key::calibrate(scene)? {
        let read = if method::is_of_packing(scene) {
            packed
        } else {
            bodies.clone()
        };
        jobs.push(Box::new(Calibrate {
            loaded,
            bodies: read,
            identity: identity("calibrate", "", version::calibrate(scene), settings),
        }));
        calibration = Some(jobs.len() - 1);
    }
    jobs.push(Box::new(Impact {
        loaded,
        bodies,
        calibration,
        identity: identity("impact", "", version::flow(scene), key::impact(scene)?),
    }));
    let folder = loaded.path.parent().unwrap_or(Path::new("."));
    jobs.push(Box::new(Post {
        loaded,
        impact: jobs.len() - 1,
        identity: identity("post", "", version::POST, key::post(scene, folder)?),
    }));
    Ok(Pipeline {
        name: scene.name.clone(),
        jobs,
    })
}
