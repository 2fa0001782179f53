//! A solver on several ranks: rank 0 has the pipeline, and says what the others do.

use super::model::Case;
use super::{Diverged, MethodError, Phase, Solver, flow_of};
use crate::particle::{Frame, Particles, Shares, State, Wall};
use crate::scene::{Closure, Method, MpsClosure, MpsGradient, PoissonSource};
use crate::scene::{Preconditioner, Problem, TensionForm};
use crate::space::grid::WIDE;
use crate::space::ranks::{Communicator, broadcast, collect, decoded, encoded, gather};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// Why several ranks cannot share a problem.
pub fn alone(problem: &Problem) -> Option<&'static str> {
    let tension = problem.effects.tension.map(|tension| tension.form);
    if problem.domain.is_axial() {
        return Some("box.symmetry is axis");
    }
    if tension.is_some_and(|form| form != TensionForm::SurfaceEnergy) {
        return Some("effects.tension.form is not surface-energy");
    }
    let settings = match &problem.method {
        Method::Wcsph(_) => return None,
        Method::Isph(isph) if isph.closure != Closure::Completed => {
            return Some("method.isph.closure is not completed");
        }
        Method::Mps(mps) if mps.closure != MpsClosure::Completed => {
            return Some("method.mps.closure is not completed");
        }
        Method::Mps(mps) if mps.gradient == MpsGradient::Minimum => {
            return Some("method.mps.gradient is minimum");
        }
        Method::Isph(isph) => &isph.projection,
        Method::Mps(mps) => &mps.projection,
    };
    match (settings.source, settings.preconditioner) {
        (PoissonSource::Density, _) => Some("the source of the pressure equation is density"),
        (_, Preconditioner::Ssor) => Some("the preconditioner is ssor"),
        _ => None,
    }
}

/// How many ranks can have particles of a problem.
///
/// # Errors
/// A box that is too small for its kernels.
pub fn most(problem: &Problem) -> Result<usize, MethodError> {
    let case = Case::new(problem, Phase::Impact);
    let flow = flow_of(&case, Particles::default(), Wall::default())?;
    Ok(flow.grid.count[0].div_ceil(WIDE))
}

/// What rank 0 tells the others.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Order {
    Meet(f64),
    Advance,
    /// A step is over, and has been seen.
    GoOn,
    State,
    Share,
    Frame,
    Unrest,
    End,
}

/// The part of rank 0.
enum Own<'a> {
    Held(Box<dyn Solver>),
    /// Between two steps it is only looked at.
    Seen(&'a dyn Solver),
}

const HAS_ALL: &str = "rank 0 collects";

/// On rank 0: the solver of all.
pub struct Shared<'a> {
    own: Own<'a>,
    with: Arc<dyn Communicator>,
    count: usize,
}

impl Shared<'_> {
    /// `own`: the part of rank 0; the others [`serve`] theirs. `count`: particles of all.
    pub fn new(own: Box<dyn Solver>, with: Arc<dyn Communicator>, count: usize) -> Self {
        let own = Own::Held(own);
        Shared { own, with, count }
    }

    fn own(&self) -> &dyn Solver {
        match &self.own {
            Own::Held(own) => &**own,
            Own::Seen(own) => *own,
        }
    }

    fn held(&mut self) -> &mut dyn Solver {
        match &mut self.own {
            Own::Held(own) => &mut **own,
            Own::Seen(_) => unreachable!("only looked at"),
        }
    }

    fn tell(&self, order: Order) {
        broadcast(&*self.with, 0, Some(order));
    }
}

impl Drop for Shared<'_> {
    fn drop(&mut self) {
        if let Own::Held(_) = self.own {
            self.tell(Order::End);
        }
    }
}

impl Solver for Shared<'_> {
    fn time(&self) -> f64 {
        self.own().time()
    }

    fn step_count(&self) -> u64 {
        self.own().step_count()
    }

    fn len(&self) -> usize {
        self.count
    }

    fn meet(&mut self, interval: f64) {
        self.tell(Order::Meet(interval));
        self.held().meet(interval);
    }

    fn advance(&mut self, on_step: &mut dyn FnMut(&dyn Solver)) -> Result<(), Diverged> {
        self.tell(Order::Advance);
        let (with, count) = (self.with.clone(), self.count);
        let result = self.held().advance(&mut |own| {
            let (own, with) = (Own::Seen(own), with.clone());
            let seen = Shared { own, with, count };
            on_step(&seen);
            seen.tell(Order::GoOn);
        });
        self.count = counted(&*with, self.own().len());
        result
    }

    fn state(&self) -> State {
        self.tell(Order::State);
        let join = |whole: &mut State, part| join_states(whole, part, self.count);
        collect(&*self.with, self.own().state(), join).expect(HAS_ALL)
    }

    fn share(&self) -> (State, Option<Box<dyn Shares + '_>>) {
        self.tell(Order::Share);
        let elsewhere = Elsewhere {
            with: &*self.with,
            count: self.count,
        };
        let state = named(&*self.with, self.own().state());
        (state, Some(Box::new(elsewhere)))
    }

    fn frame(&self) -> Frame {
        self.tell(Order::Frame);
        let join = |whole: &mut Frame, part| join_frames(whole, part, self.count);
        let mut frame = collect(&*self.with, self.own().frame(), join).expect(HAS_ALL);
        frame.sort();
        frame
    }

    fn unrest(&self) -> (f64, f64) {
        self.tell(Order::Unrest);
        self.own().unrest()
    }

    fn limits(&self) -> Vec<(&'static str, f64)> {
        self.own().limits()
    }

    fn memory(&self) -> (f64, f64) {
        self.own().memory()
    }
}

