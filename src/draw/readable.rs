//! Columns of measures in words and units for readers.

/// How a column is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Readable {
    /// Its name without unit.
    pub words: String,
    /// Unit of the values; empty for a ratio.
    pub unit: &'static str,
    /// The values are multiplied by this.
    pub factor: f64,
    /// Whether the values are of a metre of depth, in two dimensions.
    pub is_per_metre: bool,
}

/// Endings of names, the longest first, and what they become: unit, factor, and the least largest
/// value for which it is taken.
const UNITS: [(&str, &str, f64, f64); 26] = [
    ("_kg_m_s", "kg m/s", 1.0, 0.1),
    ("_kg_m_s", "mg m/s", 1e6, 0.0),
    ("_m_s", "m/s", 1.0, 0.1),
    ("_m_s", "mm/s", 1e3, 0.0),
    ("_m2", "mm\u{b2}", 1e6, 0.0),
    ("_m", "m", 1.0, 1.0),
    ("_m", "mm", 1e3, 1e-4),
    ("_m", "\u{b5}m", 1e6, 0.0),
    ("_s", "s", 1.0, 1.0),
    ("_s", "ms", 1e3, 1e-4),
    ("_s", "\u{b5}s", 1e6, 0.0),
    ("_Pa", "kPa", 1e-3, 2000.0),
    ("_Pa", "Pa", 1.0, 0.0),
    ("_N", "N", 1.0, 0.1),
    ("_N", "mN", 1e3, 0.0),
    ("_J", "J", 1.0, 1.0),
    ("_J", "mJ", 1e3, 1e-3),
    ("_J", "\u{b5}J", 1e6, 1e-6),
    ("_J", "nJ", 1e9, 0.0),
    ("_kg", "kg", 1.0, 1.0),
    ("_kg", "g", 1e3, 1e-3),
    ("_kg", "mg", 1e6, 1e-6),
    ("_kg", "\u{b5}g", 1e9, 0.0),
    ("_deg", "\u{b0}", 1.0, 0.0),
    ("_part", "%", 100.0, 0.0),
    ("", "", 1.0, 0.0),
];

impl Readable {
    /// Of a column whose largest absolute value is `most`.
    pub fn of(column: &str, most: f64) -> Readable {
        let fits = |(ending, _, _, least): &&(&str, &str, f64, f64)| {
            column.ends_with(ending) && most >= *least
        };
        let found = UNITS.iter().find(fits);
        let (ending, unit, factor, _) = *found.unwrap_or(&UNITS[UNITS.len() - 1]);
        let name = column.strip_suffix(ending).unwrap_or(column);
        Readable {
            words: name.replace('_', " "),
            unit,
            factor,
            is_per_metre: false,
        }
    }

    /// The same of a scene in two dimensions.
    pub fn in_two(mut self) -> Readable {
        let ends = ["J", "N", "kg", "g", "g m/s", "mm\u{b2}"];
        self.is_per_metre = ends.iter().any(|end| self.unit.ends_with(end));
        self
    }

    /// For an axis.
    pub fn label(&self) -> String {
        match self.unit {
            "" => self.words.clone(),
            unit if self.is_per_metre => format!("{} ({unit}/m)", self.words),
            unit => format!("{} ({unit})", self.words),
        }
    }
}
