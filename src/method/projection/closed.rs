//! The momentum of closed bodies, which corrected gradients do not keep.
//!
//! What liquid touches nothing else gets no momentum from its own pressure. Differences p_b - p_a
//! under the matrix of each particle are exact for linear p but no forces of pairs: two drops that
//! met head-on lost 5e-3 of M V. Of all accelerations that keep the momentum
//! (1) a_i - SUM m a / SUM m
//! over a body are the nearest to those of the gradient (least squares, weighted by mass). They
//! change no relative motion within the body. Bodies are what no pair of rows connects
//! ([`Components`]); one that reaches a wall is left alone, and along the normal of a mirror plane
//! so is one that reaches that.
//! Test: tests/engine/method_conservation.rs.

use super::{Projection, Scheme};
use crate::space::component::Components;
use serde::{Deserialize, Serialize};

/// Bodies and what their gradients add to their momentum.
#[derive(Debug, Default)]
pub(super) struct Closed {
    components: Components,
    /// By component.
    sums: Vec<Body>,
}

/// Accelerations of a body, m/s^2, and the number of its particles.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Body {
    sum: [f64; 3],
    count: usize,
    /// Axes along which something outside pushes it.
    open: [bool; 3],
}

impl Closed {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.components.memory() + std::mem::size_of::<Body>() * self.sums.capacity()
    }
}

impl<S: Scheme> Projection<S> {
    /// (1) for `push`. Cells and rows are those of the start of the step.
    pub(super) fn keep_momentum(&mut self) {
        let flow = &self.liquid.flow;
        let reach = self.liquid.case.h * 2.0 + flow.extra().most;
        let own = &flow.liquid_cells.start;
        let Closed { components, sums } = &mut self.closed;
        let (filled, has_walls) = (flow.filled(), flow.has_walls());
        components.find(&flow.grid, reach, |cell| {
            own[cell] < own[cell + 1]
                || filled.get(cell).is_some_and(|&filled| filled)
                || has_walls && flow.is_walled(cell)
        });
        sums.clear();
        sums.resize(components.len(), Body::default());
        if has_walls {
            for (body, cells) in components.runs() {
                let walled = cells.clone().any(|cell| flow.is_walled(cell));
                sums[body].open = sums[body].open.map(|open| open || walled);
            }
        }
        let mut bodies = components.runs().map(|(body, _)| &sums[body]);
        if bodies.all(|body| body.open == [true; 3]) {
            return;
        }
        let planes = [0, 1, 2].map(|a| self.liquid.case.domain.mirrors(a));
        let push = &self.own.push;
        let add = |sums: &mut Vec<Body>| {
            for (body, cells) in components.runs() {
                let body = &mut sums[body];
                if body.open == [true; 3] {
                    continue;
                }
                for i in own[cells.start] as usize..own[cells.end] as usize {
                    body.count += 1;
                    for a in 0..3 {
                        body.sum[a] += push[i][a] as f64;
                        let x = flow.particles.position[a][i];
                        let near = |plane: &f64| (x - plane).abs() < reach;
                        body.open[a] |= planes[a].iter().flatten().any(near);
                    }
                }
            }
        };
        match &flow.ranks {
            None => add(sums),
            Some(ranks) => *sums = ranks.in_turn(std::mem::take(sums), add),
        }
        for (body, cells) in components.runs() {
            let body = &sums[body];
            if body.open == [true; 3] {
                continue;
            }
            for push in &mut self.own.push[own[cells.start] as usize..own[cells.end] as usize] {
                for a in (0..3).filter(|&a| !body.open[a]) {
                    push[a] = (push[a] as f64 - body.sum[a] / body.count as f64) as f32;
                }
            }
        }
    }
}
