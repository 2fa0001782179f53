//! Key results of a run.

use super::kind::{Kind, contact_within, strikes_wall};
use super::lamella::Lamella;
use super::moment::{LIKELY, moment};
use super::series::Series;
use crate::scene::{Dimension, Scene, Shape, numbers};

/// Name and value of a result, for a table.
pub type Line = (String, String);

/// Results of a run besides its figures ([`super::answer`]); `shift`: time of contact, s.
pub fn of(scene: &Scene, kind: Kind, series: &Series, shift: f64) -> Vec<Line> {
    let mut lines = Vec::new();
    match kind {
        Kind::Pool(_) if contact_within(scene).is_none() => {}
        Kind::Pool(_) => pool(series, shift, &mut lines),
        Kind::Wall(_) => wall(scene, series, shift, &mut lines),
        Kind::Shape => shape(scene, series, &mut lines),
        Kind::Front => {}
        Kind::Level => {
            first_last(series, "surface_level_m", "level", 1e3, "mm", &mut lines);
            first_last(
                series,
                "pressure_max_Pa",
                "highest pressure",
                1.0,
                "Pa",
                &mut lines,
            );
        }
        Kind::Bulk => first_last(
            series,
            "speed_max_m_s",
            "highest speed",
            1.0,
            "m/s",
            &mut lines,
        ),
    }
    balance(scene, series, &mut lines);
    lines
}

fn pool(series: &Series, shift: f64, lines: &mut Vec<Line>) {
    let series = &series.window(shift, f64::INFINITY);
    let from_far = "largest depth from the far level";
    extreme(
        series,
        "crater_depth_far_m",
        from_far,
        1e3,
        " mm",
        shift,
        lines,
    );
    for ms in [5.0, 10.0, 15.0, 20.0, 30.0] {
        if let Some(diameter) = series.at("crater_diameter_m", shift + 1e-3 * ms) {
            let name = format!("crater diameter at {ms} ms");
            lines.push((name, format!("{:.2} mm", 1e3 * diameter)));
        }
    }
    let name = "jet crosses the initial level".to_owned();
    let crossing = jet_crosses(series);
    let never = || "not within the run".to_owned();
    lines.push((
        name,
        crossing.map_or_else(never, |t| {
            format!("at {}", moment(t - shift, LIKELY * t, 1))
        }),
    ));
}

/// When the jet passes the initial level, s, in a series from contact on: before, the raster of a
/// level pool has the depth of its noise.
pub fn jet_crosses(series: &Series) -> Option<f64> {
    let deepest = series.maximum("crater_depth_m").map_or(0.0, |(_, t)| t);
    series.rises_through("axis_level_m", 0.0, deepest)
}

/// When a drop that has spread on a wall leaves it, s.
pub fn leaves_wall(series: &Series) -> Option<f64> {
    let spread = series.column("spread_factor")?;
    let (most, widest) = series.maximum("spread_factor")?;
    if most <= 0.0 {
        return None;
    }
    let mut rows = series.time().iter().zip(spread);
    let off = rows.find(|(t, spread)| **t > widest && **spread == 0.0);
    off.map(|(t, _)| *t)
}

fn wall(scene: &Scene, series: &Series, shift: f64, lines: &mut Vec<Line>) {
    lamella(scene, series, shift, lines);
    let name = "largest diameter factor";
    extreme(series, "max_diameter_factor", name, 1.0, "", shift, lines);
    if strikes_wall(scene) && leaves_wall(series).is_none() {
        let text = "not within the run".to_owned();
        lines.push(("leaves the wall".to_owned(), text));
    }
    if let Some((part, time)) = series.maximum("detached_part") {
        let text = format!(
            "{:.1} % at {}",
            100.0 * part,
            moment(time - shift, LIKELY * time, 1)
        );
        lines.push(("most liquid off the main body".to_owned(), text));
    }
}

/// Spread at t = D0 / U0, and the theory of [`Lamella`].
fn lamella(scene: &Scene, series: &Series, shift: f64, lines: &mut Vec<Line>) {
    let (speed, diameter) = (numbers::impact_speed(scene), numbers::drop_diameter(scene));
    let (Some(theory), Some(diameter)) = (Lamella::of(scene), diameter) else {
        return;
    };
    let Some(spread) = series.at("max_diameter_factor", shift + diameter / speed) else {
        return;
    };
    let name = "diameter factor a diameter after contact (t = D0 / U0)".to_owned();
    lines.push((name, digits(spread)));
    let name = "the same by Roisman's lamella, as printed and corrected".to_owned();
    let text = format!("{}, {}", digits(theory.printed), digits(theory.corrected));
    lines.push((name, text));
}

fn shape(scene: &Scene, series: &Series, lines: &mut Vec<Line>) {
    first_last(series, "aspect_ratio", "aspect ratio", 1.0, "", lines);
    let half = 0.5 * series.time().last().copied().unwrap_or(0.0);
    if let Some(pressure) = mean(&series.window(half, f64::INFINITY), "core_pressure_Pa") {
        let name = "mean pressure in the core, second half of the run".into();
        lines.push((name, format!("{} Pa", digits(pressure))));
    }
    if let Some(pressure) = young_laplace(scene) {
        let name = "pressure of Young and Laplace at rest".into();
        lines.push((name, format!("{} Pa", digits(pressure))));
    }
    if let Some(period) = rayleigh(scene) {
        let name = "Rayleigh's period for small amplitude".into();
        lines.push((name, format!("{} ms", digits(1e3 * period))));
    }
}

