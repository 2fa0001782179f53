//! A straight surface that meets a wall: what pulls at its foot, and what shifts it.

use super::cloud::{Cloud, OPEN, length};
use super::effect_wetting::{H, SIGMA, accelerations_by, tension};
use super::pack_scene::S0;
use coronet::effect::tension::Tension;
use coronet::kernel::{Kernel, WendlandC2};
use coronet::method::surface_of;
use coronet::scene::{self, Dimension, Side};

/// Liquid left of a straight surface that meets the floor at `angle`, `part` of a spacing on.
fn wedge(angle: f64, part: f64) -> (Cloud, impl Fn([f64; 3]) -> f64) {
    let (sine, cosine) = angle.to_radians().sin_cos();
    let mut sides = OPEN;
    sides[2][0] = Side::Wall;
    // Spacings below the surface, from the place in spacings.
    let depth = move |x: [f64; 3]| (60.0 + part - x[0]) * sine - x[2] * cosine;
    let inside = |x: [f64; 3]| depth(x) > 0.0 && x[2] < 30.0;
    let size = [140.0, 0.0, 40.0];
    (
        Cloud::new(Dimension::Two, size, sides, [H, 0.0], inside),
        depth,
    )
}

/// Force on the lowest six layers beside a straight surface at `angle` over sigma, mean of `places`
/// in the lattice.
fn pull(angle: f64, places: usize, tension: impl Fn(&Cloud) -> Tension) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for place in 0..places {
        let (cloud, depth) = wedge(angle, place as f64 / places as f64);
        let a = accelerations_by(tension(&cloud), &cloud, |_| true);
        for (i, a) in a.iter().enumerate() {
            let x = cloud.flow.position(i).map(|x| x / S0);
            if x[2] < 6.0 && depth(x) < 9.0 {
                let mass = cloud.flow.particles.mass / places as f64;
                (0..3).for_each(|k| sum[k] += mass * a[k] / SIGMA);
            }
        }
    }
    sum
}

/// A straight surface at the angle that is set ends nowhere: nothing pulls at its foot, whatever
/// the angle.
#[test]
fn a_straight_surface_at_its_angle_is_not_pulled() {
    // At 150 degrees the surface meets the last layers beyond what they see.
    for (angle, most) in [
        (30.0, 0.03),
        (45.0, 0.03),
        (60.0, 0.03),
        (90.0, 0.03),
        (120.0, 0.03),
        (135.0, 0.03),
        (150.0, 0.06),
    ] {
        let sum = pull(angle, 24, |cloud| tension(cloud, Some(angle)));
        let (sine, cosine) = f64::to_radians(angle).sin_cos();
        let along = sum[2] * sine - sum[0] * cosine;
        let across = sum[0] * sine + sum[2] * cosine;
        assert!(
            along.abs() < most && across.abs() < most,
            "{angle}: {along} {across}"
        );
    }
}

/// Between the receding and the advancing angle it is not pulled at any: the surface goes on at the
/// angle that it has. Where it goes on at 90 degrees it is pulled by half of sigma at 60 and 120.
#[test]
fn a_straight_surface_within_its_hysteresis_is_not_pulled() {
    let set = scene::Wetting::between([130.0, 50.0]);
    let between = |cloud: &Cloud| {
        let mut tension = tension(cloud, Some(set.angle));
        tension.wetting.as_mut().unwrap().setting.angle = set;
        tension
    };
    for angle in [60.0, 75.0, 90.0, 105.0, 120.0] {
        let sum = pull(angle, 8, between);
        println!("{angle}: {sum:.3?}");
        assert!(
            sum[0].abs() < 0.04 && sum[2].abs() < 0.04,
            "{angle}: {sum:?}"
        );
        if angle != 90.0 {
            let [x, ..] = pull(angle, 8, |cloud| tension(cloud, Some(90.0)));
            assert!(x.abs() > 0.15, "{angle}: {x} without hysteresis");
        }
    }
}

/// What shifts particles beside a contact line points across the surface once the dry wall is out
/// of it. With the dry wall particles would leave the line along their surface.
#[test]
fn a_dry_wall_shifts_nobody() {
    let short = 1.5 * S0;
    for angle in [45.0, 90.0, 120.0] {
        let (cloud, depth) = wedge(angle, 0.0);
        let mut tension = tension(&cloud, Some(angle));
        tension.wetting.as_mut().unwrap().short = Some(short);
        let sources = cloud.flow.sources();
        tension.update(&surface_of(&cloud.flow, &sources), |_| true);
        let at = |p: &[Vec<f64>; 3], i: usize| [0, 1, 2].map(|a| p[a][i]);
        let liquid = |i: usize| at(&cloud.flow.particles.position, i);
        let others = (0..cloud.flow.liquid()).map(liquid);
        let walls = (0..cloud.flow.walls()).map(|j| at(&cloud.flow.wall.position, j));
        let others: Vec<_> = others.chain(walls).collect();
        let (sine, cosine) = f64::to_radians(angle).sin_cos();
        let [mut with, mut without] = [0.0; 2];
        for (i, dry) in tension.dry() {
            let x = liquid(i);
            let near = x.map(|x| x / S0);
            if near[2] > 2.0 || depth(near) > 2.0 {
                continue;
            }
            let mut slope = [0.0; 3];
            for other in &others {
                let d = [0, 1, 2].map(|a| (x[a] - other[a]) / short);
                let w = WendlandC2::slope(length(d).min(2.0));
                (0..3).for_each(|a| slope[a] += w * d[a]);
            }
            let along = |v: [f64; 3]| v[2] * sine - v[0] * cosine;
            with += along(slope);
            without += along(slope) - along(dry.map(f64::from));
        }
        assert!(
            without.abs() < 0.25 * with.abs(),
            "{angle}: {without} of {with}"
        );
    }
}
