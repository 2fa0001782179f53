//! Scene files: the format, `--set`, and every file that is shipped.

use coronet::scene::file::{self, Loaded};
use coronet::scene::{
    Arrangement, Density, Dimension, Effects, KernelName, Mass, Method, Motion, Shape, Side,
    TensionStrength, TimeStepping, ViscosityForm, Wcsph, numbers, preset,
};
use std::path::{Path, PathBuf};

pub const SMALL: &str = r#"
[box]
size = ["8 mm", "8 mm", "10 mm"]
[liquid]
density = "1100 kg/m^3"
[effects.gravity]
acceleration = "9.81 m/s^2"
[effects.viscosity]
dynamic = "3.5 mPa s"
[effects.tension]
coefficient = "67 mN/m"
[body.pool]
layer = { depth = "2 mm" }
[body.drop]
sphere = { diameter = "2 mm", gap = "0.4 mm", above = "pool" }
velocity = "1.5 m/s"
[pack]
spacing = "0.4 mm"
[relax]
[impact]
end = "5 ms"
[frames]
interval = "0.5 ms"
"#;

/// `SMALL` with overrides.
pub fn small(sets: &[&str]) -> Loaded {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    file::read(SMALL, Path::new("small.toml"), &sets).unwrap_or_else(|error| panic!("{error}"))
}

fn settings(loaded: &Loaded) -> Wcsph {
    let Method::Wcsph(settings) = &loaded.scene.method else {
        panic!("{}", loaded.scene.method.name());
    };
    settings.clone()
}

/// Every scene file that is shipped; `scenes/study` holds tables of runs of them.
pub fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![root.join("pipeline.toml")];
    let mut folders = vec![root.join("scenes")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.extend((!path.ends_with("study")).then_some(path));
            } else if path.extension().is_some_and(|ending| ending == "toml") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

#[test]
fn values_arrive_in_si_with_defaults() {
    let loaded = small(&[]);
    let scene = &loaded.scene;
    assert_eq!(loaded.text, SMALL);
    assert_eq!(scene.name, "small");
    assert_eq!(scene.dimension, Dimension::Three);
    assert_eq!(scene.domain.size, [0.008, 0.008, 0.01]);
    assert_eq!(scene.domain.boundary[0], [Side::Periodic; 2]);
    assert_eq!(scene.domain.boundary[2], [Side::Wall, Side::Open]);
    let effects = Effects {
        gravity: Some([0.0, 0.0, -9.81]),
        viscosity: Some(0.0035),
        tension: Some(0.067),
        wetting: None,
    };
    assert_eq!(scene.effects, effects);
    assert_eq!(scene.bodies[0].name, "pool");
    assert_eq!(scene.bodies[0].shape, Shape::Layer { depth: 0.002 });
    assert_eq!(scene.bodies[1].motion, Motion::Uniform([0.0, 0.0, -1.5]));
    let Shape::Sphere { centre, radius } = scene.bodies[1].shape else {
        panic!("{:?}", scene.bodies[1]);
    };
    assert_eq!((centre[0], centre[1], radius), (0.004, 0.004, 0.001));
    assert!((centre[2] - 0.0034).abs() < 1e-15);
    assert_eq!(scene.pack.arrangement, Arrangement::Poisson);
    assert_eq!((scene.pack.tolerance, scene.pack.seed), (0.1, 1));
    let relax = scene.relax.as_ref().unwrap();
    assert_eq!((relax.time, relax.damping), (0.02, 500.0));
    assert_eq!(scene.frames.time_scale, 1.0);
    assert_eq!(settings(&loaded), preset::wcsph_modern());
}

#[test]
fn overrides_replace_what_the_file_says() {
    let loaded = small(&[
        "body.drop.velocity=2.42 m/s",
        "pack.spacing=\"0.5 mm\"",
        "pack.arrangement=lattice",
        "impact.end=0.01",
        "effects.tension.strength=4.5",
        "method={ preset = \"paper\" }",
        "method.wcsph.smoothing=1.2",
        "method.wcsph.time_stepping={ adaptive = { safety = 0.5 } }",
        "post.panels=[\"1 ms\", 2e-3]",
    ]);
    let scene = &loaded.scene;
    assert_eq!(scene.bodies[1].motion, Motion::Uniform([0.0, 0.0, -2.42]));
    assert_eq!(scene.pack.spacing, 0.0005);
    assert_eq!(scene.pack.arrangement, Arrangement::Lattice);
    assert_eq!(scene.impact.end, 0.01);
    assert_eq!(scene.post.panels, [0.001, 0.002]);
    let mut expected = preset::wcsph_paper();
    expected.sph.smoothing = 1.2;
    expected.time_stepping = TimeStepping::Adaptive {
        safety: 0.5,
        holds: false,
    };
    assert_eq!(settings(&loaded), expected);
    let again = file::read(&loaded.text, Path::new("small.toml"), &[]).unwrap();
    assert_eq!(again.scene, *scene, "{}", loaded.text);
}

