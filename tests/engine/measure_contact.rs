//! Contact angles of caps of known angle.

use coronet::measure::gauge::Gauge;
use coronet::measure::series::Row;
use coronet::particle::Frame;
use coronet::scene::*;

use crate::measure_splash::{DIAMETER, lattice, pool_scene, push};

fn value(row: &Row, name: &str) -> f64 {
    let found = row.iter().find(|(n, _)| n == name);
    found.unwrap_or_else(|| panic!("no column {name}")).1
}

/// A scene without a pool whose floor has a contact angle.
fn dry(dimension: Dimension, spacing: f64) -> Scene {
    let mut scene = pool_scene(dimension, spacing);
    scene.bodies.remove(0);
    scene.effects.wetting = Some(Wetting::of(60.0));
    scene
}

/// Caps of 60 and 24 spacings, and of 30 and 12, as many as the drops of docs/results/wetting.md,
/// "Contact angle": how far their bases are off by circles and by the raster.
#[test]
fn caps_have_their_contact_angle() {
    let radius = 6.0;
    // Most that an angle, in degrees, and a base may be off.
    for (dimension, spacing, most, wide) in [
        (Dimension::Two, 0.1, 1.0, 0.02),
        (Dimension::Two, 0.2, 1.5, 0.04),
        (Dimension::Three, 0.25, 1.0, 0.02),
        (Dimension::Three, 0.5, 1.5, 0.08),
    ] {
        let scene = dry(dimension, spacing);
        let is_plane = dimension == Dimension::Two;
        for angle in [45.0, 60.0, 90.0, 120.0, 150.0_f64] {
            if spacing > 0.25 && angle < 60.0 {
                // Too flat for an outline.
                continue;
            }
            let centre = -radius * angle.to_radians().cos();
            let frame = lattice(&scene, |x, y, z| {
                let y = if is_plane { 0.0 } else { y - 12.0 };
                (x - 12.0).hypot(y).hypot(z - centre) < radius
            });
            let row = Gauge::new(&scene).measure(&frame);
            let fitted = value(&row, "contact_angle_deg");
            let built = value(&row, "contact_angle_base_deg");
            let base = 2.0 * radius * angle.to_radians().sin();
            let by_circle = 1e3 * value(&row, "contact_diameter_m") / base - 1.0;
            let by_raster = DIAMETER * value(&row, "spread_factor") / base - 1.0;
            println!(
                "{dimension:?}, R = {:.0} s0, {angle}: {fitted:.1} by the outline, {built:.1} by \
                 base, which is {by_circle:+.3} off, by the raster {by_raster:+.3}",
                radius / spacing
            );
            assert!((fitted - angle).abs() < most, "{fitted}");
            assert!((built - angle).abs() < 2.0, "{built}");
            assert!(by_circle.abs() < wide, "{by_circle}");
            if is_plane && spacing < 0.2 {
                for side in ["low", "high"] {
                    let flank = value(&row, &format!("contact_angle_{side}_x_deg"));
                    // A lattice has few rows there.
                    assert!((flank - angle).abs() < 8.0, "{side}: {flank}");
                }
            }
        }
    }
}

/// A film with hollow edges, a drop flattened by gravity, which is on no circle, and liquid that
/// does not touch the floor have no angle.
#[test]
fn what_is_no_drop_on_the_floor_has_no_angle() {
    let scene = dry(Dimension::Two, 0.1);
    let film = |x: f64, z: f64| z < 0.45 + 0.05 * (0.5 * (x - 12.0)).powi(2) && z < 1.2;
    let flat = |x: f64, z: f64| ((x - 12.0) / 6.0).powi(4) + (z / 3.0).powi(4) < 1.0;
    let hanging = |x: f64, z: f64| (x - 12.0).hypot(z - 6.0) < 3.0;
    for (name, is_inside) in [
        ("film", &film as &dyn Fn(f64, f64) -> bool),
        ("flat", &flat),
        ("hanging", &hanging),
    ] {
        let row = Gauge::new(&scene).measure(&lattice(&scene, |x, _, z| is_inside(x, z)));
        let angle = value(&row, "contact_angle_deg");
        assert!(angle.is_nan(), "{name}: {angle}");
    }
}

