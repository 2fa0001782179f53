//! Which settings each stage reads: the material of keys and of reasons.
//!
//! A stage's list holds exactly what can change its result. A setting of an absent effect is in
//! no list, nor are paths, thread counts, checkpoint cadence. A body that hangs free is packed and
//! relaxed about the origin: neither where it hangs, how fast it moves, gravity, the box nor other
//! bodies are in its lists. Layers and blocks meet the sides of the box, so the box is in theirs.

mod body;
mod flow;
mod isph;
mod mps;
mod projection;

use std::path::Path;

use super::file::LONGEST_REFERENCE;
use super::quantity::{Unit, human};
use super::{Arrangement, Clock, Colour, Scene, TensionStrength};
use body::{body_colour, size};
use flow::{colour, effects, flow, kernel, pairs, particle, physics, tension, walls, wetting};

/// What a change of a setting means for a result that is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Another state: the stage runs again.
    State,
    /// How far the state goes (`impact.end`): a later end continues, an earlier reuses.
    End,
    /// What is recorded, not what happens.
    Record,
}

/// One setting that a stage reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Dotted, as in the scene file: for people. Holds the names of bodies, so hash `canonical`.
    pub name: String,
    /// The value with its unit.
    pub value: String,
    /// What the setting is and its value, SI, f64 by bits: equal for equal settings and no others.
    pub canonical: Vec<u8>,
    pub role: Role,
}

/// A setting that can be in no key.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KeyError {
    #[error("`{0}` is not a number: it cannot be part of a key")]
    NotANumber(String),
    #[error("`{name}`: {problem}")]
    Reference { name: String, problem: String },
}

/// Settings in their order, with the first fault.
struct List {
    settings: Vec<Setting>,
    fault: Option<KeyError>,
    role: Role,
}

impl List {
    fn new() -> Self {
        List {
            settings: Vec::new(),
            fault: None,
            role: Role::State,
        }
    }

    fn end(self) -> Result<Vec<Setting>, KeyError> {
        match self.fault {
            Some(fault) => Err(fault),
            None => Ok(self.settings),
        }
    }

    /// `tag` says what the setting is, without names that the user chose.
    fn push(&mut self, name: &str, tag: &str, value: String, kind: u8, payload: &[u8]) {
        let mut canonical = Vec::new();
        for part in [tag.as_bytes(), payload] {
            canonical.push(kind);
            canonical.extend_from_slice(&(part.len() as u64).to_le_bytes());
            canonical.extend_from_slice(part);
        }
        let role = self.role;
        self.settings.push(Setting {
            name: name.to_string(),
            value,
            canonical,
            role,
        });
    }

    fn word(&mut self, name: &str, word: &str) {
        self.text(name, name, word);
    }

    fn text(&mut self, name: &str, tag: &str, text: &str) {
        self.push(name, tag, text.to_string(), b't', text.as_bytes());
    }

    fn count(&mut self, name: &str, count: u64) {
        self.push(name, name, count.to_string(), b'n', &count.to_le_bytes());
    }

    fn number(&mut self, name: &str, value: f64, unit: Unit) {
        self.numbers(name, name, &[value], unit);
    }

    fn numbers(&mut self, name: &str, tag: &str, values: &[f64], unit: Unit) {
        if values.iter().any(|value| value.is_nan()) {
            self.fault
                .get_or_insert(KeyError::NotANumber(name.to_string()));
        }
        // -0 and 0 are one value.
        let bits = |value: &f64| if *value == 0.0 { 0 } else { value.to_bits() };
        let payload: Vec<u8> = values
            .iter()
            .flat_map(|value| bits(value).to_le_bytes())
            .collect();
        let shown: Vec<String> = values.iter().map(|value| human(*value, unit)).collect();
        let shown = match shown.as_slice() {
            [one] => one.clone(),
            _ => format!("[{}]", shown.join(", ")),
        };
        self.push(name, tag, shown, b'f', &payload);
    }
}

/// Settings that packing body number `body` reads.
///
/// # Errors
/// [`KeyError`] if a value is not a number.
pub fn pack(scene: &Scene, body: usize) -> Result<Vec<Setting>, KeyError> {
    let mut list = List::new();
    let pack = &scene.pack;
    particle(&mut list, scene);
    let lattice = pack.arrangement == Arrangement::Lattice;
    list.word(
        "pack.arrangement",
        if lattice { "lattice" } else { "poisson" },
    );
    if !lattice {
        list.number("pack.tolerance", pack.tolerance, Unit::Density);
        list.count("pack.seed", pack.seed);
        list.count("pack.iterations", pack.iterations as u64);
    }
    // A lattice too: its particles are numbered along the cells of the kernel.
    kernel(&mut list, scene);
    size(&mut list, scene, &scene.bodies[body]);
    list.end()
}

