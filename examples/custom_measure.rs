//! A measure of one's own: how far the liquid of a drop spreads inside the pool that it falls into.
//!
//!     cargo run --release --example custom_measure

use coronet::particle::Frame;
use coronet::simulate::{Simulation, scene};

const SCENE: &str = r#"
dimension = 2
[box]
size = ["20 mm", "16 mm"]
x = "periodic"
[liquid]
density = "998 kg/m^3"
[effects.gravity]
acceleration = "9.81 m/s^2"
[effects.tension]
coefficient = "72.8 mN/m"
[body.pool]
layer = { depth = "5 mm" }
[body.drop]
disc = { diameter = "2 mm", gap = "0.3 mm", above = "pool" }
velocity = "1 m/s"
[pack]
spacing = "0.2 mm"
[impact]
end = "10 ms"
[frames]
interval = "1 ms"
"#;

/// Centre, m, and standard deviation, m, of one body along an axis.
fn extent(frame: &Frame, body: u8, axis: usize) -> (f64, f64) {
    let own = frame.body.iter().zip(&frame.position[axis]);
    let places: Vec<f64> = own
        .filter(|(b, _)| **b == body)
        .map(|(_, x)| *x as f64)
        .collect();
    let count = places.len() as f64;
    let mean = places.iter().sum::<f64>() / count;
    let square = places.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    (mean, (square / count).sqrt())
}

fn main() -> Result<(), coronet::simulate::Error> {
    // Bodies are numbered in the order of the scene: the drop is the second.
    const DROP: u8 = 1;
    println!("time (ms)  height (mm)  width (mm)  crater (mm)");
    Simulation::new(&scene(SCENE)?)?.run(|frame, measures| {
        let (height, width) = (extent(frame, DROP, 2).0, extent(frame, DROP, 0).1);
        let depth = measures.iter().find(|(name, _)| name == "crater_depth_m");
        let depth = depth.map_or(f64::NAN, |(_, value)| *value);
        let [t, z, x, d] = [frame.time, height, width, depth].map(|x| 1e3 * x);
        println!("{t:9.2}  {z:11.3}  {x:10.3}  {d:11.3}");
    })?;
    Ok(())
}
