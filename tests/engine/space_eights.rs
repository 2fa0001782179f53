//! Packed indices, of neighbours near and far apart in memory.

use super::cloud::{Cloud, PERIODIC, length};
use coronet::scene::Dimension;
use coronet::space::eights::{Eights, Group};
use coronet::space::lane::Real;
use coronet::space::sparse::{Couple, Sparse};
use coronet::space::sweep::{self, Pair, Pass};

#[test]
fn groups_keep_their_indices() {
    let (last, far) = (u32::from(u16::MAX), 1 << 31);
    let near = [7 + last, 9, 8, 7, 7, 4000, 12, 7];
    let wide = [8 + last, 9, 8, 7, 7, 4000, 12, 7];
    let mut eights = Eights::default();
    eights.extend(&near);
    eights.extend(&[wide, near.map(|index| index + far)].concat());
    // More wide ones than 16 bits can number.
    let many: Vec<u32> = (0..70_000)
        .flat_map(|k| wide.map(|index| index + k))
        .collect();
    eights.extend(&many);
    assert_eq!(eights.len(), 3 + 70_000);
    let groups = eights.groups(0..3);
    let is_near = |k: usize| matches!(groups.open(&groups.packed[k]), Group::Near(..));
    assert!(is_near(0) && !is_near(1) && is_near(2));
    let all = [near, wide, near.map(|index| index + far)].concat();
    let all: Vec<usize> = all.iter().chain(&many).map(|&j| j as usize).collect();
    let found: Vec<usize> = eights.groups(0..eights.len()).indices().collect();
    assert!(found == all);
    let parts = eights.groups(1..eights.len()).chunks(32);
    assert!(
        parts
            .flat_map(|part| part.indices())
            .eq(all[8..].iter().copied())
    );
    eights.clear();
    assert!(eights.is_empty() && eights.groups(0..0).indices().next().is_none());
}

/// The sum of the squared distances.
struct Distance;

impl Pass<1> for Distance {
    type Payload = ();
    type Out = f32;
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) {
        sum[0] += pair.q2;
    }
    fn finish(&self, _: usize, [sum]: [f32; 1], out: &mut f32) {
        *out = sum;
    }
}

impl Couple<1> for Distance {
    type Payload = ();
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) -> F {
        sum[0] += pair.q2;
        pair.q2
    }
}

/// A periodic box of more than 65536 particles: neighbours of the first are the last.
#[test]
fn neighbours_may_be_far_apart_in_memory() {
    let cells = [42.0, 41.0, 40.0];
    let mut cloud = Cloud::new(Dimension::Three, cells, PERIODIC, [1.3, 0.0], |_| true);
    cloud.flow.pack(|_, _| (), |_, _| ());
    let (flow, n) = (&cloud.flow, cloud.flow.liquid());
    let scale = flow.grid.scale(cloud.h);
    let mut sums = vec![0.0; n];
    sweep::rows(&flow.records, &flow.rows, scale, &Distance, &mut sums);
    let mut sparse = Sparse::default();
    let (mut degree, mut same) = (Vec::new(), Vec::new());
    sparse.build(&cloud.layout(), &Distance, &mut degree, &mut same);
    let values: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let mut far = 0;
    for i in 0..n {
        let row = cloud.row(i);
        let first = cloud.row(0).len();
        assert_eq!(row.len(), first, "{i}");
        assert!(
            (sums[i] - sums[0]).abs() < 1e-4 * sums[0],
            "{i}: {}",
            sums[i]
        );
        assert_eq!(same[i][0].to_bits(), sums[i].to_bits(), "{i}");
        if row[first - 1] - row[0] <= u16::MAX as usize {
            continue;
        }
        far += 1;
        let mut dot = 0.0;
        for (j, weight) in sparse.row(i) {
            let q = length(cloud.separation(i, j)) / cloud.h;
            assert!((weight as f64 - q * q).abs() < 1e-4, "{i} {j}: {weight}");
            dot += weight as f64 * values[j];
        }
        assert!((sparse.dot(i, &values) - dot).abs() < 1e-9, "{i}");
        let coupled = sparse.row(i).map(|(j, _)| j).collect::<Vec<_>>();
        assert_eq!(coupled.len(), first, "{i}");
    }
    assert!(far > 3000, "{far} rows");
}
