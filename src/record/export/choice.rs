//! Which frames of a log are exported, and which particles.

use super::ExportError;
use crate::record::log::LogBody;

/// Two times are equal if they differ by less, s.
const EQUAL: f64 = 1e-9;

/// Which frames, by their times.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Which {
    /// Each one.
    #[default]
    All,
    /// The nearest to each of these instants, s from the start of the run.
    Nearest(Vec<f64>),
    /// The nearest to each multiple of this time, s, above zero.
    Every(f64),
}

impl Which {
    /// Indices of the chosen frames among those at `times`, s, in increasing order. A frame is
    /// chosen once, even if it is the nearest to several instants. An instant may be before the
    /// first frame or after the last by half of the largest distance between frames.
    ///
    /// # Errors
    /// If an instant is outside the run.
    pub fn of(&self, times: &[f64]) -> Result<Vec<usize>, ExportError> {
        let gaps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let reach = 0.5 * gaps.fold(0.0, f64::max) + EQUAL;
        match self {
            Which::All => Ok((0..times.len()).collect()),
            Which::Nearest(instants) => {
                let found = instants.iter().map(|at| nearest(*at, times, reach));
                let mut found = found.collect::<Result<Vec<usize>, ExportError>>()?;
                found.sort_unstable();
                found.dedup();
                Ok(found)
            }
            Which::Every(step) => {
                // From the middle between the frame and the one before to that after it.
                let middle = |i: usize| 0.5 * (times[i] + times[i + 1]);
                let is_nearest = |i: &usize| {
                    let low = match *i {
                        0 => times[0] - reach,
                        i => middle(i - 1),
                    };
                    let high = match i + 1 {
                        end if end == times.len() => times[*i] + reach,
                        _ => middle(*i),
                    };
                    (low / step).ceil() * step < high
                };
                Ok((0..times.len()).filter(is_nearest).collect())
            }
        }
    }
}

fn nearest(at: f64, times: &[f64], reach: f64) -> Result<usize, ExportError> {
    let [first, last] = [times.first(), times.last()].map(|t| t.copied().unwrap_or(f64::NAN));
    if !(first - reach..=last + reach).contains(&at) {
        return Err(ExportError::Outside { at, first, last });
    }
    let next = times.partition_point(|time| *time < at);
    let is_before = next > 0 && (next == times.len() || at - times[next - 1] <= times[next] - at);
    Ok(if is_before { next - 1 } else { next })
}

/// Indices of the bodies with these names; `None` for all bodies: if there is no name, or each.
///
/// # Errors
/// If a name is not that of a body.
pub fn bodies(names: &[String], all: &[LogBody]) -> Result<Option<Vec<u8>>, ExportError> {
    if names.is_empty() {
        return Ok(None);
    }
    let index = |name: &String| {
        let found = all.iter().position(|body| body.name == *name);
        found.map(|index| index as u8).ok_or_else(|| {
            let known: Vec<&str> = all.iter().map(|body| body.name.as_str()).collect();
            ExportError::Body {
                name: name.clone(),
                known: known.join(", "),
            }
        })
    };
    let chosen: Vec<u8> = names.iter().map(index).collect::<Result<_, _>>()?;
    let is_part = (0..all.len()).any(|index| !chosen.contains(&(index as u8)));
    Ok(is_part.then_some(chosen))
}
