//! Neighbour rows against all pairs.

use super::cloud::{CHANNEL, Cloud, OPEN, PERIODIC, length};
use super::pack_scene::S0;
use coronet::scene::{Dimension, Side};

/// A periodic box as small as the grid accepts, one that is not cubic, walls, and open sides.
fn clouds() -> Vec<(&'static str, Cloud)> {
    let (two, three) = (Dimension::Two, Dimension::Three);
    let all = |_: [f64; 3]| true;
    // Liquid beyond the open sides, as a splash leaves it before the next rebuild.
    let walled = [[Side::Open; 2], [Side::Wall; 2], [Side::Wall, Side::Open]];
    let heap = |x: [f64; 3]| x[2] < 5.0 || x[0] < 4.0;
    vec![
        (
            "tight",
            Cloud::new(three, [6.0; 3], PERIODIC, [1.3, 0.4], all),
        ),
        (
            "long",
            Cloud::new(three, [7.5, 9.0, 13.0], PERIODIC, [1.3, 0.4], all),
        ),
        (
            "plane",
            Cloud::new(two, [17.0, 0.0, 9.0], PERIODIC, [2.0, 0.4], all),
        ),
        (
            "channel",
            Cloud::new(three, [7.0, 6.0, 8.0], CHANNEL, [1.3, 0.4], all),
        ),
        (
            "plane channel",
            Cloud::new(two, [12.0, 0.0, 9.0], CHANNEL, [1.3, 0.4], all),
        ),
        (
            "heap",
            Cloud::new(three, [8.0, 6.0, 9.0], walled, [1.3, 0.4], heap),
        ),
        ("open", Cloud::new(three, [7.0; 3], OPEN, [1.3, 0.9], all)),
    ]
}

/// Pairs within `inner` are listed, none beyond `outer`, none twice.
fn complete(name: &str, cloud: &Cloud, inner: f64, outer: f64) -> usize {
    let mut pairs = 0;
    for i in 0..cloud.records() {
        let row = cloud.row(i);
        assert!(
            row.windows(2).all(|w| w[0] < w[1]),
            "{name}: {i} has a neighbour twice"
        );
        pairs += row.len();
        let mut listed = row.iter().peekable();
        for j in 0..cloud.records() {
            let is = listed.next_if(|&&k| k == j).is_some();
            let r = length(cloud.separation(i, j));
            assert!(
                is || i == j || r > inner,
                "{name}: {i} misses {j} at {r:.4e} m"
            );
            assert!(!is || r < outer, "{name}: {i} lists {j} at {r:.4e} m");
        }
    }
    pairs
}

#[test]
fn rows_hold_exactly_the_pairs_within_reach() {
    for (name, cloud) in clouds() {
        let reach = 1.1 * cloud.flow.lengths.support;
        let pairs = complete(name, &cloud, reach * (1.0 - 1e-6), reach * (1.0 + 1e-6));
        let least = if cloud.flow.dimension == Dimension::Two {
            14
        } else {
            30
        };
        assert!(pairs > least * cloud.flow.liquid(), "{name}: {pairs} pairs");
    }
}

#[test]
fn a_row_is_padded_with_its_own_particle() {
    for (name, cloud) in clouds() {
        let mut padding = 0;
        for i in 0..cloud.flow.liquid() {
            let own = cloud.flow.rows.row(i).indices();
            let own = own.filter(|&j| j == i).count();
            assert!(own <= 8, "{name}: {own} times itself");
            padding += own;
        }
        assert!(padding > 0, "{name}");
    }
}

