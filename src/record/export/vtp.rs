//! VTK XML PolyData: one vertex for each particle, data appended raw, each after a UInt64 length
//! (VTK file formats, "XML file formats", version 1.0).

use std::io::{self, Write};

use super::table::{Column, Table};
use crate::record::checkpoint::Array;

/// Writes `table` as a `.vtp` file.
pub fn write(table: &Table, out: &mut impl Write) -> io::Result<()> {
    let count = table.len() as u64;
    let mut offset = 0;
    let mut place = |bytes: u64| {
        let here = offset;
        offset += 8 + bytes;
        here
    };
    let mut arrays = |columns: &mut dyn Iterator<Item = &Column>| {
        let mut text = String::new();
        for column in columns {
            let size = width(&column.components[0]) * column.components.len() as u64;
            text += &format!(
                "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" \
                 format=\"appended\" offset=\"{}\"/>\n",
                type_name(&column.components[0]),
                escape(&column.name),
                column.components.len(),
                place(size * count),
            );
        }
        text
    };
    let points = arrays(&mut std::iter::once(&table.position));
    let data = arrays(&mut table.columns.iter());
    let (connectivity, offsets) = (place(8 * count), place(8 * count));
    let fields = fields(table);
    write!(
        out,
        r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <PolyData>
    <FieldData>
{fields}    </FieldData>
    <Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0"
           NumberOfPolys="0">
      <PointData>
{data}      </PointData>
      <Points>
{points}      </Points>
      <Verts>
        <DataArray type="Int64" Name="connectivity" format="appended" offset="{connectivity}"/>
        <DataArray type="Int64" Name="offsets" format="appended" offset="{offsets}"/>
      </Verts>
    </Piece>
  </PolyData>
  <AppendedData encoding="raw">
_"#,
    )?;
    for column in std::iter::once(&table.position).chain(&table.columns) {
        write_column(column, out)?;
    }
    for first in [0, 1] {
        out.write_all(&(8 * count).to_le_bytes())?;
        for index in first..first + count {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

/// The time, which readers of `.vtp` series use, and the scalars.
fn fields(table: &Table) -> String {
    let mut text = String::new();
    let time = ("TimeValue".to_string(), table.time);
    for (name, value) in std::iter::once(&time).chain(&table.scalars) {
        text += &format!(
            "      <DataArray type=\"Float64\" Name=\"{}\" NumberOfTuples=\"1\" \
             format=\"ascii\">{value:e}</DataArray>\n",
            escape(name),
        );
    }
    text
}

fn write_column(column: &Column, out: &mut impl Write) -> io::Result<()> {
    let first = &column.components[0];
    let length = width(first) * (column.components.len() * first.len()) as u64;
    out.write_all(&length.to_le_bytes())?;
    for index in 0..first.len() {
        for component in &column.components {
            write_element(component, index, out)?;
        }
    }
    Ok(())
}

/// Writes one number, little-endian.
pub(super) fn write_element(array: &Array, index: usize, out: &mut impl Write) -> io::Result<()> {
    match array {
        Array::F64(values) => out.write_all(&values[index].to_le_bytes()),
        Array::F32(values) => out.write_all(&values[index].to_le_bytes()),
        Array::U64(values) => out.write_all(&values[index].to_le_bytes()),
        Array::U32(values) => out.write_all(&values[index].to_le_bytes()),
        Array::U8(values) => out.write_all(&values[index].to_le_bytes()),
    }
}

fn width(array: &Array) -> u64 {
    match array {
        Array::F64(_) | Array::U64(_) => 8,
        Array::F32(_) | Array::U32(_) => 4,
        Array::U8(_) => 1,
    }
}

fn type_name(array: &Array) -> &'static str {
    match array {
        Array::F64(_) => "Float64",
        Array::F32(_) => "Float32",
        Array::U64(_) => "UInt64",
        Array::U32(_) => "UInt32",
        Array::U8(_) => "UInt8",
    }
}

/// A text for an attribute. XML cannot contain control characters; they become `_`.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace(
            |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'),
            "_",
        )
}
