//! Wavefront OBJ; colours follow the coordinates, as MeshLab and Blender read them.

use std::io::{self, Write};

use super::Mesh;
use crate::record::mark::MARK;

pub fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "# {MARK}: liquid surface at {:?} s, m\no liquid",
        mesh.time
    )?;
    for (i, [x, y, z]) in mesh.points.iter().enumerate() {
        match mesh
            .colours
            .get(i)
            .map(|colour| colour.map(|c| f32::from(c) / 255.0))
        {
            Some([r, g, b]) => writeln!(out, "v {x} {y} {z} {r:.3} {g:.3} {b:.3}")?,
            None => writeln!(out, "v {x} {y} {z}")?,
        }
    }
    for [x, y, z] in &mesh.normals {
        writeln!(out, "vn {x:.4} {y:.4} {z:.4}")?;
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| i + 1);
        writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    Ok(())
}
