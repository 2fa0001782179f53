//! Scenes for the tests of packing, built without a file.

use coronet::scene::*;

/// Spacing of the test scenes, m.
pub const S0: f64 = 0.25e-3;

/// A scene of one body in a periodic box with a wall below, cubic spline, h = 1.3 s0, nominal mass.
pub fn scene(dimension: Dimension, size: [f64; 3], shape: Shape) -> Scene {
    let sides = [
        [Side::Periodic; 2],
        [Side::Periodic; 2],
        [Side::Wall, Side::Open],
    ];
    Scene {
        name: "test".into(),
        title: String::new(),
        dimension,
        domain: Domain {
            size: size.map(|cells| cells * S0),
            boundary: sides,
            wall_velocity: [[[0.0; 3]; 2]; 3],
        },
        density: 1100.0,
        effects: Effects::default(),
        bodies: vec![Body {
            name: "liquid".into(),
            shape,
            motion: Motion::Uniform([0.0; 3]),
            colour: [0; 3],
        }],
        pack: Pack {
            spacing: S0,
            arrangement: Arrangement::Poisson,
            tolerance: 0.1,
            seed: 1,
            iterations: 200,
        },
        relax: None,
        impact: Impact {
            end: 0.0,
            checkpoint_every: 60.0,
        },
        frames: Frames {
            interval: 1e-3,
            time_scale: 1.0,
            colour: Colour::Body,
        },
        post: Post {
            panels: vec![],
            fields: vec![],
            references: vec![],
        },
        pairs: Default::default(),
        method: Method::Wcsph(wcsph()),
    }
}

fn wcsph() -> Wcsph {
    Wcsph {
        sph: Sph {
            kernel: KernelName::CubicSpline,
            smoothing: 1.3,
            mass: Mass::Nominal,
            viscosity_form: ViscosityForm::TwoTerm,
            tension_form: TensionForm::NormalisedColour,
            tension_strength: TensionStrength::Fixed(4.5),
            tension_smoothing: 1.5,
            tension_level: TensionLevel::Inside,
            wetting_form: coronet::scene::WettingForm::Young,
        },
        density: Density::Summation,
        pressure: Pressure::Clipped,
        exponent: 7.0,
        sound_speed_factor: 10.0,
        sound_speed: SoundSpeed::Constant,
        reference_speed: None,
        wall_pressure: WallPressure::Summation,
        shifting: 0.0,
        time_stepping: TimeStepping::Fixed { step: 1e-6 },
    }
}
