//! Curved contact lines: a round column and half a sphere on a wall.

use super::cloud::{Cloud, OPEN};
use super::effect_wetting::{H, KERNEL, SIGMA, accelerations_by, tension};
use super::pack_scene::S0;
use coronet::effect::depth::depths;
use coronet::method::surface_of;
use coronet::scene::{Dimension, Side};

/// Liquid about a vertical axis in a box `wide` spacings wide: within `radius` of it at a height.
fn about(low: Side, wide: f64, off: [f64; 2], radius: impl Fn(f64) -> f64) -> Cloud {
    let mut sides = OPEN;
    sides[2][0] = low;
    let middle = off.map(|off| 0.5 * wide + off);
    let inside = |x: [f64; 3]| (x[0] - middle[0]).hypot(x[1] - middle[1]) < radius(x[2]);
    let size = [wide, wide, 60.0];
    Cloud::new(Dimension::Three, size, sides, [H, 0.0], inside)
}

/// Vertical force on a column between two heights, in spacings, over sigma times its girth.
fn force(
    cloud: &Cloud,
    radius: f64,
    (angle, lifted): (Option<f64>, bool),
    [low, high]: [f64; 2],
) -> f64 {
    let mut tension = tension(cloud, angle);
    tension.lifted = lifted;
    let a = accelerations_by(tension, cloud, |_| true);
    let at = |i: &usize| cloud.flow.position(*i)[2] / S0;
    let here = (0..a.len()).filter(|i| (low..high).contains(&at(i)));
    let sum: f64 = here.map(|i| cloud.flow.particles.mass * a[i][2]).sum();
    sum / (SIGMA * std::f64::consts::TAU * radius * S0)
}

/// Net vertical force on the lowest layers of a round column on a wall at 90 degrees less that on
/// the same layers of one twice as long, mean of six places in the lattice.
fn excess(radius: f64, lifted: bool) -> f64 {
    let mut sum = 0.0;
    for place in 0..6 {
        let off = [0.618, 0.755].map(|step| (step * place as f64).fract());
        let wide = 2.0 * radius + 10.0;
        let within = |low: f64, high: f64| {
            move |z: f64| {
                if (low..high).contains(&z) {
                    radius
                } else {
                    0.0
                }
            }
        };
        let half = about(Side::Wall, wide, off, within(0.0, 14.0));
        let whole = about(Side::Open, wide, off, within(16.0, 44.0));
        sum += force(&half, radius, (Some(90.0), lifted), [0.0, 7.0]) / 6.0;
        sum -= force(&whole, radius, (None, lifted), [30.0, 37.0]) / 6.0;
    }
    sum
}

/// Stress that is carried to the surface pulls a round column at its foot as much as stress that is
/// not: it is carried in the wall too, else the foot would be pulled by 0.07 sigma more.
#[test]
fn the_foot_of_a_round_column_is_pulled_as_the_column() {
    let [inside, lifted] = [false, true].map(|lifted| excess(8.0, lifted));
    println!("{inside:.4} where it acts, {lifted:.4} at the surface");
    assert!((lifted - inside).abs() < 0.03, "{lifted}, not {inside}");
}

/// Half a sphere bends by its curvature up to the wall, where neighbours lie on one side only.
#[test]
fn a_sphere_bends_towards_its_foot() {
    let radius = 16.0;
    let sphere = |z: f64| (radius * radius - z * z).max(0.0).sqrt();
    let cloud = about(Side::Wall, 40.0, [0.0; 2], sphere);
    let sources = cloud.flow.sources();
    let mut tension = tension(&cloud, Some(90.0));
    tension.update(&surface_of(&cloud.flow, &sources), |_| true);
    let bends = &tension.wetting.as_ref().unwrap().rises.of;
    let mean = bends.iter().sum::<f32>() as f64 / bends.len() as f64;
    // Between the mean depth at which the stress acts and the deepest.
    let [depth, _] = depths(KERNEL, 3);
    let [least, most] = [depth, 1.0].map(|depth| H / (radius - depth * H));
    println!("{mean:.4} in {least:.4} .. {most:.4}");
    assert!((least..most).contains(&mean), "{mean}");
}
