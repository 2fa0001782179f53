//! What campaigns found, grouped.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// `check` of each item, on all cores; results in order.
pub fn side_by_side<T: Sync, R: Send>(items: &[T], check: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some((place, item)) = {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    items.get(place).map(|item| (place, item))
                } {
                    let result = check(item);
                    results
                        .lock()
                        .expect("no check panics")
                        .push((place, result));
                }
            });
        }
    });
    let mut results = results.into_inner().expect("no check panics");
    results.sort_by_key(|(place, _)| *place);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Problems by kind, and how many checks were made.
pub struct Report {
    title: &'static str,
    checks: usize,
    /// Checks whose call did not come: the program took another turn this time.
    missed: usize,
    /// What went wrong, to where.
    problems: BTreeMap<String, Vec<String>>,
}

impl Report {
    pub fn new(title: &'static str) -> Self {
        Report {
            title,
            checks: 0,
            missed: 0,
            problems: BTreeMap::new(),
        }
    }

    /// Prints what a part was; the checks of all parts may take an hour.
    pub fn count(&mut self, part: &str, calls: usize, checks: usize) {
        println!("{}: {part}: {calls} calls, {checks} checks", self.title);
        self.checks += checks;
    }

    pub fn add(&mut self, part: &str, place: &str, result: Result<(), String>) {
        if result.as_ref().is_err_and(|what| what == MISSED) {
            self.missed += 1;
        } else if let Err(what) = result {
            // At once: the rest may take an hour.
            println!("{}: {part}: {place}: {what}", self.title);
            let kind = format!("{part}: {}", plain(&what));
            self.problems
                .entry(kind)
                .or_default()
                .push(place.to_string());
        }
    }

    /// Prints all of it; panics if there is a problem.
    pub fn end(self) {
        let bad: usize = self.problems.values().map(Vec::len).sum();
        for (kind, places) in &self.problems {
            println!("{} x {kind}", places.len());
            for place in places.iter().take(SHOWN) {
                println!("      {place}");
            }
        }
        let Report {
            title,
            checks,
            missed,
            ..
        } = self;
        println!("{title}: {checks} checks, {missed} missed, {bad} bad");
        assert!(missed * 10 <= checks, "too many calls did not come again");
        assert_eq!(bad, 0, "{title}");
    }
}

/// In the place of a problem: the call of a check did not come.
pub const MISSED: &str = "the call did not come";

/// Of each kind of problem, how many places are printed.
const SHOWN: usize = 400;

/// So that problems that differ in numbers and paths only are one kind.
fn plain(text: &str) -> String {
    let word = |word: &str| match word.contains('/') && !word.starts_with("latest/") {
        true => "PATH".to_string(),
        false if word.starts_with("Code(") => word.to_string(),
        false => word.replace(|c: char| c.is_ascii_digit(), "N"),
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}
