//! Connected components of cells against all pairs.

use super::cloud::{CHANNEL, Cloud, OPEN, PERIODIC, Random, length};
use super::pack_scene::S0;
use coronet::scene::{Dimension, Side};
use coronet::space::component::Components;
use std::collections::HashSet;

/// The component of each particle.
fn found(cloud: &Cloud, reach: f64) -> Vec<usize> {
    let start = &cloud.flow.liquid_cells.start;
    let mut components = Components::default();
    // Twice: nothing of the first is left.
    for reach in [3.0 * reach, reach] {
        components.find(&cloud.flow.grid, reach, |cell| {
            start[cell] < start[cell + 1]
        });
    }
    let mut of = vec![usize::MAX; cloud.flow.liquid()];
    for (body, cells) in components.runs() {
        assert!(body < components.len());
        for i in start[cells.start] as usize..start[cells.end] as usize {
            assert_eq!(of[i], usize::MAX, "{i} is in two runs");
            of[i] = body;
        }
    }
    assert!(of.iter().all(|&body| body != usize::MAX));
    of
}

/// The same by pairs for which `near` holds.
fn by_pairs(n: usize, near: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut of: Vec<usize> = (0..n).collect();
    for i in 0..n {
        for j in 0..i {
            if near(i, j) && of[i] != of[j] {
                let (from, to) = (of[i], of[j]);
                of.iter_mut()
                    .filter(|body| **body == from)
                    .for_each(|body| *body = to);
            }
        }
    }
    of
}

fn count(of: &[usize]) -> usize {
    of.iter().collect::<HashSet<_>>().len()
}

#[test]
fn components_hold_all_pairs_and_no_more_than_cells_need() {
    let lid: [[Side; 2]; 3] = [[Side::Periodic; 2], [Side::Open; 2], [Side::Periodic; 2]];
    let cases = [
        ("open", Dimension::Three, [30.0; 3], OPEN, 150),
        (
            "periodic",
            Dimension::Three,
            [24.0, 30.0, 28.0],
            PERIODIC,
            120,
        ),
        (
            "channel",
            Dimension::Three,
            [24.0, 30.0, 28.0],
            CHANNEL,
            120,
        ),
        ("mixed", Dimension::Three, [24.0, 30.0, 28.0], lid, 120),
        ("plane", Dimension::Two, [60.0, 1.0, 50.0], PERIODIC, 60),
        ("open plane", Dimension::Two, [60.0, 1.0, 50.0], OPEN, 60),
    ];
    for (name, dimension, cells, sides, particles) in cases {
        let mut random = Random(11);
        let (mut most, mut least) = (0, usize::MAX);
        for _ in 0..4 {
            let place = |a: usize, u: f64| (0.5 + 0.49 * u) * cells[a];
            let points: Vec<_> = (0..particles)
                .map(|_| {
                    let mut at = [0, 1, 2].map(|a| place(a, random.signed()));
                    if dimension == Dimension::Two {
                        at[1] = 0.0;
                    }
                    (at, [0.0; 4])
                })
                .collect();
            let cloud = Cloud::of(dimension, cells, sides, 1.3, &points);
            let reach = cloud.flow.lengths.support;
            let edge = cloud.flow.grid.edge;
            let found = found(&cloud, reach);
            let n = cloud.flow.liquid();
            let near = by_pairs(n, |i, j| length(cloud.separation(i, j)) <= reach);
            // Cells that are joined hold nobody farther apart than this.
            let far = by_pairs(n, |i, j| {
                let d = cloud.separation(i, j);
                (0..3).all(|a| d[a].abs() <= reach + 2.0 * edge[a])
            });
            for i in 0..n {
                for j in 0..i {
                    assert!(
                        near[i] != near[j] || found[i] == found[j],
                        "{name}: {i}, {j} apart"
                    );
                    assert!(
                        far[i] == far[j] || found[i] != found[j],
                        "{name}: {i}, {j} joined"
                    );
                }
            }
            (most, least) = (most.max(count(&found)), least.min(count(&far)));
            assert!(reach > 2.0 * S0);
        }
        // Several bodies, some of them larger than a cell and its neighbours.
        assert!(most > least.max(2), "{name}: {least} to {most}");
    }
}
