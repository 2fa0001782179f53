//! Warnings at the end of a run: liquid that left the box, parts off the main body.

use super::pack_scene::{S0, scene};
use coronet::measure::conservation::unexplained_part;
use coronet::measure::loss::{Watch, warnings};
use coronet::measure::series::Series;
use coronet::measure::summary::leaves_wall;
use coronet::scene::sanity::Warning;
use coronet::scene::{Dimension, Shape, Side};

/// Measures with these rows.
fn rows<const N: usize>(rows: impl IntoIterator<Item = [(&'static str, f64); N]>) -> Series {
    let mut series = Series::default();
    for row in rows {
        series.push(&row.map(|(name, value)| (name.to_string(), value)).to_vec());
    }
    series
}

/// A run of two frames that ends with so much removed and detached.
fn ended(removed: f64, detached: f64) -> Series {
    let frames = [(0.0, 0.0, 0.3), (1.0, removed, detached)];
    rows(frames.map(|(time, removed, detached)| {
        [
            ("time_s", time),
            ("mass_kg", 2.0 - removed),
            ("mass_removed_kg", removed),
            ("detached_part", detached),
        ]
    }))
}

/// Those about a layer 2 spacings deep; the drop meets it at `contact` s.
fn warned(series: &Series, contact: Option<f64>) -> Vec<Warning> {
    let layer = Shape::Layer { depth: 2.0 * S0 };
    warnings(&scene(Dimension::Two, [8.0; 3], layer), series, contact)
}

#[test]
fn a_crater_down_to_the_floor_is_told() {
    let deepest = |depth: f64| {
        let mut series = Series::default();
        let row = [("time_s", 0.0), ("crater_depth_m", depth * S0)];
        series.push(&row.map(|(name, value)| (name.to_string(), value)).to_vec());
        warned(&series, None)
    };
    assert_eq!(deepest(0.4), []);
    let text = deepest(1.9)[0].to_string();
    assert!(
        text.contains("`body.liquid.layer.depth`") && text.contains("floor"),
        "{text}"
    );
}

#[test]
fn what_is_missing_at_the_end_is_named_with_its_part() {
    // The drop is off the pool at first; droplets and mist of less than a hundredth are not told.
    assert_eq!(warned(&ended(0.0019, 0.009), None), []);
    assert_eq!(warned(&ended(0.0, 0.3), Some(1.5)), []);
    let little = warned(&ended(0.004, 0.0), None)[0].to_string();
    assert!(little.contains("0.20 %"), "{little}");
    let lost = warned(&ended(0.5, 0.0), None);
    assert_eq!(lost.len(), 1);
    let text = lost[0].to_string();
    for part in ["mass_removed_kg", "25.0 %", "box.size"] {
        assert!(text.contains(part), "{text}");
    }
    let apart = warned(&ended(0.0, 0.3), Some(0.5));
    assert_eq!(apart.len(), 1);
    let text = apart[0].to_string();
    assert!(
        text.contains("detached_part") && text.contains("30.0 %"),
        "{text}"
    );
    assert_eq!(warned(&Series::default(), None), []);
}

#[test]
fn what_still_grows_at_the_end_is_told() {
    let ended = |depth: [f64; 3]| {
        let mut series = Series::default();
        for (time, depth) in depth.into_iter().enumerate() {
            let row = [("time_s", time as f64), ("spread_factor", depth)];
            series.push(&row.map(|(name, value)| (name.to_string(), value)).to_vec());
        }
        warned(&series, None)
    };
    assert_eq!(ended([0.0, 2.0, 1.0]), []);
    assert_eq!(ended([0.0, 1.99, 2.0]), []);
    let growing = ended([0.0, 1.0, 2.0]);
    assert_eq!(growing.len(), 1);
    assert_eq!(growing[0].key, "impact.end");
    assert!(growing[0].why.contains("spread factor"), "{}", growing[0]);
}

#[test]
fn energy_that_nothing_explains_is_told() {
    let ended = |unexplained: f64| {
        let mut series = Series::default();
        for (time, unexplained) in [(0.0, 0.0), (1.0, unexplained)] {
            let row = [
                ("time_s", time),
                ("mass_kg", 1.0),
                ("kinetic_energy_J", 2.0),
                ("energy_unexplained_J", unexplained),
            ];
            series.push(&row.map(|(name, value)| (name.to_string(), value)).to_vec());
        }
        warned(&series, None)
    };
    assert_eq!(ended(-0.1), []);
    let text = ended(-0.5)[0].to_string();
    assert!(
        text.contains("energy_unexplained_J") && text.contains("25.0 %"),
        "{text}"
    );
}

#[test]
fn what_is_lost_on_the_way_is_told_once_and_again_when_it_has_doubled() {
    let mut watch = Watch::default();
    let mut told = Vec::new();
    for percent in [0, 1, 2, 3, 4, 5, 20, 100] {
        let removed = 0.02 * f64::from(percent);
        let scalars = [("mass_kg", 2.0 - removed), ("mass_removed_kg", removed)];
        let scalars = scalars.map(|(name, value)| (name.to_string(), value));
        if let Some(text) = watch.look(0.01, &scalars) {
            assert!(
                text.contains(&format!("{percent}.0 % of the liquid")),
                "{text}"
            );
            assert!(
                text.contains("t = 10.000 ms") && text.contains("box.size"),
                "{text}"
            );
            told.push(percent);
        }
    }
    assert_eq!(told, [2, 5, 20, 100]);
    assert_eq!(watch.look(0.0, &[]), None);
}

#[test]
fn mist_at_periodic_sides_is_no_leak() {
    let layer = Shape::Layer { depth: 2.0 * S0 };
    let mut scene = scene(Dimension::Two, [8.0; 3], layer);
    let told = |scene: &coronet::scene::Scene| {
        let warned = warnings(scene, &ended(0.5, 0.0), None);
        warned[0].to_string()
    };
    scene.domain.boundary[0] = [Side::Periodic; 2];
    scene.domain.boundary[2] = [Side::Wall; 2];
    assert!(told(&scene).contains("left the box as single particles at periodic sides"));
    scene.domain.boundary[0] = [Side::Wall; 2];
    assert!(told(&scene).contains("passed through the walls"));
}

/// Nothing is divided by an energy at the start that is zero; what drives a flow counts.
#[test]
fn unexplained_energy_is_a_part_of_what_there_was() {
    let scene = scene(Dimension::Two, [8.0; 3], Shape::Layer { depth: 2.0 * S0 });
    let part = |work: f64| {
        let frames = [(0.0, 0.0, 0.0), (1.0, work, 1e-3)];
        let series = rows(frames.map(|(time, work, unexplained)| {
            [
                ("time_s", time),
                ("kinetic_energy_J", 0.0),
                ("wall_work_J", work),
                ("energy_unexplained_J", unexplained),
            ]
        }));
        unexplained_part(&scene, &series, 1.0)[1]
    };
    assert!(part(0.0).is_nan());
    assert_eq!(part(-0.5), 1e-3 / 0.5);
}

/// A drop that never touched the wall does not leave it.
#[test]
fn what_never_touched_does_not_leave() {
    let series = |spread: [f64; 3]| {
        let frames = spread.into_iter().enumerate();
        rows(frames.map(|(time, spread)| [("time_s", time as f64), ("spread_factor", spread)]))
    };
    assert_eq!(leaves_wall(&series([0.0, 0.0, 0.0])), None);
    assert_eq!(leaves_wall(&series([0.0, 1.2, 0.0])), Some(2.0));
}

#[test]
fn liquid_that_reaches_the_sides_is_told() {
    let shape = Shape::Sphere {
        centre: [4.0 * S0, 4.0 * S0, 4.0 * S0],
        radius: 2.0 * S0,
    };
    let mut scene = scene(Dimension::Two, [8.0; 3], shape);
    scene.effects.gravity = Some([0.0, 0.0, -9.81]);
    scene.domain.boundary[2] = [Side::Wall, Side::Open];
    let about = |spread: f64| {
        let mut series = Series::default();
        let row = [("time_s", 0.0), ("max_diameter_factor", spread)];
        series.push(&row.map(|(name, value)| (name.to_string(), value)).to_vec());
        warnings(&scene, &series, None)
    };
    assert_eq!(about(1.4), []);
    let text = about(1.6)[0].to_string();
    assert!(
        text.contains("box.size") && text.contains("reaches the sides"),
        "{text}"
    );
}

/// The budget books what pressure gives, so that nothing is unexplained.
#[test]
fn energy_that_pressure_gives_is_told() {
    let ended = |given: f64| {
        let row = |time: f64, given: f64| {
            [
                ("time_s", time),
                ("mass_kg", 1.0),
                ("kinetic_energy_J", 2.0),
                ("pressure_work_J", given),
                ("energy_unexplained_J", 0.0),
            ]
        };
        warned(&rows([row(0.0, 0.0), row(1.0, given)]), None)
    };
    assert_eq!(ended(0.2), []);
    assert_eq!(ended(-1.5), []);
    let text = ended(0.5)[0].to_string();
    assert!(
        text.contains("pressure_work_J") && text.contains("25.0 %"),
        "{text}"
    );
}
