//! Small scenes for the tests of methods: a splash, and a drop alone.

use super::cloud::Random;
use coronet::method::{self, Phase, Solver};
use coronet::particle::{State, pack::pack};
use coronet::scene::{Scene, file};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::ControlFlow::Continue;
use std::path::Path;

/// What every effect adds to a scene.
pub const EFFECTS: &str = "[effects.viscosity]\ndynamic = '20 mPa s'\n\
    [effects.tension]\ncoefficient = '67 mN/m'\n";
pub const GRAVITY: &str = "[effects.gravity]\nacceleration = '9.81 m/s^2'\n";

const POOL: &str = "layer = { depth = '1.6 mm' }\n";

/// The tension of `mps corrected` with a reach, in h, that these small boxes have room for.
pub fn narrowed(method: &str, preset: &str, parts: &str, smoothing: f64) -> String {
    let wide = (method, preset) == ("mps", "corrected");
    let table = "[effects.tension]\n";
    let narrow = format!("{table}smoothing = {smoothing}\n");
    parts.replace(table, if wide { &narrow } else { table })
}

/// A lattice scene with spacing 0.4 mm in a box of 4.8 mm; `parts`: tables of effects and bodies;
/// `preset`: of WCSPH, or with the method before it, as in "isph modern".
pub fn scene(preset: &str, dimension: usize, sides: &str, parts: &str) -> Scene {
    let (method, preset) = preset.split_once(' ').unwrap_or(("wcsph", preset));
    let size = ["'4.8 mm'"; 3][..dimension].join(", ");
    let parts = &narrowed(method, preset, parts, 1.9);
    let text = format!(
        "dimension = {dimension}\n[box]\nsize = [{size}]\n{sides}\n\
         [liquid]\ndensity = '1100 kg/m^3'\n{parts}\n\
         [pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n[method]\nname = '{method}'\n\
         preset = '{preset}'\n"
    );
    let loaded = file::read(&text, Path::new("small.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

/// What the format calls a round body.
fn round(dimension: usize) -> &'static str {
    if dimension == 3 { "sphere" } else { "disc" }
}

/// A drop just above a pool between walls.
pub fn splash_scene(preset: &str, dimension: usize, effects: &str) -> Scene {
    let parts = format!(
        "{effects}[body.pool]\n{POOL}[body.drop]\n\
         {} = {{ diameter = '2 mm', gap = '0.2 mm', above = 'pool' }}\nvelocity = '1 m/s'\n",
        round(dimension)
    );
    scene(preset, dimension, "", &parts)
}

/// A drop that nothing touches, in the middle of an open box.
pub fn drop_scene(preset: &str, dimension: usize, effects: &str) -> Scene {
    let sides = ["x = 'open'", "y = 'open'", "z = 'open'"];
    let sides = if dimension == 3 {
        sides.join("\n")
    } else {
        [sides[0], sides[2]].join("\n")
    };
    let centre = ["'2.4 mm'"; 3][..dimension].join(", ");
    let parts = format!(
        "{effects}[body.drop]\n{} = {{ diameter = '3.6 mm', centre = [{centre}] }}\n",
        round(dimension)
    );
    scene(preset, dimension, &sides, &parts)
}

/// The lattice state at t = 0, disturbed: places by up to a tenth of a spacing, velocities by up to
/// `speed` m/s.
pub fn disturbed(scene: &Scene, speed: f64) -> State {
    let mut random = Random(3);
    let bodies: Vec<_> = (0..scene.bodies.len())
        .map(|body| {
            pack(&scene.pack_input(body), &mut |_| Continue(()))
                .unwrap()
                .0
        })
        .collect();
    let mut state = method::initial(&scene.impact_input(), &bodies);
    let p = &mut state.particles;
    for a in (0..3).filter(|&a| scene.domain.size[a] > 0.0) {
        for (x, v) in p.position[a].iter_mut().zip(&mut p.velocity[a]) {
            *x += 0.1 * scene.spacing * random.signed();
            *v += speed * random.signed();
        }
    }
    state
}

/// The solver of a scene on its disturbed lattice.
pub fn solver(scene: &Scene, speed: f64) -> Box<dyn Solver> {
    method::build(scene, disturbed(scene, speed), Phase::Impact, Some(3.0)).unwrap()
}

/// All effects, a pool, walls and a falling drop.
pub fn splash(preset: &str, dimension: usize) -> Box<dyn Solver> {
    let scene = splash_scene(preset, dimension, &format!("{GRAVITY}{EFFECTS}"));
    solver(&scene, 0.1)
}

/// All bits of a state, by name.
pub fn words(state: &State) -> Vec<(String, Vec<u64>)> {
    let p = &state.particles;
    let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let mut words = vec![
        ("time".to_string(), vec![state.time.to_bits(), state.step]),
        ("id".to_string(), p.id.iter().map(|&id| id as u64).collect()),
        (
            "body".to_string(),
            p.body.iter().map(|&body| body as u64).collect(),
        ),
        ("density".to_string(), bits(&p.density)),
        ("mass".to_string(), bits(&[p.mass])),
    ];
    for (a, axis) in ["x", "y", "z"].iter().enumerate() {
        words.push((format!("position {axis}"), bits(&p.position[a])));
        words.push((format!("velocity {axis}"), bits(&p.velocity[a])));
    }
    words.extend(
        state
            .scalars
            .iter()
            .map(|(name, x)| (name.clone(), bits(&[*x]))),
    );
    words.extend(state.arrays.iter().map(|(name, x)| (name.clone(), bits(x))));
    words
}

/// A short name for many bits.
pub fn fingerprint(words: &[u64]) -> String {
    let mut hasher = DefaultHasher::new();
    words.hash(&mut hasher);
    format!("{:016x} of {}", hasher.finish(), words.len())
}
