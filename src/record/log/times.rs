//! The times of the frames of a log, without their particles.

use std::path::Path;

use super::LogError;
use super::read::{Item, Items, MeasuresDecoder};

/// Times of all frames of the log at `path`, s, in their order.
///
/// # Errors
/// If the log cannot be read to its end.
pub fn times(path: &Path) -> Result<Vec<f64>, LogError> {
    let mut measures = MeasuresDecoder::default();
    let mut times = Vec::new();
    for item in Items::open(path)? {
        let Item::Message(message) = item? else {
            continue;
        };
        if message.is_measures() {
            let decoded = measures.decode(&message);
            let (time, _) = decoded.map_err(|what| LogError::Foreign {
                path: path.to_path_buf(),
                what,
            })?;
            times.push(time);
        }
    }
    Ok(times)
}
