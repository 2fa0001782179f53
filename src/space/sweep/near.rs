//! Sums of few targets or over long supports: no list is kept. Targets that lie together look at
//! the same candidates, which are found and copied together once.

use super::block::{Block, MARGIN, MEMBERS};
use super::candidates::{EVERY, Left, Near};
use super::payload::count;
use super::stage::{STAGED, Stage};
use super::{FAR, Fields, Pass, Payload, WORDS, splat, total};
use crate::space::column::Columns;
use crate::space::grid::{Grid, Scale, WIDE};
use crate::space::lane::{self, Job, Lanes, Real, WIDTH, dot};
use crate::space::parallel::{Parts, chunk_after, each_part};
use crate::space::row::{CHUNK, Source, count_points, separation};

/// Where the pairs of [`runs`] are.
#[derive(Clone, Copy)]
pub struct Field<'a, const W: usize = 3, const O: usize = 3> {
    /// The cells.
    pub grid: &'a Grid,
    /// Fixed-point coordinates of all points, with at least eight spare at the end.
    pub at: &'a [Vec<i32>; 3],
    /// Payloads of all points, word by word, as many as coordinates.
    pub payload: &'a [Vec<f32>; W],
    /// Which of the points are looked at.
    pub sources: &'a [Source<'a>],
    /// Positions of the targets, m, indexed by target.
    pub position: &'a [Vec<f64>; 3],
    /// The same of the targets, indexed by target; none if a pass does not ask for it.
    pub own: &'a [Vec<f32>; O],
    /// Search radius: support + what particles have moved since the sort, m.
    pub cutoff: f64,
    /// Fixed-point units to multiples of the smoothing length.
    pub scale: Scale,
    /// Place of the first target in the order of all ranks' targets.
    pub first: usize,
}

impl<'a, const W: usize, const O: usize> Field<'a, W, O> {
    /// The same targets among other points.
    pub fn among<const V: usize>(
        self,
        at: &'a [Vec<i32>; 3],
        payload: &'a [Vec<f32>; V],
        sources: &'a [Source<'a>],
    ) -> Field<'a, V, O> {
        Field {
            grid: self.grid,
            at,
            payload,
            sources,
            position: self.position,
            own: self.own,
            cutoff: self.cutoff,
            scale: self.scale,
            first: self.first,
        }
    }

    /// What target `i` carries.
    #[inline(always)]
    pub(super) fn own_of<const N: usize, P: Pass<N>>(&self, pass: &P, i: usize) -> P::Payload {
        let mut words = [0.0; WORDS];
        for (word, own) in words.iter_mut().zip(self.own) {
            *word = own[i];
        }
        pass.own(i, P::Payload::from_words(words))
    }

    /// Whether there are the words that a pass reads, which are the first; as the code is built.
    pub(super) const fn check<P: Payload>() {
        const {
            assert!(W >= count::<P>(), "points without a payload");
            assert!(O == 0 || O >= count::<P>(), "targets without a payload");
        }
    }

    /// The same with other payloads of the targets.
    pub fn owning<const P: usize>(self, own: &'a [Vec<f32>; P]) -> Field<'a, W, P> {
        Field {
            grid: self.grid,
            at: self.at,
            payload: self.payload,
            sources: self.sources,
            position: self.position,
            own,
            cutoff: self.cutoff,
            scale: self.scale,
            first: self.first,
        }
    }
}

/// Sums over whole cell columns. `out[k]` belongs to `targets[k]`, which are best in the order of
/// cells. Lanes beyond the support must add nothing.
///
/// # Panics
/// If the sources are not all among the points of `field`, or a payload is not of all points.
pub fn runs<const N: usize, const W: usize, const O: usize, P: Pass<N>>(
    field: Field<W, O>,
    targets: &[u32],
    pass: &P,
    out: &mut [P::Out],
) {
    Field::<W, O>::check::<P::Payload>();
    assert_eq!(out.len(), targets.len());
    if targets.is_empty() {
        return;
    }
    count_points(field.at, field.sources);
    let all = field.at[0].len();
    let carried = field.payload.iter().all(|words| words.len() >= all);
    assert!(carried, "points without a payload");
    // Chunks begin where those of all targets do: targets of a chunk look together.
    let before = field.first % CHUNK;
    each_part(Parts::after(before, out, CHUNK), |c, out| {
        let job = InRuns {
            field,
            targets: &targets[chunk_after(before, c, CHUNK, targets.len())],
            pass,
            out,
        };
        lane::run(field.scale.precision, job);
    });
}

/// Some targets of [`runs`].
struct InRuns<'a, const N: usize, const W: usize, const O: usize, P: Pass<N>> {
    field: Field<'a, W, O>,
    targets: &'a [u32],
    pass: &'a P,
    out: &'a mut [P::Out],
}

