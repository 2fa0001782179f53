//! Requests to stop a run: signals, and the end of the process that started it.

use std::io::{ErrorKind, Read as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};

use crate::print::note;

/// Time within which further signals belong to the first.
const ECHO: Duration = Duration::from_millis(500);

/// A flag that Ctrl-C and termination signals set. A second signal ends the program at once; the
/// last checkpoint stays valid. A signal that was ignored when the program started, as the hang-up
/// under `nohup`, stays ignored.
pub fn stop_flag(words: &'static str) -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    listen(&stop, words).context("cannot listen to signals")?;
    Ok(stop)
}

/// A file that grows beyond the limit of the process is an error of its writing, not a signal.
pub fn leave_sizes_to_writers() -> Result<()> {
    #[cfg(unix)]
    signal_hook::flag::register(libc::SIGXFSZ, Arc::new(AtomicBool::new(false)))?;
    Ok(())
}

/// Leaves it to another process to stop this one.
pub fn leave_to_another() -> Result<()> {
    #[cfg(unix)]
    for signal in [
        signal_hook::consts::SIGINT,
        signal_hook::consts::SIGTERM,
        signal_hook::consts::SIGHUP,
    ] {
        signal_hook::flag::register(signal, Arc::new(AtomicBool::new(false)))?;
    }
    Ok(())
}

/// Sets the flag when standard input ends, which the starting process keeps open.
pub fn stop_at_end_of_input(stop: &Arc<AtomicBool>) -> Result<()> {
    let stop = stop.clone();
    let wait = move || {
        let mut input = std::io::stdin().lock();
        let mut buffer = [0; 256];
        loop {
            match input.read(&mut buffer) {
                Ok(0) => break,
                Err(error) if error.kind() != ErrorKind::Interrupted => break,
                _ => {}
            }
        }
        stop.store(true, Ordering::Relaxed);
    };
    let thread = std::thread::Builder::new().name("parent".into());
    thread.spawn(wait).context("cannot watch standard input")?;
    Ok(())
}

/// `first`: when the first signal came. What follows it within [`ECHO`] is the same request, sent
/// to a process and to its group.
fn ask(stop: &AtomicBool, first: &mut Option<Instant>, words: &str) {
    match first {
        Some(first) if first.elapsed() < ECHO => return,
        Some(_) => std::process::exit(i32::from(crate::fault::INTERRUPTED)),
        None => *first = Some(Instant::now()),
    }
    stop.store(true, Ordering::Relaxed);
    note!("{words}; once more to stop at once");
}

#[cfg(unix)]
fn listen(stop: &Arc<AtomicBool>, words: &'static str) -> Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let heard: Vec<i32> = [SIGINT, SIGTERM, SIGHUP]
        .into_iter()
        .filter(|signal| !is_ignored(*signal))
        .collect();
    let mut signals = signal_hook::iterator::Signals::new(heard)?;
    let stop = stop.clone();
    let wait = move || {
        let mut first = None;
        for _ in signals.forever() {
            ask(&stop, &mut first, words);
        }
    };
    let thread = std::thread::Builder::new().name("signals".into());
    thread.spawn(wait)?;
    Ok(())
}

#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    // SAFETY: all zeros are a valid `sigaction`.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: with no new action the call only fills it.
    let asked = unsafe { libc::sigaction(signal, std::ptr::null(), &mut action) };
    asked == 0 && action.sa_sigaction == libc::SIG_IGN
}

#[cfg(not(unix))]
fn listen(stop: &Arc<AtomicBool>, words: &'static str) -> Result<()> {
    let stop = stop.clone();
    let mut first = None;
    Ok(ctrlc::set_handler(move || ask(&stop, &mut first, words))?)
}
