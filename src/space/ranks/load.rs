//! Which slabs each rank gets: a step takes all of them about the same time.
//!
//! The time of a particle differs between ranks: surfaces cost more than the deep, cores are not
//! equal. Each rank measures its own, without what it waits for others. Results do not depend on
//! who has which slab, so a measured time is no harm to them.

use super::Communicator;
use crate::space::grid::WIDE;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Of so many steps the fastest counts: frames are written and other programs run now and then.
const RECENT: usize = 8;

/// Particles of no rank cost more than the mean by this factor, or less: a rank that another
/// program has stopped for a while still gets some.
const SPAN: f64 = 2.0;

/// Slabs move if the rank with most work gets less by this factor.
const WORTH: f64 = 0.95;

/// A communicator that counts the time in it.
struct Timed {
    with: Arc<dyn Communicator>,
    /// ns.
    waited: AtomicU64,
}

impl Communicator for Timed {
    fn rank(&self) -> usize {
        self.with.rank()
    }

    fn size(&self) -> usize {
        self.with.size()
    }

    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, Option<usize>)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>> {
        let (start, mut busy) = (Instant::now(), Duration::ZERO);
        let received = self.with.exchange_while(to, from, &mut || {
            let begun = Instant::now();
            meanwhile();
            busy = begun.elapsed();
        });
        let waited = start.elapsed().saturating_sub(busy).as_nanos() as u64;
        self.waited.fetch_add(waited, Ordering::Relaxed);
        received
    }
}

/// The time that a particle takes on this rank.
#[derive(Clone)]
pub struct Load {
    with: Arc<Timed>,
    /// When the last step began, and what was waited for until then.
    begun: Option<(Instant, Duration)>,
    /// s a particle and step; infinite where nothing was measured.
    recent: [f64; RECENT],
    steps: usize,
}

impl Load {
    /// Nothing measured yet.
    pub fn new(with: Arc<dyn Communicator>) -> Self {
        let waited = AtomicU64::new(0);
        Load {
            with: Arc::new(Timed { with, waited }),
            begun: None,
            recent: [f64::INFINITY; RECENT],
            steps: 0,
        }
    }

    /// The communicator whose time is known.
    pub fn with(&self) -> Arc<dyn Communicator> {
        self.with.clone()
    }

    /// Begins a step, after one of `count` particles; what a particle took in the steps before, s,
    /// infinite if that is not known.
    pub fn lap(&mut self, count: usize) -> f64 {
        let now = Instant::now();
        let waited = Duration::from_nanos(self.with.waited.load(Ordering::Relaxed));
        if let (Some((since, before)), 1..) = (self.begun, count) {
            let busy = (now - since).saturating_sub(waited - before);
            self.recent[self.steps % RECENT] = busy.as_secs_f64() / count as f64;
            self.steps += 1;
        }
        self.begun = Some((now, waited));
        self.recent.iter().fold(f64::INFINITY, |a, b| a.min(*b))
    }
}

/// What each slab costs; `all`: of each rank its particles in the slabs, and what one of them
/// costs.
pub fn costs(all: &[(Vec<u32>, f64)]) -> Vec<f64> {
    let known = all.iter().map(|(_, cost)| *cost).filter(|c| c.is_finite());
    let (sum, number) = known.fold((0.0, 0), |(sum, n), cost| (sum + cost, n + 1));
    let mean = if number > 0 { sum / number as f64 } else { 1.0 };
    let mut costs = vec![0.0; all.first().map_or(0, |(counts, _)| counts.len())];
    for (counts, cost) in all {
        let cost = match cost.is_finite() {
            true => cost.clamp(mean / SPAN, mean * SPAN),
            false => mean,
        };
        let each = costs.iter_mut().zip(counts);
        each.for_each(|(sum, count)| *sum += cost * *count as f64);
    }
    costs
}

/// First slab of each of `size` ranks that get about the same of `costs`, and the number of slabs.
/// Slabs that sums look at together stay together, and no rank begins outside of those `within`.
pub fn cuts(costs: &[f64], size: usize, within: &RangeInclusive<usize>) -> Vec<usize> {
    let total: f64 = costs.iter().sum();
    let (mut slab, mut before) = (0, 0.0);
    let mut cuts = vec![0];
    for rank in 1..size {
        let wanted = total * rank as f64 / size as f64;
        while slab < costs.len() {
            let end = (slab + WIDE).min(costs.len());
            let here: f64 = costs[slab..end].iter().sum();
            // The nearer of the two sides of a block.
            if before + 0.5 * here >= wanted && within.contains(&slab) {
                break;
            }
            (slab, before) = (end, before + here);
        }
        cuts.push(slab);
    }
    cuts.push(costs.len());
    cuts
}

/// Whether ranks with the slabs of `new` cuts have less to do than with the `old` ones, enough to
/// move them.
pub fn is_worth(costs: &[f64], old: &[usize], new: &[usize]) -> bool {
    let most = |cuts: &[usize]| {
        let ranks = cuts
            .windows(2)
            .map(|cut| costs[cut[0]..cut[1]].iter().sum());
        ranks.fold(0.0, f64::max)
    };
    most(new) < WORTH * most(old)
}
