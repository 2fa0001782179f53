//! Measures against time: the table of a run, its file, and reference curves.

use std::path::{Path, PathBuf};

use crate::file::{self, FileError};
use crate::scene::Clock;
use crate::scene::LONGEST_REFERENCE;

/// One row: values by column name, in order. `NaN` is a blank.
pub type Row = Vec<(String, f64)>;

/// A file of measures that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SeriesError {
    /// A table cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: csv::Error,
    },
    /// A file cannot be opened or read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file is not valid CSV.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: csv::Error,
    },
    /// There is no column of times.
    #[error(
        "{path}: needs one column of times in seconds, `time_s` (from the start of the run) or \
         `time_after_contact_s`; the columns are {found}"
    )]
    NoTime {
        /// The file.
        path: PathBuf,
        /// Names of its columns.
        found: String,
    },
    /// Two columns have the same name.
    #[error("{path}: two columns are named `{column}`; rename or remove one")]
    Twice {
        /// The file.
        path: PathBuf,
        /// Their name.
        column: String,
    },
    /// A cell is not a number.
    #[error(
        "{path}, line {line}: `{column}` is `{value}`; give a number between -1e30 and 1e30 or \
         leave it blank"
    )]
    NotANumber {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// Text of the cell.
        value: String,
    },
    /// The times do not increase.
    #[error("{path}, line {line}: the time does not increase; sort the rows by time")]
    NotIncreasing {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
    },
}

/// Columns of equal length; `NaN` is a blank. The first column is `time_s`, from the start of the
/// run. `time_after_contact_s` is from the contact of the drop; blank before it, and in all rows
/// where nothing meets.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Names of the columns.
    pub names: Vec<String>,
    /// Values of the columns, all of one length.
    pub columns: Vec<Vec<f64>>,
}

