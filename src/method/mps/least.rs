//! What the gradients of MPS subtract from pressures.

use super::Mps;
use super::pass::Pressed;
use crate::method::projection::Projection;
use crate::scene::MpsGradient;
use crate::space::parallel::each_mut;

impl Projection<Mps> {
    /// P and Q: p (`symmetric`), p and the least about it (`minimum`), or p and
    /// itself, near a surface with its sign turned.
    pub(super) fn pack_pressure(&mut self) {
        let n = self.liquid.len();
        let gradient = self.scheme.gradient;
        if gradient == MpsGradient::Minimum {
            self.find_least();
        }
        let (x, walls, marks) = (&self.unknown, &self.walls, &self.own.marks);
        let least = &self.scheme.least;
        self.liquid.flow.pack(
            |_, i| {
                let q = match gradient {
                    MpsGradient::Symmetric => 0.0,
                    MpsGradient::Minimum => least[i],
                    _ if marks[i] > 0.0 => -x[i],
                    _ => x[i],
                };
                Pressed {
                    pressure: x[i] as f32,
                    level: q as f32,
                }
            },
            |_, j| {
                let p = x[n + walls.group[j] as usize] + walls.offset[j] as f64;
                Pressed {
                    pressure: p as f32,
                    level: 0.0,
                }
            },
        );
    }

    /// The least pressure within the radius of (3) of every liquid particle, itself included.
    fn find_least(&mut self) {
        let n = self.liquid.len();
        let (flow, walls, x) = (&self.liquid.flow, &self.walls, &self.unknown);
        let pressure = |j: usize| match flow.original(j).checked_sub(n) {
            None => x[flow.original(j)],
            Some(w) => x[n + walls.group[w] as usize] + walls.offset[w] as f64,
        };
        let square = (self.scheme.radius * self.liquid.case.spacing).powi(2);
        let unit = flow.grid.unit;
        self.scheme.least.resize(n, 0.0);
        each_mut(&mut self.scheme.least[..n], |i, least| {
            let own = &flow.records[i];
            let mut lowest = pressure(i);
            for j in flow.rows.row(i).indices() {
                let other = &flow.records[j];
                let away = |a: usize| other.at(a).wrapping_sub(own.at(a)) as f64 * unit[a];
                if (0..3).map(|a| away(a).powi(2)).sum::<f64>() < square {
                    lowest = lowest.min(pressure(j));
                }
            }
            *least = lowest;
        });
    }
}
