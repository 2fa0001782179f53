//! The conditions that end a run, in tables of measures.

use coronet::measure::ending::{Ending, Memory, Met};
use coronet::measure::series::Row;
use coronet::scene::StopWhen::{self, CraterDeepest, LevelCrossed, Rebound, Rest};

/// Particle spacing of all, m.
const SPACING: f64 = 1e-3;

fn row(time: usize, name: &str, value: f64) -> Row {
    vec![("time_s".into(), time as f64), (name.into(), value)]
}

/// When a column with these values, one a second, ends a run.
fn met(condition: StopWhen, name: &str, values: &[f64]) -> Option<f64> {
    let mut ending = Ending::new(&[condition], SPACING, Memory::default());
    let mut found = None;
    for (time, value) in values.iter().enumerate() {
        ending.look(&row(time, name, *value));
        let now = ending.met();
        assert!(now.is_none_or(|(by, _)| by == condition));
        assert!(found.is_none() || now == found, "nothing changes any more");
        found = now;
    }
    found.map(|(_, time)| time)
}

fn level(condition: StopWhen, millimetres: &[f64]) -> Option<f64> {
    let values: Vec<f64> = millimetres.iter().map(|z| 1e-3 * z).collect();
    met(condition, "axis_level_m", &values)
}

#[test]
fn a_crater_is_deepest_when_it_has_risen_clearly() {
    let deepest = |values: &[f64]| level(CraterDeepest, values);
    // A tenth of 20 mm.
    let slow = [0.0, -20.0, -18.9, -18.1, -17.9, -17.5, -17.0, -16.0];
    assert_eq!(deepest(&slow), Some(6.0));
    // A spacing.
    assert_eq!(deepest(&[0.0, -4.0, -3.5, -2.9, -2.5, -2.0]), Some(5.0));
    // Spray on the axis, a drop that comes later, noise in front of the drop.
    assert_eq!(deepest(&[0.0, -4.0, 3.0, 3.0, -4.1, -4.2, -4.3]), None);
    assert_eq!(deepest(&[-0.9, -1.9, 2.0, 2.0, 2.0, 2.0]), None);
    // A blank is no rise.
    let blank = [0.0, -4.0, -2.0, -2.0, f64::NAN, -2.0, -2.0, -2.0];
    assert_eq!(deepest(&blank), Some(7.0));
    // It deepens again before it has counted.
    assert_eq!(
        deepest(&[-4.0, -2.0, -2.0, -6.0, -4.0, -4.0, -4.0]),
        Some(6.0)
    );
}

#[test]
fn the_level_is_crossed_after_the_crater_only() {
    let crossed = |values: &[f64]| level(LevelCrossed, values);
    assert_eq!(crossed(&[0.0, 2.0, 1.0, 0.5, -1.0, -3.0, -1.0, -0.1]), None);
    let jet = [0.0, 2.0, 1.0, 1.0, -3.0, -0.1, 0.0, 1.0, 2.0];
    assert_eq!(crossed(&jet), Some(8.0));
}

#[test]
fn a_drop_rebounds_when_it_wets_nothing_any_more() {
    let off = |values: &[f64]| met(Rebound, "spread_factor", values);
    assert_eq!(off(&[0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.5]), None);
    assert_eq!(
        off(&[0.0, 1.0, 2.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]),
        Some(8.0)
    );
}

#[test]
fn liquid_is_at_rest_when_it_stays_slow() {
    let rest = |values: &[f64]| met(Rest, "kinetic_energy_J", values);
    let slow = [vec![1.0, 2.0, 0.021], vec![0.019; 10]].concat();
    assert_eq!(rest(&slow), Some(12.0));
    let swing = [vec![1.0], vec![0.0; 9], vec![0.5], vec![0.0; 9]].concat();
    assert_eq!(rest(&swing), None);
    assert_eq!(rest(&[0.0; 30]), None, "it has not begun to move");
}

#[test]
fn the_first_condition_ends_a_run_and_others_do_not_count() {
    let both = |conditions: &[StopWhen]| -> Option<Met> {
        let mut ending = Ending::new(conditions, SPACING, Memory::default());
        for (time, z) in [0.0, -20.0, -17.0, -16.0, 0.0, 1.0, 2.0].iter().enumerate() {
            ending.look(&row(time, "axis_level_m", 1e-3 * z));
        }
        ending.met()
    };
    assert_eq!(
        both(&[LevelCrossed, CraterDeepest]),
        Some((CraterDeepest, 4.0))
    );
    assert_eq!(both(&[LevelCrossed]), Some((LevelCrossed, 6.0)));
    assert_eq!(both(&[Rest]), None);
    assert_eq!(both(&[]), None);
}

#[test]
fn what_is_remembered_goes_on_as_if_nothing_had_been() {
    let values = [0.0, -20.0, -18.1, -17.9, -17.5, -17.0, -16.0];
    let all = StopWhen::ALL;
    let mut whole = Ending::new(&all, SPACING, Memory::default());
    for (time, z) in values.iter().enumerate() {
        let kept = whole.memory().numbers();
        let find = |name: &str| kept.iter().find(|(known, _)| *known == name).map(|n| n.1);
        let memory = Memory::of(find).unwrap();
        let mut other = Ending::new(&all, SPACING, memory);
        let next = row(time, "axis_level_m", 1e-3 * z);
        whole.look(&next);
        other.look(&next);
        let bits = |ending: &Ending| ending.memory().numbers().map(|(_, x)| x.to_bits());
        assert_eq!(bits(&whole), bits(&other));
        assert_eq!(whole.met(), other.met());
    }
    assert_eq!(whole.met(), Some((CraterDeepest, 5.0)));
    assert_eq!(Memory::of(|_| None), None);
}