#[test]
fn every_setting_of_the_method_can_be_overridden() {
    let word = |set: &str| settings(&small(&[set]));
    let flow = |set: &str| word(&format!("method.wcsph.{set}"));
    assert_eq!(
        flow("kernel=cubic-spline").sph.kernel,
        KernelName::CubicSpline
    );
    assert_eq!(flow("density=summation").density, Density::Summation);
    let continuity = flow("density={ continuity = { diffusion = 0.2 } }").density;
    let wanted = |diffusion, compaction| Density::Continuity {
        diffusion,
        compaction,
    };
    assert_eq!(continuity, wanted(0.2, 1.1));
    let unseen = flow("density={ continuity = { compaction = \"none\" } }").density;
    assert_eq!(unseen, wanted(0.1, f64::INFINITY));
    assert_eq!(
        flow("pressure=clipped").pressure,
        coronet::scene::Pressure::Clipped
    );
    assert_eq!(flow("exponent=7").exponent, 7.0);
    assert_eq!(flow("sound_speed_factor=20").sound_speed_factor, 20.0);
    assert_eq!(flow("reference_speed=2 m/s").reference_speed, Some(2.0));
    assert_eq!(flow("reference_speed=scene").reference_speed, None);
    assert_eq!(flow("mass=lattice-sum").sph.mass, Mass::LatticeSum);
    let walls = flow("wall_pressure=summation").wall_pressure;
    assert_eq!(walls, coronet::scene::WallPressure::Summation);
    assert_eq!(flow("shifting=0.5").shifting, 0.5);
    let fixed = flow("time_stepping={ fixed = { step = \"1 us\" } }").time_stepping;
    assert_eq!(fixed, TimeStepping::Fixed { step: 1e-6 });
    let form = word("effects.viscosity.form=two-term").sph.viscosity_form;
    assert_eq!(form, ViscosityForm::TwoTerm);
    let tension = word("effects.tension.form=normalised-colour")
        .sph
        .tension_form;
    assert_eq!(tension, coronet::scene::TensionForm::NormalisedColour);
    let strength = word("effects.tension.strength=4.5").sph.tension_strength;
    assert_eq!(strength, TensionStrength::Fixed(4.5));
    assert_eq!(
        word("effects.tension.smoothing=1.7").sph.tension_smoothing,
        1.7
    );
}

/// What ISPH and MPS share; `flow`: the settings with one of them set.
fn every_setting_of_the_projection(flow: impl Fn(&str) -> coronet::scene::Projection) {
    use coronet::scene::{PoissonSource, Preconditioner};
    assert_eq!(flow("source=density").source, PoissonSource::Density);
    let divergence = flow("source={ divergence = { density = 0.2 } }").source;
    assert_eq!(divergence, PoissonSource::Divergence { density: 0.2 });
    let ssor = flow("preconditioner=ssor").preconditioner;
    assert_eq!(ssor, Preconditioner::Ssor);
    assert_eq!(flow("tolerance=1e-4").tolerance, 1e-4);
    assert_eq!(flow("iterations=7").iterations, 7);
    assert_eq!(flow("shifting=0").shifting, 0.0);
    assert_eq!(flow("courant=0.2").courant, 0.2);
    assert_eq!(flow("shortest=1 us").shortest, 1e-6);
    assert_eq!(flow("longest=1 ms").longest, 1e-3);
    assert_eq!(flow("cohesion=0.5").cohesion, 0.5);
}

#[test]
fn every_setting_of_isph_can_be_overridden() {
    use coronet::scene::{Closure, Gradient, Isph};
    let with = |set: &str| -> Isph {
        let sets = ["method.name=isph", "method.preset=modern", set];
        match small(&sets).scene.method {
            Method::Isph(settings) => settings,
            other => panic!("{}", other.name()),
        }
    };
    let flow = |set: &str| with(&format!("method.isph.{set}"));
    assert_eq!(with("impact.end=1"), preset::isph_modern());
    let same = with("method.preset=modern").sph;
    assert_eq!(
        same.kernel,
        preset::wcsph_modern().sph.kernel,
        "they share what they pack"
    );
    assert_eq!(flow("smoothing=1.4").sph.smoothing, 1.4);
    assert_eq!(flow("closure=mirrored").closure, Closure::Mirrored);
    assert_eq!(flow("gradient=symmetric").gradient, Gradient::Symmetric);
    every_setting_of_the_projection(|set| flow(set).projection);
    let form = with("effects.viscosity.form=cleary").sph.viscosity_form;
    assert_eq!(form, coronet::scene::ViscosityForm::Cleary);
    let form = with("effects.tension.form=cahn-hilliard").sph.tension_form;
    assert_eq!(form, coronet::scene::TensionForm::CahnHilliard);
    let strength = with("effects.tension.strength=flat").sph.tension_strength;
    assert_eq!(strength, TensionStrength::Flat);
}

