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
        problem: Problem {
            dimension,
            domain: Domain {
                size: size.map(|cells| cells * S0),
                boundary: sides,
                wall_velocity: [[[0.0; 3]; 2]; 3],
                revolved: None,
            },
            density: 1100.0,
            spacing: S0,
            effects: Effects::default(),
            bodies: vec![Body {
                name: "liquid".into(),
                shape,
                motion: Motion::Uniform([0.0; 3]),
                colour: [0; 3],
            }],
            pairs: Default::default(),
            method: Method::Wcsph(wcsph()),
        },
        pack: Packing {
            arrangement: Arrangement::Poisson,
            tolerance: 0.1,
            seed: 1,
            iterations: 200,
        },
        relax: None,
        impact: Impact {
            end: 0.0,
            stop_when: vec![],
            checkpoint_every: 60.0,
        },
        frames: Frames {
            interval: 1e-3,
            time_scale: 1.0,
            colour: Colouring::Body,
        },
        post: Post {
            panels: vec![],
            fields: vec![],
            references: vec![],
            figures: FigureStyle::default(),
        },
    }
}

fn wcsph() -> Wcsph {
    Wcsph {
        sph: Sph {
            kernel: KernelName::CubicSpline,
            smoothing: 1.3,
            mass: Mass::Nominal,
        },
        density: Density::Summation,
        pressure: Pressure::Clipped,
        exponent: 7.0,
        sound_speed_factor: 10.0,
        sound_speed: SoundSpeed::Constant,
        reference_speed: SpeedOf::Scene,
        wall_pressure: WallPressure::Summation,
        shifting: 0.0,
        time_stepping: TimeStepping::Fixed { step: 1e-6 },
    }
}

/// The tension of Nishio et al. with this coefficient, N/m.
pub fn tension(coefficient: f64) -> SurfaceTension {
    SurfaceTension {
        coefficient,
        form: TensionForm::NormalisedColour,
        strength: TensionStrength::Fixed(4.5),
        smoothing: 1.5,
        level: TensionLevel::Inside,
    }
}
