//! NumPy's archive: a zip of one `.npy` array a quantity (NumPy enhancement proposal 1), not
//! compressed, as `numpy.savez` writes it. `numpy.load(file)["position"]` has the shape (n, 3).
//! Scalars and the times, `time_s` and `time_after_contact_s` (NaN before it), are arrays without a
//! dimension.
//!
//! Neither Parquet nor Zarr: both pay where columns are searched or cut out of large files. A frame
//! is read as a whole, the number of particles changes from frame to frame, and every reader of
//! these two has NumPy as well; the libraries that write them are as large as this program.

use std::collections::HashSet;
use std::io::{self, Write};

use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

use super::table::Table;
use super::vtp::write_element;
use crate::record::checkpoint::Array;

/// Archives need another form of entries from this length on, bytes.
const LARGE: u64 = u32::MAX as u64;

/// Writes `table` as a `.npz` file.
pub fn write<W: Write>(table: &Table, out: &mut W) -> io::Result<()> {
    let mut archive = Archive {
        zip: ZipWriter::new_stream(out),
        names: HashSet::new(),
    };
    for column in std::iter::once(&table.position).chain(&table.columns) {
        let arrays: Vec<&Array> = column.components.iter().collect();
        let shape = match arrays.len() {
            1 => format!("({},)", table.len()),
            width => format!("({}, {width})", table.len()),
        };
        archive.add(&column.name, &shape, &arrays)?;
    }
    let after = table.after_contact.unwrap_or(f64::NAN);
    let times = [("time_s", table.time), ("time_after_contact_s", after)];
    let times = times.map(|(name, time)| (name.to_string(), time));
    for (name, value) in times.iter().chain(&table.scalars) {
        archive.add(name, "()", &[&Array::F64(vec![*value])])?;
    }
    archive.zip.finish()?;
    Ok(())
}

struct Archive<W: Write> {
    zip: ZipWriter<StreamWriter<W>>,
    names: HashSet<String>,
}

impl<W: Write> Archive<W> {
    /// Adds an array; the last axis of `shape` counts `components`.
    fn add(&mut self, name: &str, shape: &str, components: &[&Array]) -> io::Result<()> {
        let (kind, width) = match components[0] {
            Array::F64(_) => ("<f8", 8),
            Array::F32(_) => ("<f4", 4),
            Array::U64(_) => ("<u8", 8),
            Array::U32(_) => ("<u4", 4),
            Array::U8(_) => ("|u1", 1),
        };
        let length = width * (components.len() * components[0].len()) as u64;
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(length + 1024 > LARGE);
        let name = format!("{}.npy", self.unique(name));
        self.zip.start_file(name, options)?;
        self.zip.write_all(&header(kind, shape))?;
        for index in 0..components[0].len() {
            for component in components {
                write_element(component, index, &mut self.zip)?;
            }
        }
        Ok(())
    }

    /// A name that is an identifier, and not yet in the archive.
    fn unique(&mut self, name: &str) -> String {
        let name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        let free = names.find(|name| !self.names.contains(name));
        let free = free.expect("numbers do not end");
        self.names.insert(free.clone());
        free
    }
}

/// The beginning of a `.npy` file: the magic, version 1.0, and a Python dictionary that is filled
/// with blanks to a multiple of 64 bytes.
fn header(kind: &str, shape: &str) -> Vec<u8> {
    let facts = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let before = 10;
    let length = (before + facts.len() + 1).next_multiple_of(64) - before;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{facts:<width$}\n", width = length - 1).bytes());
    bytes
}
