//! ParaView's index of a time series.

use super::vtp::escape;

/// One file of the series.
pub struct Entry {
    /// Simulated time, s.
    pub time: f64,
    /// Time after contact, s; `None` before it.
    pub after_contact: Option<f64>,
    /// Name, relative to the index.
    pub file: String,
    pub scalars: Vec<(String, f64)>,
}

/// Text of the `.pvd` file.
pub fn text(entries: &[Entry]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  \
         <Collection>\n",
    );
    for entry in entries {
        text += &format!(
            "    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n",
            entry.time,
            escape(&entry.file),
        );
    }
    text + "  </Collection>\n</VTKFile>\n"
}
