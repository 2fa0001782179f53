//! Deviation of a run from a reference curve.

use super::series::{Series, is_clock};

/// Deviation of a run from a reference curve, over the times that both contain.
#[derive(Clone, Debug, PartialEq)]
pub struct Norm {
    /// Label of the reference curve.
    pub label: String,
    /// Name of the column.
    pub column: String,
    /// √(Σ (run − reference)² / Σ reference²).
    pub l2: f64,
    /// max |run − reference| / max |reference|.
    pub max: f64,
    /// Start of the span of the comparison, s, in the reference's time.
    pub from: f64,
    /// End of the span.
    pub to: f64,
    /// Run time minus reference time, s.
    pub shift: f64,
    /// Number of reference values compared.
    pub points: usize,
}

/// Norms of every column that both contain. `shift`: run time minus reference time, s.
pub fn compare(run: &Series, reference: &Series, label: &str, shift: f64) -> Vec<Norm> {
    // The level on the axis is the negative depth, and the drop before contact.
    let told = |name: &&String| name.as_str() != "axis_level_m" && !is_clock(name);
    let common = reference
        .names
        .iter()
        .filter(told)
        .filter(|name| run.has(name));
    common
        .filter_map(|name| compare_column(run, reference, label, name, shift))
        .collect()
}

/// The norms of one column; `None` if the reference is zero or blank where the run has values.
pub fn compare_column(
    run: &Series,
    reference: &Series,
    label: &str,
    name: &str,
    shift: f64,
) -> Option<Norm> {
    let values = reference.column(name)?;
    let (mut square, mut scale, mut max, mut max_scale) = (0.0, 0.0, 0.0f64, 0.0f64);
    let (mut from, mut to, mut points) = (f64::NAN, f64::NAN, 0);
    for (&t, &expected) in reference.time().iter().zip(values) {
        let Some(found) = run.at(name, t + shift).filter(|_| expected.is_finite()) else {
            continue;
        };
        let difference = found - expected;
        square += difference * difference;
        scale += expected * expected;
        max = max.max(difference.abs());
        max_scale = max_scale.max(expected.abs());
        from = if points == 0 { t } else { from };
        to = t;
        points += 1;
    }
    (scale > 0.0).then(|| Norm {
        label: label.to_owned(),
        column: name.to_owned(),
        l2: (square / scale).sqrt(),
        max: max / max_scale,
        from,
        to,
        shift,
        points,
    })
}