/// Flanks that run out into a film lie on circles outside of the liquid: the base ends where they
/// meet the wall first.
#[test]
fn hollow_flanks_have_their_feet_below_them() {
    let scene = dry(Dimension::Two, 0.1);
    let edge = |z: f64| 8.0 - (25.0 - (z - 3.0) * (z - 3.0)).sqrt();
    let frame = lattice(&scene, |x, _, z| z < 3.0 && (x - 12.0).abs() < edge(z));
    let row = Gauge::new(&scene).measure(&frame);
    let base = 1e3 * value(&row, "contact_diameter_m");
    assert!((base / (2.0 * edge(0.0)) - 1.0).abs() < 0.04, "{base}");
}

#[test]
fn a_scene_without_contact_angle_has_no_such_column() {
    let mut scene = dry(Dimension::Two, 0.2);
    scene.effects.wetting = None;
    let frame = lattice(&scene, |x, _, z| (x - 12.0).hypot(z) < 4.0);
    let row = Gauge::new(&scene).measure(&frame);
    assert!(
        row.iter().all(|(name, _)| !name.contains("angle")),
        "{row:?}"
    );
    assert!(row.iter().any(|(name, _)| name == "spread_factor"));
}

/// Outline, mm, of a drop at rest on a plane of 45 degrees that leaves it at 60 degrees uphill and
/// has `curvature`, 1/mm, there: Young and Laplace, d phi / ds = -(curvature + (x - z) rho g sin 45
/// / sigma), with 73 mN/m. The angle downhill, degrees.
fn on_incline(curvature: f64) -> (Vec<[f64; 2]>, f64) {
    let (step, weight) = (0.002, 1e-6 * 1000.0 * 9.81 * 0.5_f64.sqrt() / 0.073);
    let (mut x, mut z, mut angle) = (0.0, 0.0, 60.0_f64.to_radians());
    let mut outline = Vec::new();
    while z >= 0.0 {
        outline.push([x, z]);
        let half = angle - 0.5 * step * (curvature + weight * (x - z));
        (x, z) = (x + step * half.cos(), z + step * half.sin());
        angle = half - 0.5 * step * (curvature + weight * (x - z));
    }
    (outline, -angle.to_degrees())
}

fn area(outline: &[[f64; 2]]) -> f64 {
    let slices = outline.windows(2);
    slices
        .map(|w| 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1]))
        .sum()
}

/// What the circles through the flanks say of a drop that is no circle: how far the measure itself
/// is off in docs/results/wetting.md, "Hysteresis".
#[test]
fn flanks_on_an_incline() {
    for (wanted, spacing, most) in [(9.0, 0.1, 2.0), (9.9, 0.1, 2.0), (9.9, 0.05, 1.0)] {
        let (mut least, mut greatest) = (0.2, 0.5);
        for _ in 0..40 {
            let middle = 0.5 * (least + greatest);
            match area(&on_incline(middle).0) > wanted {
                true => least = middle,
                false => greatest = middle,
            }
        }
        let (outline, front) = on_incline(least);
        let held = 60.0_f64.to_radians().cos() - front.to_radians().cos();
        let weight = 1e-6 * wanted * 1000.0 * 9.81 * 0.5_f64.sqrt() / 0.073;
        assert!((held / weight - 1.0).abs() < 0.005, "{held} {weight}");
        let ends = |z: f64| {
            let cross = |w: &&[[f64; 2]]| (w[0][1] > z) != (w[1][1] > z);
            let places = outline.windows(2).filter(cross).map(|w| w[0][0]);
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |e, x| {
                [e[0].min(x), e[1].max(x)]
            })
        };
        // Rows that end where the drop does.
        let mut frame = Frame::default();
        for row in 0..(3.0 / spacing) as usize {
            let z = (row as f64 + 0.5) * spacing;
            let [low, high] = ends(z);
            let count = ((high - low) / spacing).round().max(0.0);
            for k in 0..count as usize {
                let x = 8.0 + low + (k as f64 + 0.5) * (high - low) / count;
                push(&mut frame, [x, 0.0, z].map(|c| (1e-3 * c) as f32));
            }
        }
        let row = Gauge::new(&dry(Dimension::Two, spacing)).measure(&frame);
        let flank = |side: &str| value(&row, &format!("contact_angle_{side}_x_deg"));
        let flanks = [flank("low"), flank("high")];
        println!("{wanted} mm^2, {spacing} mm: 60 and {front:.1} degrees read as {flanks:.1?}");
        assert!((flanks[0] - 60.0).abs() < 1.5, "{flanks:?}");
        assert!((flanks[1] - front).abs() < most, "{flanks:?} {front}");
    }
}
