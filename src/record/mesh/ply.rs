//! Polygon file format (Turk 1994), binary little-endian.

use std::io::{self, Write};

use super::Mesh;
use crate::record::mark::MARK;

pub fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment {MARK}\ncomment time_s {:?}\n\
         element vertex {}\n",
        mesh.time,
        mesh.points.len(),
    )?;
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        writeln!(out, "property float {name}")?;
    }
    if !mesh.colours.is_empty() {
        for name in ["red", "green", "blue"] {
            writeln!(out, "property uchar {name}")?;
        }
    }
    write!(
        out,
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.triangles.len()
    )?;
    for (i, (point, normal)) in mesh.points.iter().zip(&mesh.normals).enumerate() {
        for value in point.iter().chain(normal) {
            out.write_all(&value.to_le_bytes())?;
        }
        if let Some(colour) = mesh.colours.get(i) {
            out.write_all(colour)?;
        }
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for index in triangle {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}
