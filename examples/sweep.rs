//! How wide does a drop get on a dry wall, against its speed? Points run side by side.
//!
//!     cargo run --release --example sweep

use coronet::simulate::{Error, Simulation, scene};
use rayon::prelude::*;

fn text(speed: f64) -> String {
    format!(
        r#"
dimension = 2
[box]
size = ["12 mm", "4 mm"]
x = "open"
[liquid]
density = "998 kg/m^3"
[effects.viscosity]
dynamic = "5 mPa s"
[effects.tension]
coefficient = "72.8 mN/m"
[effects.wetting]
angle = "90 deg"
[body.drop]
disc = {{ diameter = "2 mm", centre = ["6 mm", "1.2 mm"] }}
velocity = "{speed} m/s"
[pack]
spacing = "0.1 mm"
[impact]
end = "8 ms"
[frames]
interval = "0.1 ms"
"#
    )
}

/// The largest width in diameters, and when, s.
fn widest(speed: f64) -> Result<(f64, f64), Error> {
    let mut simulation = Simulation::new(&scene(&text(speed))?)?;
    let measures = simulation.run(|_, _| ())?;
    let spread = measures.column("spread_factor").unwrap_or(&[]);
    let rows = measures.time().iter().zip(spread);
    let largest = rows.max_by(|a, b| a.1.total_cmp(b.1));
    Ok(largest.map_or((f64::NAN, f64::NAN), |(time, width)| (*width, *time)))
}

fn main() -> Result<(), Error> {
    let speeds = [0.25, 0.5, 1.0, 1.5];
    let found: Result<Vec<_>, _> = speeds.par_iter().map(|speed| widest(*speed)).collect();
    for (speed, (width, time)) in speeds.iter().zip(found?) {
        let weber = 998.0 * speed * speed * 2e-3 / 72.8e-3;
        println!(
            "{speed:4.2} m/s, We {weber:5.1}: {width:.2} diameters after {:.1} ms",
            1e3 * time
        );
    }
    Ok(())
}