/// On rank 0: the states of the others, which [`give`] theirs.
struct Elsewhere<'a> {
    with: &'a dyn Communicator,
    count: usize,
}

impl Shares for Elsewhere<'_> {
    fn count(&self) -> usize {
        self.count
    }

    fn each(&self, columns: &Range<usize>, take: &mut dyn FnMut(State)) {
        broadcast(self.with, 0, Some(Some(columns.clone())));
        for rank in 1..self.with.size() {
            take(decoded(&self.with.exchange(&[], &[rank])[0]));
        }
    }
}

impl Drop for Elsewhere<'_> {
    fn drop(&mut self) {
        broadcast::<Option<Range<usize>>>(self.with, 0, Some(None));
    }
}

/// On the other ranks: gives rank 0 what it wants of a state.
fn give(state: &State, with: &dyn Communicator) {
    while let Some(columns) = broadcast::<Option<Range<usize>>>(with, 0, None) {
        with.exchange(&[(0, encoded(&state.columns(&columns)))], &[]);
    }
}

/// Gives a state of no particles the arrays that other ranks have, without values.
fn named(with: &dyn Communicator, mut state: State) -> State {
    let own: Vec<String> = state.arrays.iter().map(|array| array.0.clone()).collect();
    let names = gather(with, &own)
        .into_iter()
        .find(|names| !names.is_empty());
    if state.arrays.is_empty() {
        let names = names.unwrap_or_default().into_iter();
        state.arrays = names.map(|name| (name, Vec::new())).collect();
    }
    state
}

/// On the other ranks: does what rank 0 says, until it drops its solver; how many particles this
/// rank has then.
pub fn serve(mut own: Box<dyn Solver>, with: &dyn Communicator) -> usize {
    loop {
        match broadcast(with, 0, None) {
            Order::Meet(interval) => own.meet(interval),
            Order::Advance => {
                // Rank 0 has the same error.
                let _ = own.advance(&mut |own| {
                    while let Some(order) = going_on(broadcast(with, 0, None)) {
                        answer(own, with, order);
                    }
                });
                counted(with, own.len());
            }
            Order::End => return own.len(),
            order => answer(&*own, with, order),
        }
    }
}

fn going_on(order: Order) -> Option<Order> {
    match order {
        Order::GoOn => None,
        order => Some(order),
    }
}

fn answer(own: &dyn Solver, with: &dyn Communicator, order: Order) {
    match order {
        Order::State => {
            collect(with, own.state(), |_, _| ());
        }
        Order::Share => give(&named(with, own.state()), with),
        Order::Frame => {
            collect(with, own.frame(), |_, _| ());
        }
        Order::Unrest => {
            own.unrest();
        }
        other => unreachable!("{other:?} between steps"),
    }
}

/// Particles of all ranks.
pub fn counted(with: &dyn Communicator, own: usize) -> usize {
    gather(with, &(own as u64)).iter().sum::<u64>() as usize
}

/// Gives all ranks about as many particles of the state that rank 0 has; the part of this one.
pub fn scatter(with: &dyn Communicator, state: Option<State>) -> State {
    let Some(state) = state else {
        return decoded(&with.exchange(&[], &[0])[0]);
    };
    let (count, size) = (state.particles.len(), with.size());
    let part = |rank: usize| state.part(count * rank / size..count * (rank + 1) / size);
    for rank in 1..size {
        with.exchange(&[(rank, encoded(&part(rank)))], &[]);
    }
    part(0)
}

/// Appends the part of a state that the next rank has; `count`: particles of all.
fn join_states(whole: &mut State, part: State, count: usize) {
    let (own, more) = (&mut whole.particles, part.particles);
    append(&mut own.id, &more.id, count);
    append(&mut own.body, &more.body, count);
    for a in 0..3 {
        append(&mut own.position[a], &more.position[a], count);
        append(&mut own.velocity[a], &more.velocity[a], count);
    }
    append(&mut own.density, &more.density, count);
    append(&mut own.weight, &more.weight, count);
    // A rank without particles has no arrays.
    for (name, more) in &part.arrays {
        let place = whole.arrays.iter().position(|(own, _)| own == name);
        let place = place.unwrap_or_else(|| {
            whole.arrays.push((name.clone(), Vec::new()));
            whole.arrays.len() - 1
        });
        append(&mut whole.arrays[place].1, more, count);
    }
}

/// The same of a frame.
fn join_frames(whole: &mut Frame, part: Frame, count: usize) {
    append(&mut whole.id, &part.id, count);
    append(&mut whole.body, &part.body, count);
    for a in 0..3 {
        append(&mut whole.position[a], &part.position[a], count);
        append(&mut whole.velocity[a], &part.velocity[a], count);
    }
    append(&mut whole.pressure, &part.pressure, count);
    append(&mut whole.density, &part.density, count);
    append(&mut whole.surface, &part.surface, count);
    append(&mut whole.mass, &part.mass, count);
}

/// `count`: the length that `whole` will have, unless it stays empty.
fn append<T: Copy>(whole: &mut Vec<T>, part: &[T], count: usize) {
    if !part.is_empty() {
        whole.reserve_exact(count.max(whole.len() + part.len()) - whole.len());
        whole.extend_from_slice(part);
    }
}
