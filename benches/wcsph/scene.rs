//! What is stepped: a periodic box of jittered particles, and the default scene on a lattice.

use coronet::method::{calibrate, initial};
use coronet::particle::pack::pack;
use coronet::particle::{Particles, State};
use coronet::scene::{Method, Scene, TensionStrength, Wcsph, file};
use std::ops::ControlFlow;
use std::path::Path;

/// A periodic box of `side`^3 particles.
pub fn block(side: usize, preset: &str, viscous: bool) -> Scene {
    let size = side as f64 * 0.25;
    let viscosity = if viscous {
        "[effects.viscosity]\ndynamic = '3.5 mPa s'\n"
    } else {
        ""
    };
    let text = format!(
        "title = 'bench'\n\
         [box]\nsize = ['{size} mm', '{size} mm', '{size} mm']\n\
         x = 'periodic'\ny = 'periodic'\nz = 'periodic'\n\
         [liquid]\ndensity = '1100 kg/m^3'\n{viscosity}\
         [body.box]\n\
         block = {{ low = [0, 0, 0], high = ['{size} mm', '{size} mm', '{size} mm'] }}\n\
         [pack]\nspacing = '0.25 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n\
         [method]\nname = 'wcsph'\npreset = '{preset}'\n\
         [method.wcsph]\nreference_speed = '3.13 m/s'\n"
    );
    let loaded = file::read(&text, Path::new("bench.toml"), &[]);
    loaded.unwrap_or_else(|error| panic!("{error}")).scene
}

/// Settings of the method.
pub fn settings(scene: &Scene) -> &Wcsph {
    match &scene.method {
        Method::Wcsph(settings) => settings,
        _ => panic!("the scenes of this bench are those of WCSPH"),
    }
}

/// h, m.
pub fn smoothing(scene: &Scene) -> f64 {
    settings(scene).sph.smoothing * scene.spacing
}

/// Each particle of the box up to 0.1 s0 and 1 m/s from rest on the lattice.
pub fn state(scene: &Scene, side: usize) -> State {
    let s0 = scene.spacing;
    let mut seed = 1u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    let mut p = Particles {
        mass: scene.density * s0.powi(3),
        ..Particles::default()
    };
    for i in 0..side * side * side {
        let cell = [i / side / side, i / side % side, i % side];
        for (a, c) in cell.iter().enumerate() {
            p.position[a].push((*c as f64 + 0.5 + 0.2 * random()) * s0);
            p.velocity[a].push(2.0 * random());
        }
        p.density.push(scene.density);
        p.id.push(i as u32);
        p.body.push(0);
    }
    State {
        particles: p,
        ..State::default()
    }
}

/// The default scene, the pool of Nishio et al. by their method as printed but with the step of
/// stability, and with the tension held over steps.
pub const DEFAULT: [&str; 1] = ["pipeline.toml"];
pub const NISHIO: [&str; 2] = [
    "scenes/nishio-2010/u3.13.toml",
    "method.wcsph.time_stepping={adaptive={safety=1}}",
];
pub const HELD: [&str; 2] = [
    NISHIO[0],
    "method.wcsph.time_stepping={adaptive={safety=1,tension=\"held\"}}",
];

/// A scene, a file and changes to it, on a lattice, its state at t = 0 and the strength of its
/// tension; without tension if `tension` does not hold.
pub fn pool(of: &[&str], tension: bool) -> (Scene, State, Option<f64>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(of[0]);
    let mut sets = vec!["pack.arrangement=\"lattice\"".to_string()];
    sets.extend(of[1..].iter().map(|set| set.to_string()));
    let mut scene = file::load(&path, &sets)
        .unwrap_or_else(|error| panic!("{error}"))
        .scene;
    let bodies: Vec<Particles> = (0..scene.bodies.len())
        .map(|body| {
            let packed = pack(&scene.pack_input(body), &mut |_| ControlFlow::Continue(()));
            let mut particles = packed.expect("a lattice can be placed").0;
            particles.body.fill(body as u8);
            particles
        })
        .collect();
    if !tension {
        scene.effects.tension = None;
        return (scene.clone(), initial(&scene.impact_input(), &bodies), None);
    }
    let strength = match (scene.effects.tension, scene.calibrate_input()) {
        (_, Some(input)) => {
            let found = calibrate(&input.bodies, &bodies);
            found.expect("the pool has a surface").strength
        }
        (Some(tension), None) => match tension.strength {
            TensionStrength::Fixed(strength) => strength,
            other => panic!("{other:?}"),
        },
        (None, None) => panic!("the scene has tension"),
    };
    (
        scene.clone(),
        initial(&scene.impact_input(), &bodies),
        Some(strength),
    )
}