impl<const N: usize, const W: usize, const O: usize, P: Pass<N>> Job for InRuns<'_, N, W, O, P> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (field, pass, targets) = (self.field, self.pass, self.targets);
        let mut columns = Columns::new(field.grid, field.cutoff, WIDE);
        let mut near = Near::<L, W>::new(lanes);
        let mut stage = Stage::<L::F, P::Payload>::new(lanes);
        let scale = field.scale.lanes(lanes);
        let reach = field.scale.square(field.grid, MARGIN * field.cutoff);
        let reach = lanes.splat(reach as f32);
        let mut begin = 0;
        while begin < targets.len() {
            let (block, [low, high]) = Block::of(field.position, &columns, &targets[begin..]);
            let bounds = block.bounds(lanes, field.grid, field.cutoff);
            let count = block.count;
            let block = Carrying::of(block, (&field, pass), &targets[begin..]);
            let about = (bounds.centre, scale, reach);
            let mut sums = [[lanes.splat(0.0); N]; MEMBERS];
            let mut left = Left::of(columns.about(&low, &high, field.cutoff), field.sources);
            // Mostly one turn: all candidates find room.
            loop {
                // SAFETY: `runs` has seen that all points of the sources are followed by eight.
                let full = unsafe { near.fill(&field, &mut left, &bounds) };
                block.add((&mut near, &mut stage), about, pass, &mut sums);
                if !full {
                    break;
                }
            }
            for (k, sum) in sums.iter().enumerate().take(count) {
                let target = targets[begin + k] as usize;
                pass.finish(target, total(sum), &mut self.out[begin + k]);
            }
            begin += count;
        }
    }
}

/// A block, and what its targets carry.
struct Carrying<C> {
    block: Block,
    own: [C; MEMBERS],
    extra: [[f32; 3]; MEMBERS],
}

impl<C: Payload> Carrying<C> {
    /// `targets`: from the first of the block on.
    #[inline(always)]
    fn of<const N: usize, const W: usize, const O: usize, P: Pass<N, Payload = C>>(
        block: Block,
        (field, pass): (&Field<W, O>, &P),
        targets: &[u32],
    ) -> Self {
        let (mut own, mut extra) = ([C::default(); MEMBERS], [[0.0; 3]; MEMBERS]);
        for (k, &i) in targets[..block.count].iter().enumerate() {
            own[k] = field.own_of(pass, i as usize);
            extra[k] = pass.extra(i as usize);
        }
        Carrying { block, own, extra }
    }

    /// Adds what the candidates give each target, and forgets them.
    #[inline(always)]
    fn add<L: Lanes, const N: usize, const W: usize, P: Pass<N, Payload = C>>(
        &self,
        (near, stage): (&mut Near<L, W>, &mut Stage<L::F, C>),
        (centre, scale, reach): ([i32; 3], [L::F; 3], L::F),
        pass: &P,
        sums: &mut [[L::F; N]; MEMBERS],
    ) {
        let lanes = near.lanes;
        near.place(centre, scale);
        let (whole, left) = (near.count / WIDTH, near.count % WIDTH);
        let groups = near.count.div_ceil(WIDTH);
        if P::SKIPS_ZEROS {
            near.find_carrying();
        }
        for (k, sums) in sums.iter_mut().enumerate().take(self.block.count) {
            let [x, y, z] = self.block.at[k];
            let (x, y, z) = ([x; WIDTH], [y; WIDTH], [z; WIDTH]);
            // SAFETY: there are eight of each.
            let at = unsafe {
                [
                    lanes.load_fixed(x.as_ptr()),
                    lanes.load_fixed(y.as_ptr()),
                    lanes.load_fixed(z.as_ptr()),
                ]
            };
            let away = separation(lanes, centre, at, scale);
            let own = splat(lanes, self.own[k], self.extra[k]);
            let looked_at = match P::SKIPS_ZEROS && self.own[k].to_words() == [0.0; WORDS] {
                true => &near.carrying[..near.carriers],
                false => &EVERY[..groups],
            };
            let mut looked_at = looked_at.iter();
            loop {
                let mut filled = 0;
                while filled < STAGED {
                    let Some(&group) = looked_at.next() else {
                        break;
                    };
                    let group = group as usize;
                    let away = near.away(group, away);
                    let mut q2 = dot(away, away);
                    if group == whole {
                        q2 = lanes.first(left, q2, lanes.splat(FAR));
                    }
                    // Eight that are all out of reach add nothing: the next take their place.
                    stage.put(filled, away, q2, near.carried(group));
                    filled += usize::from(q2.less_mask(reach) != 0);
                }
                stage.add(filled, pass, own, sums);
                if filled < STAGED {
                    break;
                }
            }
        }
        near.count = 0;
    }
}