#[test]
fn no_pair_is_missed_while_rows_are_not_stale() {
    for (name, mut cloud) in clouds() {
        let support = cloud.flow.lengths.support;
        // Two just out of reach of the rows run at each other, the rest anywhere.
        let apart = |cloud: &Cloud, i: usize, j: usize| length(cloud.separation(i, j));
        let next = |cloud: &Cloud, i: usize| {
            let others = (0..cloud.flow.liquid()).filter(|&j| apart(cloud, i, j) > 1.1 * support);
            others.min_by(|&j, &k| apart(cloud, i, j).total_cmp(&apart(cloud, i, k)))
        };
        let (a, b) = (0..cloud.flow.liquid())
            .filter_map(|i| next(&cloud, i).map(|j| (i, j)))
            .min_by(|&(i, j), &(k, l)| apart(&cloud, i, j).total_cmp(&apart(&cloud, k, l)))
            .unwrap();
        let mut step = 0.25 * S0;
        while cloud.flow.stale(|_| step) {
            step *= 0.99;
        }
        assert!(step > 0.03 * support, "{name}: rows last no time");
        let line = cloud.separation(a, b).map(|d| d / apart(&cloud, a, b));
        for i in 0..cloud.flow.liquid() {
            let direction = match i {
                i if i == a => line.map(|d| -d),
                i if i == b => line,
                _ => cloud.random.direction(cloud.flow.dimension),
            };
            for (x, d) in cloud.flow.particles.position.iter_mut().zip(direction) {
                x[i] += step * d;
            }
        }
        complete(name, &cloud, support, f64::INFINITY);
        let cutoff = cloud.flow.cutoff(support);
        assert!(
            cutoff >= support + 2.0 * step,
            "{name}: columns would be too short"
        );
        assert!(
            cloud.flow.stale(|_| 0.02 * support),
            "{name}: stale far too late"
        );
    }
}

/// Rows that were made for a time reach farther where something is fast, and hold until then.
#[test]
fn rows_last_as_long_as_asked() {
    for (name, mut cloud) in clouds() {
        let support = cloud.flow.lengths.support;
        // Speeds are up to sqrt(3) m/s.
        let time = 0.02 * support;
        cloud.flow.lasting = time;
        cloud.flow.find();
        for a in 0..3 {
            let (x, v) = (
                &mut cloud.flow.particles.position[a],
                &cloud.flow.particles.velocity[a],
            );
            x.iter_mut().zip(v).for_each(|(x, v)| *x += time * v);
        }
        assert!(!cloud.flow.stale(|_| 0.0), "{name}");
        complete(name, &cloud, support, f64::INFINITY);
        assert!(cloud.flow.moved() > 0.02 * support, "{name}");
        for x in &mut cloud.flow.particles.position[2] {
            *x += 0.2 * support;
        }
        assert!(cloud.flow.stale(|_| 0.0), "{name}");
    }
}

#[test]
fn rows_of_walls_without_wall_neighbours_hold_all_liquid() {
    for (name, mut cloud) in clouds() {
        if cloud.flow.walls() == 0 {
            continue;
        }
        cloud.flow.wall_sees_wall = false;
        cloud.flow.find();
        let (n, reach) = (cloud.flow.liquid(), 1.1 * cloud.flow.lengths.support);
        let mut found = 0;
        for i in n..cloud.records() {
            let near = (0..n).filter(|&j| length(cloud.separation(i, j)) < reach);
            let near: Vec<usize> = near.collect();
            assert_eq!(cloud.row(i), near, "{name}");
            found += near.len();
        }
        assert!(found > 100, "{name}: {found}");
    }
}

#[test]
fn a_box_smaller_than_two_reaches_is_refused() {
    let lengths = coronet::method::flow::Lengths {
        spacing: S0,
        support: 3.0 * S0,
        longest: 3.0 * S0,
        late: 0.0,
        farthest: 0.0,
        deepest: 0.5 * S0,
    };
    let build = |size: f64| {
        let cloud = Cloud::new(Dimension::Three, [8.0; 3], PERIODIC, [1.3, 0.1], |_| true);
        let mut domain = cloud.flow.domain.clone();
        domain.size[1] = size * S0;
        let (p, w) = (cloud.flow.particles.clone(), Default::default());
        coronet::method::flow::Flow::new(
            Dimension::Three,
            &domain,
            lengths,
            Default::default(),
            p,
            w,
        )
    };
    assert!(build(6.61).is_ok());
    let fault = build(6.59).err().unwrap();
    assert_eq!(fault.axis, 1);
    assert!((fault.need - 6.6 * S0).abs() < 1e-12 * S0, "{fault}");
}
