//! What the report says in words.

use super::Post;
use super::instants::Instants;
use crate::measure::moment::moment;
use crate::measure::norm::Norm;
use crate::measure::series::is_clock;
use crate::scene::Clock;

impl Post {
    /// Sentences below the results.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = self.remarks.clone();
        if let Some(level) = self.gauge.start.level {
            notes.push(format!(
                "Lengths count from the pool level in the first frame, {:.3} mm above the floor.",
                1e3 * level
            ));
        }
        if self.shift > 0.0 {
            notes.push(format!(
                "Plots and tables count time from the contact of the drop, {} after the start; \
                 measures.csv has both times.",
                moment(self.shift, self.scene.impact.end, 3)
            ));
        }
        notes.extend(self.references.iter().map(|(label, reference)| {
            let zero = match reference.clock {
                Clock::Start => "the start of its run",
                Clock::Contact => "the contact of its drop",
            };
            format!("The reference {label} counts time from {zero}.")
        }));
        notes
    }

    /// An instant, s from the start, as the report counts it.
    pub(super) fn moment(&self, time: f64, decimals: usize) -> String {
        moment(time - self.shift, self.scene.impact.end, decimals)
    }

    /// Cells of the table of distances.
    pub(super) fn norm_cells(&self, norm: &Norm) -> [String; 5] {
        let percent = |part: f64| format!("{:.1} %", 100.0 * part);
        let ends = [norm.from, norm.to].map(|time| self.moment(time + norm.shift, 1));
        let [from, to] = ends;
        let span = match from.split_once(' ') {
            Some((from, _)) => format!("{from}–{to}"),
            None => to,
        };
        let (l2, max) = (percent(norm.l2), percent(norm.max));
        [norm.label.clone(), norm.column.clone(), l2, max, span]
    }

    /// Requested instants after the last frame, and references of which nothing is measured.
    pub(super) fn missed(&self) -> Vec<String> {
        let end = self.series.time().last().copied().unwrap_or(0.0);
        let sentence = |what: &str, time: f64| {
            // In one unit, which suits the later one.
            let [time, end] = [time, end].map(|one| moment(one, time.max(end), 1));
            format!("No {what} at {time}: the last frame is at {end}.")
        };
        let of = |what, instants: &Instants| -> Vec<String> {
            let left = instants.left.iter().rev();
            left.map(|time| sentence(what, *time)).collect()
        };
        let strange = self.references.iter().filter_map(|(label, reference)| {
            let names = &reference.table.names;
            let is_known = |name: &String| !is_clock(name) && self.series.column(name).is_some();
            let is_strange = !names.iter().any(is_known);
            let columns = names.iter().filter(|name| !is_clock(name)).cloned();
            is_strange.then(|| {
                format!(
                    "Nothing of the reference {label}: measures.csv has none of its columns {}.",
                    columns.collect::<Vec<_>>().join(", ")
                )
            })
        });
        let late = self.references.iter().filter_map(|(label, reference)| {
            let shift = reference.shift(self.shift);
            let times = reference.table.time();
            let is_late = times
                .iter()
                .all(|time| !(0.0..=end).contains(&(time + shift)));
            is_late.then(|| {
                let range = match times {
                    [] => "it has no row".to_string(),
                    [first, .., last] => {
                        format!("its times, {first} to {last} s, are not those of the run")
                    }
                    [only] => format!("its time, {only} s, is not one of the run"),
                };
                format!("Nothing of the reference {label}: {range}.")
            })
        });
        let mut missed = [of("panel", &self.panels), of("field", &self.fields)].concat();
        missed.extend(self.unmet.iter().map(|label| {
            format!(
                "Nothing of the reference {label}: its times count from a contact; there is none."
            )
        }));
        missed.extend(strange);
        missed.extend(late);
        missed
    }
}
