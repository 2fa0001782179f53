//! The pressure P that stands, kappa of which the share beta of A spares in (3) of
//! [`super::transposed`]: the mean of p over the last steps, with a tension that has an energy.
//!
//! Without P the mixture is a divergence wherever pressure differs between layers, as what is added
//! to the equation of grids is for the same reason (Rhie & Chow 1983), and the more the longer
//! steps are: the load of a surface thins the third layer of a drop by 7 %. With the last p in
//! place of P, what the mixture takes from a mode comes back in the next step, when particles are
//! elsewhere, and feeds it. With all of P (kappa = 1) pools stir: D G has no say about every second
//! particle (docs/lab.md). Tests: tests/validation/drop.rs, tests/validation/vibration.rs.

use super::product::Product;
use super::transposed::share;
use super::{Projection, Scheme};
use crate::space::parallel::each_mut;

/// kappa, the largest of the trials in docs/lab.md with which pools of water stay quiet.
const STANDING: f64 = 0.5;

/// Part of p that enters P in a step: small beside 1, for P to have nothing of what A is there for.
const NEW: f32 = 0.05;

impl<S: Scheme> Projection<S> {
    /// Whether there is P.
    pub(super) fn stands(&self) -> bool {
        !self.transposed.completed.is_empty()
    }

    /// The solution enters P.
    pub(super) fn remember_pressure(&mut self) {
        let p = &self.unknown;
        each_mut(&mut self.own.standing[..], |i, mean| {
            *mean += NEW * (p[i] as f32 - *mean);
        });
    }

    /// Adds [`STANDING`] beta (A / rho0 - D G) P to the right-hand side.
    pub(super) fn let_stand(&mut self) {
        let beta = STANDING * share(self.settings.theta);
        let n = self.liquid.len();
        let mut equation = std::mem::take(&mut self.equation);
        let mut standing = std::mem::take(&mut self.unknown);
        standing.clear();
        standing.extend(self.own.standing.iter().map(|p| *p as f64));
        standing.resize(equation.columns(), 0.0);
        let mut product = std::mem::take(&mut self.transposed.flux);
        product.resize(equation.len(), 0.0);
        Product(self).multiply(&equation, [-beta, beta], &standing, &mut product);
        each_mut(&mut equation.right[..n], |i, right| *right += product[i]);
        (self.equation, self.unknown, self.transposed.flux) = (equation, standing, product);
    }
}
