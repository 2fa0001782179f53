//! Slabs of ranks by what they cost.

use coronet::space::ranks::load::{costs, cuts, is_worth};

#[test]
fn a_rank_whose_particles_cost_more_gets_fewer_of_them() {
    // Two ranks with eight slabs of ten particles; those of the first take three times as long.
    let [first, second] = [0, 8].map(|from| {
        let is_own = |slab: usize| (from..from + 8).contains(&slab);
        (0..16).map(|s| if is_own(s) { 10 } else { 0 }).collect()
    });
    let costs = costs(&[(first, 3e-6), (second, 1e-6)]);
    assert!((costs.iter().sum::<f64>() - 320e-6).abs() < 1e-12);
    let new = cuts(&costs, 2, &(0..=16));
    // Half of 320 us are 5.3 slabs of 30 us; slabs go in pairs.
    assert_eq!(new, [0, 6, 16]);
    assert!(is_worth(&costs, &[0, 8, 16], &new));
    assert!(!is_worth(&costs, &new, &new));
}

#[test]
fn what_nobody_has_measured_costs_the_mean() {
    let unknown = f64::INFINITY;
    let all = |a: f64, b: f64| costs(&[(vec![4, 0], a), (vec![0, 4], b)]);
    assert_eq!(all(unknown, unknown), [4.0, 4.0]);
    assert_eq!(all(2.0, unknown), [8.0, 8.0]);
}

#[test]
fn no_rank_begins_outside_of_the_walls() {
    let costs = [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 9.0, 9.0, 0.0, 0.0];
    let found = cuts(&costs, 5, &(2..=8));
    assert_eq!((found[0], found[5]), (0, 10));
    let inner = found[1..5].iter();
    assert!(inner.clone().all(|cut| (2..=10).contains(cut)), "{found:?}");
    assert!(found.is_sorted());
}
