//! Drops on walls as rings: contact angles, the force of an impact, contact time.

use super::{affordable, figure, rings};
use crate::{run, start};
use coronet::measure::gauge::Gauge;
use coronet::measure::whole::Unfold;
use std::f64::consts::PI;

/// A cap on a wall: the angle of the circle through its outline, mean of the last fifth.
#[test]
fn contact_angle() {
    println!();
    for spacing in ["0.16 mm", "0.08 mm"] {
        for angle in [30.0f64, 60.0, 90.0, 120.0, 150.0] {
            let sets = [
                format!("pack.spacing={spacing}"),
                format!("effects.wetting.angle={angle} deg"),
            ];
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let scene = rings("cap", &sets);
            let mut gauge = Gauge::new(&scene.whole());
            let unfold = Unfold::new(&scene);
            let mut solver = start(&scene).expect("starts");
            let end = scene.impact.end;
            let mut sums = [0.0; 4];
            run(solver.as_mut(), end, 0.01 * end, |f| {
                let row = gauge.measure(&unfold.whole(f));
                let value = |name: &str| row.iter().find(|(n, _)| n == name).expect("a column").1;
                if f.time > 0.8 * end {
                    sums[0] += value("contact_angle_deg");
                    sums[1] += value("contact_diameter_m");
                    sums[2] += value("apex_height_m");
                    sums[3] += 1.0;
                }
            })
            .expect("stays stable");
            let got = |k: usize| sums[k] / sums[3];
            let case = format!("cap, {angle} deg, {spacing}");
            let cosine = f64::cos(angle.to_radians());
            let volume = PI / 6.0 * 2.68e-3f64.powi(3);
            let round = (3.0 * volume / (PI * (2.0 - 3.0 * cosine + cosine.powi(3)))).cbrt();
            let width = 2.0 * round * angle.to_radians().sin();
            figure(&case, "angle, deg", got(0), Some(angle), 2.5 / angle);
            figure(&case, "width, m", got(1), Some(width), 0.02);
            figure(
                &case,
                "height, m",
                got(2),
                Some(round * (1.0 - cosine)),
                0.02,
            );
        }
    }
}

/// Weber number, first and second peak of the force over rho V^2 D^2: Sanjay et al. 2025.
const PEAKS: [[f64; 3]; 4] = [
    [10.0, 0.956, 1.84],
    [50.0, 0.818, 0.369],
    [100.0, 0.816, 0.370],
    [400.0, 0.814, 0.372],
];

/// Part of D / V between two values of the force, and how many of them make a mean: pressure waves
/// of a liquid that is not quite incompressible pass a drop in less than 0.1 D / V.
const SAMPLE: f64 = 0.02;
const MEAN: usize = 5;

/// The largest of the means of values in a row that are of times between two.
fn largest(track: &[[f64; 2]], from: f64, to: f64) -> [f64; 2] {
    let means = track.windows(MEAN).map(|some| {
        let mean = |k: usize| some.iter().map(|at| at[k]).sum::<f64>() / MEAN as f64;
        [mean(0), mean(1)]
    });
    let inside = means.filter(|[t, force]| (from..to).contains(t) && force.is_finite());
    inside.fold([0.0; 2], |most, at| if at[1] > most[1] { at } else { most })
}

/// The force of an impact, and the largest spread beside that of drops on plates that they wet,
/// 0.61 (Re^2 Oh)^0.166: Scheller & Bousfield 1995, doi 10.1002/aic.690410602.
#[test]
fn force_on_a_wall() {
    println!();
    let (diameter, density, sigma) = (2e-3, 1000.0, 0.0728);
    for spacing in ["0.1 mm", "0.05 mm"] {
        for [weber, first, second] in PEAKS {
            let speed = f64::sqrt(weber * sigma / (density * diameter));
            let sets = [
                format!("pack.spacing={spacing}"),
                format!("body.drop.velocity={speed} m/s"),
            ];
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let scene = rings("wall-force", &sets);
            let mut gauge = Gauge::new(&scene.whole());
            let unfold = Unfold::new(&scene);
            let mut solver = start(&scene).expect("starts");
            let turn = diameter / speed;
            let swing = f64::sqrt(density * diameter.powi(3) / sigma);
            let contact = 0.1e-3 / speed;
            let (mut track, mut spread) = (Vec::new(), 0.0f64);
            run(solver.as_mut(), scene.impact.end, SAMPLE * turn, |f| {
                let row = gauge.measure(&unfold.whole(f));
                let value = |name: &str| {
                    let found = row.iter().find(|(n, _)| n == name);
                    found.map_or(f64::NAN, |f| f.1)
                };
                let over = density * (speed * diameter).powi(2);
                track.push([f.time - contact, value("wall_force_z_N") / over]);
                spread = spread.max(value("max_diameter_factor"));
            })
            .expect("stays stable");
            // The first peak ends before the drop is flat, the second comes when it jumps.
            let between = f64::min(0.6 * turn, 0.25 * swing);
            let [when, peak] = largest(&track, 0.0, between);
            let [later, jump] = largest(&track, between, 0.8 * swing);
            let case = format!("force on a wall, We {weber}, {spacing}");
            let what = |peak: &str| format!("{peak} peak over rho V^2 D^2");
            figure(&case, &what("first"), peak, Some(first), 0.05);
            figure(&case, &what("second"), jump, Some(second), 0.1);
            let ohnesorge = 0.954e-3 / f64::sqrt(density * sigma * diameter);
            // Re^2 Oh = We / Oh.
            let law = 0.61 * (weber / ohnesorge).powf(0.166);
            figure(&case, "largest diameter over D", spread, Some(law), 0.1);
            println!(
                "  first at {:.3} D / V, second at {:.3} sqrt(rho D^3 / sigma)",
                when / turn,
                later / swing
            );
        }
    }
}

/// Contact time of drops that leave a wall of 180 degrees, Richard, Clanet & Quere 2002.
#[test]
fn bounce() {
    println!();
    let (radius, density, sigma) = (1e-3f64, 1000.0, 0.0728);
    let theory = 2.6 * f64::sqrt(density * radius.powi(3) / sigma);
    for spacing in affordable(&["0.05 mm", "0.025 mm"]) {
        for weber in [3.0, 10.0, 30.0] {
            let speed = f64::sqrt(weber * sigma / (density * radius));
            let sets = [
                format!("body.drop.velocity={speed} m/s"),
                format!("pack.spacing={spacing}"),
                "impact.end=12 ms".into(),
            ];
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let scene = rings("wall-force", &sets);
            let mut solver = start(&scene).expect("starts");
            let (mut touches, mut leaves) = (f64::NAN, f64::NAN);
            run(solver.as_mut(), scene.impact.end, 2e-5, |f| {
                let lowest = f.position[2]
                    .iter()
                    .fold(f32::INFINITY, |low, z| low.min(*z));
                let is_near = (lowest as f64) < scene.spacing;
                match (is_near, touches.is_nan()) {
                    (true, true) => touches = f.time,
                    (true, false) => leaves = f.time,
                    _ => {}
                }
            })
            .expect("stays stable");
            let case = format!("bounce, We {weber} with R, {spacing}");
            let got = leaves - touches;
            figure(&case, "contact time, s", got, Some(theory), 0.04);
        }
    }
}
