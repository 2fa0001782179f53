//! A drop of water bounces off a wall that it does not wet; how long does it touch it?
//!
//!     cargo run --release --example bouncing_drop

use coronet::simulate::{Simulation, scene};

const SCENE: &str = r#"
dimension = 2
[box]
size = ["6 mm", "5 mm"]
x = "open"
[liquid]
density = "998 kg/m^3"
[effects.viscosity]
dynamic = "1 mPa s"
[effects.tension]
coefficient = "72.8 mN/m"
[effects.wetting]
angle = "180 deg"
[body.drop]
disc = { diameter = "2 mm", centre = ["3 mm", "1.2 mm"] }
velocity = "0.3 m/s"
[pack]
spacing = "0.1 mm"
[impact]
end = "20 ms"
[frames]
interval = "0.1 ms"
"#;

fn main() -> Result<(), coronet::simulate::Error> {
    let mut simulation = Simulation::new(&scene(SCENE)?)?;
    let (mut first, mut last) = (f64::NAN, f64::NAN);
    simulation.run(|frame, _| {
        let lowest = frame.position[2].iter().copied().fold(f32::MAX, f32::min);
        let touches = lowest < 0.15e-3;
        println!(
            "{:5.1} ms, lowest particle at {:.2} mm",
            1e3 * frame.time,
            1e3 * lowest
        );
        if touches && first.is_nan() {
            first = frame.time;
        }
        if touches {
            last = frame.time;
        }
    })?;
    // 2.6 for a sphere, whatever its speed (Richard, Clanet & Quere 2002, Nature 417, 811).
    let unit = (998.0 * 1e-9 / 72.8e-3_f64).sqrt();
    println!(
        "contact lasts {:.1} ms, {:.2} sqrt(rho R^3 / sigma)",
        1e3 * (last - first),
        (last - first) / unit
    );
    Ok(())
}