impl Series {
    /// Appends a row; a new name adds a column, blank in earlier rows.
    pub fn push(&mut self, row: &Row) {
        let count = self.len();
        for (name, value) in row {
            let place = self.place(name).unwrap_or_else(|| {
                self.names.push(name.clone());
                self.columns.push(vec![f64::NAN; count]);
                self.names.len() - 1
            });
            if self.columns[place].len() == count {
                self.columns[place].push(*value);
            }
        }
        for column in &mut self.columns {
            column.resize(count + 1, f64::NAN);
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values of the column with this name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.place(name).map(|place| self.columns[place].as_slice())
    }

    /// Values of the column with this name, to change.
    pub fn column_mut(&mut self, name: &str) -> Option<&mut Vec<f64>> {
        self.place(name).map(|place| &mut self.columns[place])
    }

    /// The rows from `from` to `to` s.
    pub fn window(&self, from: f64, to: f64) -> Series {
        let keep: Vec<bool> = self
            .time()
            .iter()
            .map(|t| (from..=to).contains(t))
            .collect();
        let kept = |column: &Vec<f64>| {
            let pairs = column.iter().zip(&keep).filter(|(_, keep)| **keep);
            pairs.map(|(value, _)| *value).collect()
        };
        Series {
            names: self.names.clone(),
            columns: self.columns.iter().map(kept).collect(),
        }
    }

    /// Whether the column exists and contains a value.
    pub fn has(&self, name: &str) -> bool {
        self.column(name)
            .is_some_and(|values| values.iter().any(|v| v.is_finite()))
    }

    /// Removes a column, but never the first.
    fn remove_after_first(&mut self, name: &str) {
        if let Some(place) = self.names.iter().skip(1).position(|n| n == name) {
            self.names.remove(place + 1);
            self.columns.remove(place + 1);
        }
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// Times, s.
    pub fn time(&self) -> &[f64] {
        self.column("time_s").unwrap_or(&[])
    }

    /// Value and time of a column's maximum.
    pub fn maximum(&self, name: &str) -> Option<(f64, f64)> {
        let values = self.column(name)?;
        let known = values
            .iter()
            .zip(self.time())
            .filter(|(v, _)| v.is_finite());
        known.fold(None, |best, (&v, &t)| match best {
            Some((old, _)) if old >= v => best,
            _ => Some((v, t)),
        })
    }

    /// Linear interpolation of a column; `None` outside, or next to a blank.
    pub fn at(&self, name: &str, time: f64) -> Option<f64> {
        let (t, v) = (self.time(), self.column(name)?);
        let next = t.partition_point(|&x| x < time);
        if next < t.len() && t[next] == time {
            return v[next].is_finite().then_some(v[next]);
        }
        if next == 0 || next == t.len() {
            return None;
        }
        let part = (time - t[next - 1]) / (t[next] - t[next - 1]);
        let value = v[next - 1] + part * (v[next] - v[next - 1]);
        value.is_finite().then_some(value)
    }

    /// First time at which a column passes `level` upwards after `after`, s, interpolated.
    pub fn rises_through(&self, name: &str, level: f64, after: f64) -> Option<f64> {
        let (t, v) = (self.time(), self.column(name)?);
        (1..t.len()).find_map(|i| {
            let crosses = t[i - 1] >= after && v[i - 1] < level && v[i] >= level;
            crosses.then(|| t[i - 1] + (level - v[i - 1]) / (v[i] - v[i - 1]) * (t[i] - t[i - 1]))
        })
    }

    /// Writes the table as CSV; shortest digits that read back to the same number.
    ///
    /// # Errors
    /// [`SeriesError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), SeriesError> {
        let fail = |source| SeriesError::Write {
            path: path.to_owned(),
            source,
        };
        let mut file = csv::Writer::from_path(path).map_err(fail)?;
        file.write_record(&self.names).map_err(fail)?;
        for row in 0..self.len() {
            let cells = self.columns.iter().map(|c| text(c[row]));
            file.write_record(cells).map_err(fail)?;
        }
        file.flush().map_err(|e| fail(e.into()))
    }

    /// Reads a table with a `time_s` column; blanks are allowed elsewhere, and lines that start
    /// with `#`.
    ///
    /// # Errors
    /// If the file cannot be read or is not such a table.
    pub fn read(path: &Path) -> Result<Series, SeriesError> {
        Self::read_with_clock(path, None).map(|(series, _)| series)
    }

    /// As [`Series::read`], with the clock from the name of the column of times; in the series it
    /// is `time_s`. Of a table with both columns it is the one `wanted`, else the start.
    fn read_with_clock(path: &Path, wanted: Option<Clock>) -> Result<(Series, Clock), SeriesError> {
        Self::parse(path, &file::read(path, LONGEST_REFERENCE)?, wanted)
    }

    /// The same of the content of a file, which `path` names in errors.
    fn parse(
        path: &Path,
        content: &[u8],
        wanted: Option<Clock>,
    ) -> Result<(Series, Clock), SeriesError> {
        let fail = |source| SeriesError::Read {
            path: path.to_owned(),
            source,
        };
        let mut file = file::table(content);
        let names: Vec<String> = file
            .headers()
            .map_err(fail)?
            .iter()
            .map(str::to_owned)
            .collect();
        let places = times(path, &names)?;
        let is_wanted = |(_, clock): &&(usize, Clock)| Some(*clock) == wanted;
        let (time, clock) = *places.iter().find(is_wanted).unwrap_or(&places[0]);
        // The other clock has no time before the contact.
        let may_be_blank = places.len() > 1 && clock == Clock::Contact;
        let mut columns = vec![Vec::new(); names.len()];
        for record in file.records() {
            let record = record.map_err(fail)?;
            let line = record.position().map_or(0, csv::Position::line);
            if may_be_blank && record.get(time) == Some("") {
                continue;
            }
            for (place, cell) in record.iter().enumerate() {
                let number = match cell {
                    "" => f64::NAN,
                    _ => number(cell).ok_or_else(|| SeriesError::NotANumber {
                        path: path.to_owned(),
                        line,
                        column: names[place].clone(),
                        value: cell.to_owned(),
                    })?,
                };
                columns[place].push(number);
            }
            let t = &columns[time];
            let increases = match t.as_slice() {
                [.., before, now] => now > before,
                [only] => only.is_finite(),
                [] => true,
            };
            if !increases {
                return Err(SeriesError::NotIncreasing {
                    path: path.to_owned(),
                    line,
                });
            }
        }
        columns.swap(0, time);
        let mut names = names;
        names.swap(0, time);
        names[0] = Clock::COLUMNS[0].0.to_string();
        let mut series = Series { names, columns };
        if may_be_blank {
            series.remove_after_first(Clock::COLUMNS[0].0);
        }
        Ok((series, clock))
    }
}

/// The number of a cell. Plots are of single precision, and nothing that is measured is greater.
fn number(cell: &str) -> Option<f64> {
    let number: f64 = cell.parse().ok()?;
    (number.is_nan() || number.abs() <= 1e30).then_some(number)
}

/// Places of the columns of times, one or both, with their clocks.
fn times(path: &Path, names: &[String]) -> Result<Vec<(usize, Clock)>, SeriesError> {
    let path = path.to_owned();
    let twice = (1..names.len()).find(|&k| names[..k].contains(&names[k]));
    if let Some(k) = twice {
        let column = names[k].clone();
        return Err(SeriesError::Twice { path, column });
    }
    let clocks = Clock::COLUMNS.iter();
    let found = clocks.filter_map(|(name, clock)| {
        let place = names.iter().position(|n| n == name)?;
        Some((place, *clock))
    });
    let found: Vec<(usize, Clock)> = found.collect();
    match found.is_empty() {
        true => Err(SeriesError::NoTime {
            path,
            found: names.join(", "),
        }),
        false => Ok(found),
    }
}

/// Whether a column is one of times.
pub fn is_clock(name: &str) -> bool {
    Clock::COLUMNS.iter().any(|(column, _)| *column == name)
}

/// A table to compare runs with, and the zero of its times.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The table; its times are in `time_s`.
    pub table: Series,
    /// Instant from which its times count.
    pub clock: Clock,
}

impl Reference {
    /// Reads a table; `clock` overrides the name of its column of times. A table with both columns
    /// is read by the one of `clock`, else by `time_s`.
    ///
    /// # Errors
    /// Those of [`Series::read`].
    pub fn read(path: &Path, clock: Option<Clock>) -> Result<Reference, SeriesError> {
        Self::parse(path, &file::read(path, LONGEST_REFERENCE)?, clock)
    }

    /// As [`Reference::read`], of the content of a file, which `path` names in errors.
    ///
    /// # Errors
    /// Those of [`Series::read`].
    pub fn parse(
        path: &Path,
        content: &[u8],
        clock: Option<Clock>,
    ) -> Result<Reference, SeriesError> {
        let (table, own) = Series::parse(path, content, clock)?;
        Ok(Reference {
            table,
            clock: clock.unwrap_or(own),
        })
    }

    /// Time of a run minus that of the table, s; `contact`: time of contact in the run, s.
    pub fn shift(&self, contact: f64) -> f64 {
        match self.clock {
            Clock::Start => 0.0,
            Clock::Contact => contact,
        }
    }
}

fn text(value: f64) -> String {
    if value.is_finite() {
        let (plain, short) = (format!("{value}"), format!("{value:e}"));
        if short.len() < plain.len() {
            short
        } else {
            plain
        }
    } else {
        String::new()
    }
}
