//! VTK XML PolyData, data appended raw, each after a UInt64 length (VTK file formats, "XML file
//! formats", version 1.0).

use std::io::{self, Write};

use super::{Mesh, numbers};
use crate::record::mark::MARK;

pub fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    let corners = mesh.triangles.as_flattened().iter();
    let ends = (1..=mesh.triangles.len() as i64).map(|n| 3 * n);
    let mut arrays = vec![
        ("Float32", "position", 3, numbers(&mesh.points)),
        (
            "Int64",
            "connectivity",
            1,
            integers(corners.map(|i| i64::from(*i))),
        ),
        ("Int64", "offsets", 1, integers(ends)),
        ("Float32", "normal", 3, numbers(&mesh.normals)),
    ];
    if !mesh.colours.is_empty() {
        arrays.push(("UInt8", "colour", 3, mesh.colours.as_flattened().to_vec()));
    }
    let mut offset = 0;
    let mut lines = Vec::new();
    for (kind, name, components, data) in &arrays {
        lines.push(format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{offset}\"/>"
        ));
        offset += 8 + data.len();
    }
    write!(
        out,
        r#"<?xml version="1.0"?>
<!-- {MARK} -->
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <PolyData>
    <FieldData>
      <DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{:e}</DataArray>
    </FieldData>
    <Piece NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0"
           NumberOfPolys="{}">
      <Points>{}</Points>
      <Polys>{}{}</Polys>
      <PointData Normals="normal">{}</PointData>
    </Piece>
  </PolyData>
  <AppendedData encoding="raw">
_"#,
        mesh.time,
        mesh.points.len(),
        mesh.triangles.len(),
        lines[0],
        lines[1],
        lines[2],
        lines[3..].concat(),
    )?;
    for (.., data) in &arrays {
        out.write_all(&(data.len() as u64).to_le_bytes())?;
        out.write_all(data)?;
    }
    out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

fn integers(values: impl Iterator<Item = i64>) -> Vec<u8> {
    values.flat_map(i64::to_le_bytes).collect()
}
