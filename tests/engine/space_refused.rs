//! Safe code that asks for data which are not there is refused.

use super::cloud::{Cloud, PERIODIC};
use coronet::kernel::WendlandC2;
use coronet::method::flow::Flow;
use coronet::method::isph::pass::Weights;
use coronet::method::pass::{Compressed, Extrapolation, Moving, WallSums};
use coronet::scene::Dimension;
use coronet::space::lane::Real;
use coronet::space::sparse::{Couple, Sparse};
use coronet::space::sweep::{self, Field, Fields, Pair, Pass, Payload};
use std::marker::PhantomData;
use std::panic::AssertUnwindSafe;

/// How many neighbours there are.
struct Count;

impl Pass<1> for Count {
    type Payload = ();
    type Out = f32;
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) {
        sum[0] += pair.q2.splat(1.0);
    }
    fn finish(&self, _: usize, [sum]: [f32; 1], out: &mut f32) {
        *out = sum;
    }
}

impl Couple<1> for Count {
    type Payload = ();
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, _: &mut [F; 1]) -> F {
        pair.q2
    }
}

fn plane() -> Cloud {
    let cells = [8.0, 0.0, 8.0];
    let mut cloud = Cloud::new(Dimension::Two, cells, PERIODIC, [1.3, 0.2], |_| true);
    cloud.flow.pack(|_, _| (), |_, _| ());
    cloud
}

/// The least of the sums over runs with so many coordinates and words less than there are.
fn least_without(coordinates: usize, words: usize) -> f32 {
    let cloud = plane();
    let flow = &cloud.flow;
    let count = flow.at[0].len();
    let at = flow.at.clone().map(|at| at[coordinates..].to_vec());
    let field = Field {
        grid: &flow.grid,
        at: &at,
        payload: &[vec![1.0f32; count - words]],
        sources: &flow.sources(),
        position: &flow.particles.position,
        own: &[],
        cutoff: 2.0 * cloud.h,
        scale: flow.grid.scale(cloud.h),
        first: 0,
    };
    let targets: Vec<u32> = (0..flow.liquid() as u32).collect();
    let mut sums = vec![0.0; targets.len()];
    sweep::runs(field, &targets, &Count, &mut sums);
    sums.into_iter().fold(f32::INFINITY, f32::min)
}

/// The message of the panic of `call`; it must panic.
fn refusal(call: impl FnOnce()) -> String {
    let panic = std::panic::catch_unwind(AssertUnwindSafe(call)).expect_err("nothing is refused");
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .expect("a text")
}

#[test]
fn rows_of_too_few_records_are_refused() {
    let mut flow = plane().flow;
    flow.records
        .carry::<()>()
        .truncate(flow.particles.len() - 1);
    let (scale, mut sums) = (flow.grid.scale(1.0), vec![0.0; flow.liquid()]);
    let text = refusal(|| sweep::rows(&flow.records, &flow.rows, scale, &Count, &mut sums));
    assert!(
        text.contains("rows of more points than there are records"),
        "{text}"
    );
}

#[test]
fn runs_of_too_few_points_or_words_are_refused() {
    assert!(least_without(0, 0) > 8.0);
    let text = refusal(|| {
        least_without(1, 1);
    });
    assert!(text.contains("cells of other points"), "{text}");
    let text = refusal(|| {
        least_without(0, 1);
    });
    assert!(text.contains("points without a payload"), "{text}");
}

#[test]
fn products_with_too_few_values_are_refused() {
    let (cloud, mut matrix) = (plane(), Sparse::default());
    matrix.build(&cloud.layout(), &Count, &mut Vec::new(), &mut Vec::new());
    let text = refusal(|| {
        matrix.dot(0, &vec![1.0; matrix.len() - 1]);
    });
    assert!(text.contains("fewer values than unknowns"), "{text}");
}

/// Records say what they carry: a pass that reads something else would take one number for another.
#[test]
fn passes_over_records_of_another_payload_are_refused() {
    let mut cloud = plane();
    let kernel = PhantomData::<WendlandC2>;
    let pass = Extrapolation { kernel };
    let sum = |flow: &Flow| {
        let mut sums = vec![WallSums::default(); flow.liquid()];
        sweep::rows(
            &flow.records,
            &flow.rows,
            flow.grid.scale(1.0),
            &pass,
            &mut sums,
        );
    };
    let still = Moving::default();
    cloud.flow.pack(|_, _| still, |_, _| still);
    sum(&cloud.flow);
    let dense = Compressed::default();
    cloud.flow.repack(|_, _| dense, |_, _| dense);
    let text = refusal(|| sum(&cloud.flow));
    let [carried, read] =
        ["Compressed", "Moving"].map(|name| format!("coronet::method::pass::{name}"));
    assert!(text.contains(&carried) && text.contains(&read), "{text}");
    let text = refusal(|| cloud.flow.pack_wall(|_| still));
    assert!(text.contains(&format!("not {read}")), "{text}");
    let weights = Weights::<WendlandC2, false>(PhantomData);
    let text = refusal(|| {
        let mut matrix = Sparse::default();
        matrix.build(&cloud.layout(), &weights, &mut Vec::new(), &mut Vec::new());
    });
    assert!(text.contains("isph::pass::Coupled"), "{text}");
    // What a pass that reads nothing does not read may be anything.
    let mut sums = vec![0.0; cloud.flow.liquid()];
    let scale = cloud.flow.grid.scale(1.0);
    sweep::rows(
        &cloud.flow.records,
        &cloud.flow.rows,
        scale,
        &Count,
        &mut sums,
    );
}

#[test]
fn payloads_are_their_numbers_one_after_the_other() {
    let words = [1.0, 2.0, 3.0, 4.0, 5.0, 0.0];
    let moving = Moving::from_words(words);
    assert_eq!(moving.velocity, [1.0, 2.0, 3.0]);
    assert_eq!([moving.pressure, moving.weight], [4.0, 5.0]);
    assert_eq!(moving.to_words(), words);
    assert_eq!(
        Compressed::from_words(words).to_words(),
        [1.0, 2.0, 3.0, 4.0, 0.0, 0.0]
    );
}
