//! The plots of a scene, with the reference curves in them.

use super::canvas::Colour;
use super::plot::{Curve, Line, PALETTE, Plot, REFERENCE};
use crate::measure::kind::{Kind, contact_within};
use crate::measure::series::{Reference, Series};
use crate::measure::summary;
use crate::scene::Scene;

/// A run, and the references to compare it with.
pub struct Figures<'a> {
    /// The scene of the run.
    pub scene: &'a Scene,
    /// Which measures it has.
    pub kind: Kind,
    /// The measures of the run.
    pub series: &'a Series,
    /// Label and table.
    pub references: &'a [(String, Reference)],
    /// Time of contact, s: plots count from it.
    pub shift: f64,
}

impl Figures<'_> {
    /// The plots that have something to show.
    pub fn plots(&self) -> Vec<Plot> {
        let mm = 1e3;
        let mut plots = match self.kind {
            Kind::Pool(_) => vec![
                self.plot(
                    "Crater depth",
                    "depth (mm)",
                    mm,
                    &[
                        ("crater_depth_m", "from the initial level"),
                        ("crater_depth_far_m", "from the far level"),
                    ],
                ),
                self.plot(
                    "Crater diameter",
                    "diameter at the initial level (mm)",
                    mm,
                    &[("crater_diameter_m", "this run")],
                ),
                self.plot(
                    "Crown and jet height",
                    "height (mm)",
                    mm,
                    &[("crown_height_m", "crown"), ("jet_height_m", "jet")],
                ),
            ],
            Kind::Wall(_) => self.wall_plots(),
            Kind::Shape => {
                let amplitude = [("amplitude", "this run")];
                let mut plot = self.plot("Oscillation", "amplitude / radius", 1.0, &amplitude);
                plot.from_zero = false;
                let aspect = [("aspect_ratio", "this run")];
                let mut ratio = self.plot("Aspect ratio", "height / width", 1.0, &aspect);
                ratio.from_zero = false;
                vec![plot, ratio]
            }
            Kind::Front => vec![self.plot(
                "Front and column",
                "position (mm)",
                mm,
                &[("front_m", "front"), ("column_height_m", "column")],
            )],
            Kind::Level => {
                let level = [("surface_level_m", "this run")];
                let mut plot = self.plot("Level", "level (mm)", mm, &level);
                plot.from_zero = false;
                vec![plot]
            }
            Kind::Bulk => {
                let speed = [("speed_max_m_s", "this run")];
                vec![self.plot("Highest speed", "speed (m/s)", 1.0, &speed)]
            }
        };
        plots.extend([self.energy(), self.budget()]);
        plots.retain(Plot::has_points);
        plots
    }

    fn wall_plots(&self) -> Vec<Plot> {
        let spread = [
            ("spread_factor", "wetted"),
            ("max_diameter_factor", "at any height"),
        ];
        let apex = [("apex_height_m", "this run")];
        vec![
            self.plot("Spread factor", "diameter / drop diameter", 1.0, &spread),
            self.plot("Apex height", "height (mm)", 1e3, &apex),
        ]
    }

    /// Label of the time axis.
    pub fn time_label(&self) -> &'static str {
        match contact_within(self.scene) {
            Some(_) => "time after contact (ms)",
            None => "time (ms)",
        }
    }

    fn plot(&self, title: &str, y: &str, factor: f64, columns: &[(&str, &str)]) -> Plot {
        let mut curves = Vec::new();
        for (n, (column, label)) in columns.iter().enumerate() {
            if let Some(values) = self.series.column(column) {
                let line = if n == 0 || !column.contains("_far_") {
                    Line::Solid
                } else {
                    Line::Dashed
                };
                curves.push(Curve {
                    label: (*label).to_owned(),
                    points: self.own(column, values, factor),
                    line,
                    colour: PALETTE[n % PALETTE.len()],
                });
            }
        }
        // A second measure of the same length is not compared.
        let own: Vec<_> = columns.iter().filter(|c| !c.0.contains("_far_")).collect();
        for (n, (column, label)) in own.iter().enumerate() {
            let what = (own.len() > 1).then_some((*label, PALETTE[n % PALETTE.len()]));
            self.add_references(column, what, factor, &mut curves);
        }
        Plot {
            title: title.to_owned(),
            x: self.time_label().to_owned(),
            y: y.to_owned(),
            curves,
            from_zero: true,
        }
    }

    /// `what`: of several columns the label and the colour of this one.
    fn add_references(
        &self,
        column: &str,
        what: Option<(&str, Colour)>,
        factor: f64,
        curves: &mut Vec<Curve>,
    ) {
        for (n, (label, reference)) in self.references.iter().enumerate() {
            let table = &reference.table;
            let Some(values) = table.column(column).filter(|_| table.has(column)) else {
                continue;
            };
            let end = self.series.time().last().copied().unwrap_or(0.0) - self.shift;
            let shift = self.shift - reference.shift(self.shift);
            let mut points = self.points(table, values, factor, shift);
            points.retain(|p| p[0] <= 1.05e3 * end);
            let label = match what {
                Some((what, _)) => format!("{label}: {what}"),
                None => label.clone(),
            };
            // The curves of a lone reference go with those of the run.
            let colour = match what {
                Some((_, colour)) if self.references.len() == 1 => colour,
                _ => REFERENCE[n % REFERENCE.len()],
            };
            curves.push(Curve {
                label,
                points,
                line: Line::Dashed,
                colour,
            });
        }
    }

    /// Of a crater only what comes after contact: before, there are but ripples.
    fn own(&self, column: &str, values: &[f64], factor: f64) -> Vec<[f64; 2]> {
        let from = contact_within(self.scene).map(|contact| 1e3 * (contact - self.shift));
        let mut points = self.points(self.series, values, factor, self.shift);
        if column.starts_with("crater_") {
            points.retain(|[time, _]| from.is_some_and(|from| *time >= from));
        }
        points
    }

    fn points(&self, table: &Series, values: &[f64], factor: f64, shift: f64) -> Vec<[f64; 2]> {
        let pairs = table.time().iter().zip(values);
        pairs
            .map(|(t, v)| [1e3 * (t - shift), factor * v])
            .collect()
    }

    fn since_first(&self, name: &str) -> Option<Vec<f64>> {
        let energy = self.series.column(name)?;
        Some(energy.iter().map(|e| e - energy[0]).collect())
    }

    /// Energies from those of the first frame; kinetic from zero.
    fn energy(&self) -> Plot {
        let kinetic = self.series.column("kinetic_energy_J").map(<[f64]>::to_vec);
        let compression = self.since_first("compression_energy_J");
        let mut sum = summary::total_energy(self.series);
        if let (Some(sum), Some(compression)) = (&mut sum, &compression) {
            sum.iter_mut()
                .zip(compression)
                .for_each(|(sum, e)| *sum += e);
        }
        let parts = [
            ("kinetic", kinetic),
            ("potential", self.since_first("potential_energy_J")),
            ("surface", self.since_first("surface_energy_J")),
            ("compression", compression),
            ("sum", sum),
        ];
        self.energies("Energy", "energy from the start", &parts)
    }

    /// What was taken from the sum of the energies, and the unexplained rest.
    fn budget(&self) -> Plot {
        let taken = |name: &str| {
            let work = self.since_first(name)?;
            Some(work.iter().map(|w| -w).collect::<Vec<f64>>())
        };
        let parts = [
            ("viscosity", taken("viscosity_work_J")),
            ("diffusion of density", taken("diffusion_work_J")),
            ("shifting", taken("shifting_work_J")),
            ("removal", taken("removal_work_J")),
            ("walls", taken("wall_work_J")),
            ("pressure", taken("pressure_work_J")),
            ("unexplained", taken("energy_unexplained_J")),
        ];
        self.energies("Energy budget", "energy taken since the start", &parts)
    }

    /// The last of `parts`, named energies in J, is emphasised.
    fn energies(&self, title: &str, y: &str, parts: &[(&str, Option<Vec<f64>>)]) -> Plot {
        let known = parts.iter().filter_map(|(_, e)| e.as_ref()).flatten();
        let known = known.filter(|e| e.is_finite());
        let largest = known.fold(0.0f64, |most, e| most.max(e.abs()));
        let per = match self.scene.space() {
            2 => "/m",
            _ => "",
        };
        let (factor, unit) = match largest {
            e if e >= 1.0 => (1.0, "J"),
            e if e >= 1e-3 => (1e3, "mJ"),
            e if e >= 1e-6 => (1e6, "µJ"),
            _ => (1e9, "nJ"),
        };
        let curve = |(n, (label, energy)): (usize, &(&str, Option<Vec<f64>>))| {
            let energy = energy.as_ref().filter(|e| e.iter().any(|v| *v != 0.0))?;
            let (line, colour) = match n + 1 == parts.len() {
                true => (Line::Dashed, REFERENCE[0]),
                false => (Line::Solid, PALETTE[n]),
            };
            Some(Curve {
                label: (*label).to_owned(),
                points: self.points(self.series, energy, factor, self.shift),
                line,
                colour,
            })
        };
        Plot {
            title: title.to_owned(),
            x: self.time_label().to_owned(),
            y: format!("{y} ({unit}{per})"),
            curves: parts.iter().enumerate().filter_map(curve).collect(),
            from_zero: true,
        }
    }
}
