//! Settings of the projections at the edge of what is accepted.

use coronet::simulate::{Simulation, scene};

/// Largest speed, m/s, at the end of a run, or why it failed.
fn speed(text: &str) -> Result<f64, String> {
    let scene = scene(text).map_err(|error| error.to_string())?;
    let mut run = Simulation::new(&scene).map_err(|error| error.to_string())?;
    let mut last = 0.0;
    run.run(|frame, _| {
        let square = |i: usize| {
            frame
                .velocity
                .iter()
                .map(|v| (v[i] as f64).powi(2))
                .sum::<f64>()
        };
        last = (0..frame.id.len()).map(square).fold(0.0, f64::max).sqrt();
    })
    .map_err(|error| error.to_string())?;
    Ok(last)
}

/// Poiseuille flow of an oil, at most 5 mm/s. The viscous limit is a seventh of the `shortest` step
/// of these presets.
#[test]
fn the_shortest_step_is_no_longer_than_a_stable_one() {
    for (method, preset) in [("isph", "corrected"), ("isph", "modern"), ("mps", "modern")] {
        let text = format!(
            "dimension = 2\n[box]\nsize = ['2 mm', '2 mm']\nx = 'periodic'\nz = 'wall'\n\
             [liquid]\ndensity = '1000 kg/m^3'\n[effects.gravity]\n\
             acceleration = '20 m/s^2'\ndirection = [1, 0]\n\
             [effects.viscosity]\ndynamic = '2 Pa s'\n[body.liquid]\nlayer = {{ depth = '2 mm' }}\n\
             [pack]\nspacing = '0.1 mm'\narrangement = 'lattice'\n\
             [impact]\nend = '0.3 ms'\n[frames]\ninterval = '0.1 ms'\n\
             [method]\nname = '{method}'\npreset = '{preset}'\n\
             [method.{method}]\nshortest = '5 us'\n"
        );
        let fastest = speed(&text).unwrap();
        println!("{method} {preset}: {fastest:.2e} m/s");
        assert!(fastest < 8e-3, "{method} {preset}: {fastest}");
    }
}

/// On a lattice pairs of the spray meet head on, and come to one point.
#[test]
fn spray_that_meets_head_on_has_a_pressure() {
    for speed_of_drop in ["4 m/s", "5 m/s"] {
        let text = format!(
            "dimension = 2\n[box]\nsize = ['12 mm', '10 mm']\nx = 'periodic'\n\
             z = ['wall', 'open']\n[liquid]\ndensity = '1000 kg/m^3'\n[effects.gravity]\n\
             acceleration = '9.81 m/s^2'\n[effects.viscosity]\ndynamic = '2 mPa s'\n\
             [body.pool]\nlayer = {{ depth = '3 mm' }}\n[body.drop]\n\
             disc = {{ diameter = '2.4 mm', gap = '0.4 mm', above = 'pool' }}\n\
             velocity = '{speed_of_drop}'\n[pack]\nspacing = '0.2 mm'\narrangement = 'lattice'\n\
             [impact]\nend = '4 ms'\n[frames]\ninterval = '0.5 ms'\n[method]\nname = 'isph'\n"
        );
        let fastest = speed(&text).unwrap_or_else(|error| panic!("{speed_of_drop}: {error}"));
        println!("{speed_of_drop}: {fastest:.1} m/s");
    }
}
