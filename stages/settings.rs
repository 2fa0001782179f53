//! What each stage reads, for its key, and how much work that means.

use coronet::pipeline::{Setting, Work};
use coronet::scene::{Scene, key, numbers};

/// Particle-steps per second and thread, where no earlier run tells.
const PACE: f64 = 1e6;

/// Acoustic time step, in units of h / c.
const COURANT: f64 = 0.25;

/// Settings of the scene as the pipeline knows them.
pub fn list(settings: Vec<key::Setting>) -> Vec<Setting> {
    let setting = |setting: key::Setting| Setting {
        name: setting.name,
        shown: setting.value,
        canonical: setting.canonical,
    };
    settings.into_iter().map(setting).collect()
}

/// The number at the end of a setting's canonical bytes, from their hexadecimal form.
pub fn number(canonical: &str) -> Option<f64> {
    let digits = canonical.get(canonical.len().checked_sub(16)?..)?;
    let bits = u64::from_str_radix(digits, 16).ok()?;
    Some(f64::from_bits(bits.swap_bytes()))
}

/// Particle-steps of the impact.
pub fn impact_work(scene: &Scene) -> Option<Work> {
    let limits = numbers::limits(scene);
    let step = limits.first()?.value;
    let particles: u64 = (0..scene.bodies.len())
        .map(|body| numbers::count(scene, body))
        .sum();
    work(particles, scene.impact.end, step)
}

/// Most particle-steps of the relaxation of body `body`.
pub fn relax_work(scene: &Scene, body: usize) -> Option<Work> {
    let relax = scene.relax.as_ref()?;
    let h = numbers::smoothing_length(scene);
    let step = match numbers::sound_speed(scene).is_finite() {
        true => COURANT * h / numbers::rest_sound_speed(scene, body),
        false => numbers::limits(scene).first()?.value,
    };
    work(numbers::count(scene, body), relax.time, step)
}

fn work(particles: u64, time: f64, step: f64) -> Option<Work> {
    let amount = particles as f64 * (time / step).ceil();
    amount.is_finite().then(|| Work {
        amount: amount.round(),
        pace: PACE * rayon::current_num_threads() as f64,
    })
}