#[test]
fn every_setting_of_mps_can_be_overridden() {
    use coronet::scene::{Mps, MpsClosure, MpsGradient, Pressure};
    let with = |set: &str| -> Mps {
        let sets = ["method.name=mps", "method.preset=modern", set];
        match small(&sets).scene.method {
            Method::Mps(settings) => settings,
            other => panic!("{}", other.name()),
        }
    };
    let flow = |set: &str| with(&format!("method.mps.{set}"));
    assert_eq!(with("impact.end=1"), preset::mps_modern());
    // h is half the largest radius.
    assert_eq!(flow("radius=2.5").radius, 2.5);
    assert_eq!(flow("radius=4").sph.smoothing, 2.0);
    assert_eq!(flow("laplacian_radius=4").sph.smoothing, 2.0);
    assert_eq!(flow("core=0.5").core, 0.5);
    assert_eq!(flow("beta=0.95").beta, 0.95);
    assert_eq!(flow("closure=threshold").closure, MpsClosure::Threshold);
    assert_eq!(flow("gradient=minimum").gradient, MpsGradient::Minimum);
    assert_eq!(flow("gradient=symmetric").gradient, MpsGradient::Symmetric);
    assert_eq!(flow("gradient=blended").gradient, MpsGradient::Blended);
    assert_eq!(flow("pressure=clipped").pressure, Pressure::Clipped);
    every_setting_of_the_projection(|set| flow(set).projection);
    let strength = with("effects.tension.strength=flat").sph.tension_strength;
    assert_eq!(strength, TensionStrength::Flat);
}

/// Both methods pack the same particles under the same key.
#[test]
fn methods_of_one_kernel_share_what_they_pack() {
    let key = |method: &str| {
        let scene = small(&[&format!("method.name={method}")]).scene;
        let list = coronet::scene::key::pack(&scene, 0).unwrap();
        list.into_iter()
            .map(|setting| setting.canonical)
            .collect::<Vec<_>>()
    };
    assert_eq!(key("wcsph"), key("isph"));
}

#[test]
fn every_shipped_scene_loads_and_its_numbers_are_sane() {
    let files = shipped();
    assert_eq!(files.len(), 35, "a scene file came or went: {files:?}");
    for path in files {
        let loaded = file::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        let scene = &loaded.scene;
        let shown = path.display();
        assert!(!scene.title.is_empty(), "{shown}");
        let total: u64 = (0..scene.bodies.len())
            .map(|body| numbers::count(scene, body))
            .sum();
        let least = if path.to_string_lossy().contains("hard") {
            1
        } else {
            300
        };
        assert!(
            (least..1_200_000).contains(&total),
            "{shown}: {total} particles"
        );
        let sound = numbers::sound_speed(scene);
        match scene.method {
            Method::Wcsph(_) => assert!(sound > 0.05 && sound <= 100.0, "{shown}: {sound} m/s"),
            _ => assert_eq!(sound, f64::INFINITY, "{shown}"),
        }
        let limits = numbers::limits(scene);
        assert!(
            limits
                .iter()
                .all(|limit| limit.value > 1e-7 && limit.value < 10.0),
            "{shown}"
        );
        let steps = scene.impact.end / limits[0].value;
        assert!(steps < 5e5, "{shown}: {steps} steps");
        assert!(scene.impact.end / scene.frames.interval >= 10.0, "{shown}");
        let lines = numbers::of(scene).to_string();
        assert!(
            lines.contains("Limits of the time step"),
            "{shown}: {lines}"
        );
        for body in 0..scene.bodies.len() {
            assert!(numbers::rest_sound_speed(scene, body) > 0.0, "{shown}");
        }
    }
}

#[test]
fn the_reference_manual_shows_every_key() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("pipeline.toml")).unwrap();
    let mut keys = Vec::new();
    coronet::scene::format::collect(&mut keys);
    for key in keys.iter().filter_map(|key| key.rsplit('.').next()) {
        let key = key.split('_').next().unwrap();
        assert!(text.contains(key), "pipeline.toml does not mention `{key}`");
    }
}

#[test]
fn the_papers_case_has_the_papers_particles() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/nishio-2010/u3.13.toml");
    let scene = file::load(&path, &[]).unwrap().scene;
    assert_eq!(numbers::count(&scene, 0), 1_024_000);
    assert_eq!(numbers::count(&scene, 1), 1791);
    assert_eq!(numbers::sound_speed(&scene), 10.0 * 3.13);
}

/// The lines that are commented out in the manual show the defaults, except for these examples.
#[test]
fn the_reference_manual_shows_the_true_defaults() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join("pipeline.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut shown = 0;
    let full: Vec<String> = text
        .lines()
        .map(|line| {
            let setting = line.strip_prefix("# ").unwrap_or("");
            let key = setting.split(" = ").next().unwrap();
            let is_key = key
                .bytes()
                .all(|byte| byte.is_ascii_lowercase() || byte == b'_');
            let examples = [
                "",
                "symmetry",
                "wall_velocity",
                "references",
                "angle",
                "advancing",
                "receding",
            ];
            let example = examples.contains(&key);
            if example || !is_key || key.len() == setting.len() {
                return line.to_string();
            }
            shown += 1;
            setting.to_string()
        })
        .collect();
    assert!(shown > 17, "{shown} defaults found");
    let plain = file::read(&text, &path, &[]).unwrap().scene;
    let full = file::read(&full.join("\n"), &path, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(full.scene, plain);
}
