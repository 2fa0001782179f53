//! Comma-separated values: a header, then one line a particle. Numbers are written with the fewest
//! digits that read back to the same bits.

use std::io::{self, Write};

use super::pvd::Entry;
use super::table::Table;
use crate::record::checkpoint::Array;

/// Writes `table` as a `.csv` file.
pub fn write(table: &Table, out: &mut impl Write) -> io::Result<()> {
    let (names, arrays): (Vec<_>, Vec<_>) = table.flat().unzip();
    writeln!(out, "{}", names.join(","))?;
    for index in 0..table.len() {
        for (k, array) in arrays.iter().enumerate() {
            if k > 0 {
                out.write_all(b",")?;
            }
            match array {
                Array::F64(values) => write!(out, "{:?}", values[index])?,
                Array::F32(values) => write!(out, "{:?}", values[index])?,
                Array::U64(values) => write!(out, "{}", values[index])?,
                Array::U32(values) => write!(out, "{}", values[index])?,
                Array::U8(values) => write!(out, "{}", values[index])?,
            }
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

/// Text of the index of a series: time, file, scalars.
pub fn index(entries: &[Entry]) -> String {
    let mut text = String::from("time_s,file");
    if let Some(first) = entries.first() {
        for (name, _) in &first.scalars {
            text += &format!(",{name}");
        }
    }
    text += "\n";
    for entry in entries {
        text += &format!("{:?},{}", entry.time, entry.file);
        for (_, value) in &entry.scalars {
            text += &format!(",{value:?}");
        }
        text += "\n";
    }
    text
}