/// Settings that the relaxation of body number `body` reads, besides its packing.
///
/// # Errors
/// [`KeyError`] if a value is not a number.
pub fn relax(scene: &Scene, body: usize) -> Result<Vec<Setting>, KeyError> {
    let mut list = List::new();
    let free = scene.bodies[body].shape.is_free();
    if let Some(relax) = &scene.relax {
        list.number("relax.time", relax.time, Unit::Time);
        list.number(
            "relax.kinetic_energy",
            relax.kinetic_energy,
            Unit::SpecificEnergy,
        );
        list.number("relax.density_spread", relax.density_spread, Unit::Density);
        list.number("relax.damping", relax.damping, Unit::Rate);
    }
    particle(&mut list, scene);
    size(&mut list, scene, &scene.bodies[body]);
    effects(&mut list, scene, !free);
    flow(&mut list, scene, !free);
    list.end()
}

/// Settings that the calibration of the tension strength reads; `None` if the scene has none.
///
/// # Errors
/// [`KeyError`] if a value is not a number.
pub fn calibrate(scene: &Scene) -> Result<Option<Vec<Setting>>, KeyError> {
    if !is_calibrated(scene) {
        return Ok(None);
    }
    let mut list = List::new();
    particle(&mut list, scene);
    pairs(&mut list, scene);
    kernel(&mut list, scene);
    tension(&mut list, scene);
    if scene.bodies.iter().any(|body| !body.shape.is_free()) {
        walls(&mut list, scene);
        wetting(&mut list, scene, true);
    }
    list.end().map(Some)
}

/// True if the scene asks for a calibrated tension.
pub fn is_calibrated(scene: &Scene) -> bool {
    let strength = scene.method.sph().tension_strength;
    scene.effects.tension.is_some() && strength == TensionStrength::Virial
}

/// Settings that the impact reads, besides its particles.
///
/// # Errors
/// [`KeyError`] if a value is not a number.
pub fn impact(scene: &Scene) -> Result<Vec<Setting>, KeyError> {
    let mut list = List::new();
    physics(&mut list, scene);
    list.role = Role::End;
    list.number("impact.end", scene.impact.end, Unit::Time);
    list.role = Role::Record;
    list.number("frames.interval", scene.frames.interval, Unit::Time);
    list.number("frames.time_scale", scene.frames.time_scale, Unit::One);
    list.word("frames.colour", colour(scene.frames.colour));
    for (index, body) in scene.bodies.iter().enumerate() {
        let tag = format!("body[{index}]");
        list.text(&format!("body.{}", body.name), &tag, &body.name);
        if scene.frames.colour == Colour::Body {
            body_colour(&mut list, body, &tag);
        }
    }
    list.end()
}

/// Settings that the evaluation reads, besides the log. `folder` holds the scene file: reference
/// curves count by what they contain, not by where they are.
///
/// # Errors
/// [`KeyError`] if a value is not a number or a reference curve cannot be read.
pub fn post(scene: &Scene, folder: &Path) -> Result<Vec<Setting>, KeyError> {
    let mut list = List::new();
    list.text("title", "title", &scene.title);
    physics(&mut list, scene);
    list.number("impact.end", scene.impact.end, Unit::Time);
    for (index, body) in scene.bodies.iter().enumerate() {
        let tag = format!("body[{index}]");
        list.text(&format!("body.{}", body.name), &tag, &body.name);
        body_colour(&mut list, body, &tag);
    }
    list.numbers("post.panels", "post.panels", &scene.post.panels, Unit::Time);
    list.numbers("post.fields", "post.fields", &scene.post.fields, Unit::Time);
    for (index, reference) in scene.post.references.iter().enumerate() {
        let name = format!("post.references[{index}]");
        list.text(
            &format!("{name}.label"),
            &format!("{name}.label"),
            &reference.label,
        );
        let path = folder.join(&reference.path);
        let content = crate::file::read(&path, LONGEST_REFERENCE);
        let content = content.map_err(|error| KeyError::Reference {
            name: format!("{name}.path"),
            problem: error.to_string(),
        })?;
        let shown = format!(
            "{} bytes, sum {:016x}",
            content.len(),
            fingerprint(&content)
        );
        list.push(&format!("{name}.path"), &name, shown, b'b', &content);
        if let Some(clock) = reference.clock {
            let word = match clock {
                Clock::Start => "start",
                Clock::Contact => "contact",
            };
            list.word(&format!("{name}.clock"), word);
        }
    }
    list.end()
}

/// FNV-1a, so that a reason shows that a file changed. Keys hash the content itself.
fn fingerprint(content: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    content.iter().fold(0xcbf2_9ce4_8422_2325, step)
}
