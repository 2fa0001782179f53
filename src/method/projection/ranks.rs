//! What the pressure equation needs of other ranks.

use super::{Projection, Scheme};
use crate::method::pressure::Equation;
use crate::method::pressure::shared::Shared;

impl<S: Scheme> Projection<S> {
    /// Lets `equation` know the other ranks, if there are any.
    pub(super) fn join_ranks(&self, equation: &mut Equation) {
        let flow = &self.liquid.flow;
        let Some(ranks) = &flow.ranks else {
            return;
        };
        let walls = (
            &self.walls.group[..],
            &self.walls.contact[..],
            flow.wall_span().own,
        );
        let mut shared = Shared::new((ranks, &flow.halo, &flow.grid), flow.liquid(), walls);
        let surface = equation.surface.iter().enumerate();
        let mut open = surface.filter(|(i, s)| **s != 0.0 && shared.has_row(*i));
        let is_open = open.next().is_some();
        shared.is_enclosed = !flow.any(is_open);
        let [x, y, z] = &mut equation.place;
        for values in [x, y, z, &mut equation.share, &mut equation.surface] {
            values.resize(shared.columns(), 0.0);
            shared.fill(values, |_| ());
        }
        equation.shared = Some(shared);
    }
}