/// Mean of a column over the time of the rows where it has a value, of which each has half of the
/// time to those beside it; `None` without any.
pub fn mean(series: &Series, column: &str) -> Option<f64> {
    let rows = series.time().iter().zip(series.column(column)?);
    let known: Vec<_> = rows.filter(|(_, value)| value.is_finite()).collect();
    let last = known.len().checked_sub(1)?;
    let apart = |k: usize| known[k + 1].0 - known[k].0;
    let share = |k: usize| match k {
        _ if last == 0 => 1.0,
        0 => apart(0),
        _ if k == last => apart(k - 1),
        _ => 0.5 * (apart(k - 1) + apart(k)),
    };
    let shares: Vec<f64> = (0..=last).map(share).collect();
    let sum: f64 = known.iter().zip(&shares).map(|((_, v), s)| *v * s).sum();
    Some(sum / shares.iter().sum::<f64>())
}

/// (d - 1) sigma / R of the only body in free space, Pa.
fn young_laplace(scene: &Scene) -> Option<f64> {
    let [body] = scene.bodies.as_slice() else {
        return None;
    };
    let radius = body.shape.equivalent_radius(&scene.domain, scene.dimension);
    let sides = scene.space() as f64 - 1.0;
    Some(sides * scene.effects.sigma()? / radius)
}

/// Period of a column about its mean, s: twice the mean time between crossings.
pub fn period(series: &Series, column: &str) -> Option<f64> {
    let rows = series.time().iter().zip(series.column(column)?);
    let (t, a): (Vec<f64>, Vec<f64>) = rows.filter(|(_, value)| value.is_finite()).unzip();
    let mean = mean(series, column)?;
    let crossings: Vec<f64> = (1..t.len())
        .filter(|&i| (a[i - 1] < mean) != (a[i] < mean))
        .map(|i| t[i - 1] + (mean - a[i - 1]) / (a[i] - a[i - 1]) * (t[i] - t[i - 1]))
        .collect();
    let count = crossings.len();
    (count >= 2).then(|| 2.0 * (crossings[count - 1] - crossings[0]) / (count - 1) as f64)
}

/// Rayleigh 1879: ω² = 8 σ/(ρ R³), in 2-D 6 σ/(ρ R³); R of the volume of the only body.
fn rayleigh(scene: &Scene) -> Option<f64> {
    let [body] = scene.bodies.as_slice() else {
        return None;
    };
    let (radius, round) = match body.shape {
        Shape::Sphere { radius, .. } => (radius, true),
        Shape::Ellipsoid {
            semi_axes: [a, b, c],
            ..
        } => match scene.dimension {
            Dimension::Three => ((a * b * c).cbrt(), true),
            Dimension::Two if scene.domain.is_revolved() => ((a * a * c).cbrt(), true),
            Dimension::Two => ((a * c).sqrt(), true),
        },
        _ => (1.0, false),
    };
    let factor = if scene.space() == 3 { 8.0 } else { 6.0 };
    let sigma = scene.effects.sigma().filter(|_| round)?;
    let omega = (factor * sigma / (scene.density * radius.powi(3))).sqrt();
    Some(2.0 * std::f64::consts::PI / omega)
}

/// Energy, mass and momentum at the ends of the run.
fn balance(scene: &Scene, series: &Series, lines: &mut Vec<Line>) {
    let unit = if scene.space() == 2 { "J/m" } else { "J" };
    first_last(
        series,
        "kinetic_energy_J",
        "kinetic energy",
        1.0,
        unit,
        lines,
    );
    if let Some(total) = total_energy(series) {
        let change = total[total.len() - 1] - total[0];
        let name = "change of kinetic + potential + surface energy".to_owned();
        lines.push((name, format!("{} {unit}", digits(change))));
    }
    if let Some(unexplained) = series
        .column("energy_unexplained_J")
        .and_then(<[f64]>::last)
    {
        let name = "energy unexplained".to_owned();
        lines.push((name, format!("{} {unit}", digits(*unexplained))));
    }
    let mass = if scene.space() == 2 { "kg/m" } else { "kg" };
    first_last(series, "mass_kg", "mass", 1.0, mass, lines);
    if let Some(removed) = series.column("mass_removed_kg").and_then(<[f64]>::last) {
        lines.push((
            "mass that left the box".into(),
            format!("{} {mass}", digits(*removed)),
        ));
    }
}

/// Sum of the energies that the table has, from the first frame's potential and surface energy, J.
pub fn total_energy(series: &Series) -> Option<Vec<f64>> {
    let kinetic = series.column("kinetic_energy_J")?;
    let mut total = kinetic.to_vec();
    for name in ["potential_energy_J", "surface_energy_J"] {
        if let Some(energy) = series.column(name) {
            for (sum, e) in total.iter_mut().zip(energy) {
                *sum += e - energy[0];
            }
        }
    }
    Some(total)
}

/// Maximum with its time after contact.
fn extreme(
    series: &Series,
    column: &str,
    name: &str,
    factor: f64,
    unit: &str,
    shift: f64,
    lines: &mut Vec<Line>,
) {
    if let Some((value, time)) = series.maximum(column) {
        let at = moment(time - shift, LIKELY * time, 1);
        lines.push((
            name.to_owned(),
            format!("{:.2}{unit} at {at}", factor * value),
        ));
    }
}

fn first_last(
    series: &Series,
    column: &str,
    name: &str,
    factor: f64,
    unit: &str,
    lines: &mut Vec<Line>,
) {
    if let Some([first, .., last]) = series.column(column) {
        let text = format!(
            "{} to {} {unit}",
            digits(factor * first),
            digits(factor * last)
        );
        lines.push((
            format!("{name}, first to last frame"),
            text.trim_end().to_owned(),
        ));
    }
}

/// Four significant digits.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (0.01..10_000.0).contains(&size) {
        let after = (3.0 - size.log10().floor()).max(0.0) as usize;
        format!("{value:.after$}")
    } else {
        format!("{value:.3e}")
    }
}
