//! Comma-separated values: a header, then one line for each particle. Numbers have the fewest
//! digits that are read as the same bits.

use std::borrow::Cow;
use std::io::{self, Write};

use super::pvd::Entry;
use super::table::Table;
use crate::record::checkpoint::Array;

/// A text for a cell of a CSV file. Spreadsheets execute a cell that begins with `=`, `+`, `-`,
/// `@`, a tab or a line end as a formula, so an apostrophe precedes such a text; numbers are not
/// changed. The writer of the file adds quotes.
///
/// ```
/// use coronet::record::export::cell;
/// assert_eq!(cell("=1+1"), "'=1+1");
/// assert_eq!(cell("-9.81"), "-9.81");
/// assert_eq!(cell("drop.velocity"), "drop.velocity");
/// ```
pub fn cell(text: &str) -> Cow<'_, str> {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
    let is_number = || text.parse().is_ok_and(f64::is_finite);
    match is_formula && !is_number() {
        true => format!("'{text}").into(),
        false => text.into(),
    }
}

/// Writes `table` as a `.csv` file.
pub fn write(table: &Table, out: &mut impl Write) -> io::Result<()> {
    let (names, arrays): (Vec<_>, Vec<_>) = table.flat().unzip();
    out.write_all(&header(names.iter().map(String::as_str))?)?;
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

/// The index of a series: times from the start and from contact (blank before it), file, scalars.
pub fn index(entries: &[Entry]) -> io::Result<Vec<u8>> {
    let scalars = entries.first().into_iter().flat_map(|entry| &entry.scalars);
    let names = scalars.map(|(name, _)| name.as_str());
    let first = ["time_s", "time_after_contact_s", "file"].into_iter();
    let mut text = header(first.chain(names))?;
    for entry in entries {
        let after = entry.after_contact.map(|after| format!("{after:?}"));
        let after = after.unwrap_or_default();
        write!(text, "{:?},{after},{}", entry.time, entry.file)?;
        for (_, value) in &entry.scalars {
            write!(text, ",{value:?}")?;
        }
        text.push(b'\n');
    }
    Ok(text)
}

/// One line of texts.
fn header<'a>(names: impl Iterator<Item = &'a str>) -> io::Result<Vec<u8>> {
    let mut line = ::csv::Writer::from_writer(Vec::new());
    line.write_record(names.map(|name| cell(name).into_owned()))?;
    line.into_inner().map_err(|error| error.into_error())
}
