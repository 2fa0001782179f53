//! Polygon file format (Turk 1994), binary little-endian, vertices only. Positions are the
//! properties `x`, `y`, `z`; 64-bit integers, which the format lacks, become doubles.

use std::io::{self, Write};

use super::table::Table;
use super::vtp::write_element;
use crate::record::checkpoint::Array;

/// Writes `table` as a `.ply` file.
pub fn write(table: &Table, out: &mut impl Write) -> io::Result<()> {
    let (names, arrays): (Vec<_>, Vec<_>) = table.flat().unzip();
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment time_s {:?}\nelement vertex {}\n",
        table.time,
        table.len(),
    )?;
    for (name, array) in names.iter().zip(&arrays) {
        let kind = match array {
            Array::F64(_) | Array::U64(_) => "double",
            Array::F32(_) => "float",
            Array::U32(_) => "uint",
            Array::U8(_) => "uchar",
        };
        let name = name.strip_prefix("position_").unwrap_or(name);
        // A name ends at the first blank, a property at the end of its line.
        let name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
        writeln!(out, "property {kind} {name}")?;
    }
    out.write_all(b"end_header\n")?;
    for index in 0..table.len() {
        for array in &arrays {
            match array {
                Array::U64(values) => out.write_all(&(values[index] as f64).to_le_bytes())?,
                _ => write_element(array, index, out)?,
            }
        }
    }
    Ok(())
}
