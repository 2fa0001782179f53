//! Shows the progress: bars on a terminal, plain lines elsewhere, JSON objects for scripts.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use coronet::pipeline::{Event, Progress, Report, Watch};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use crate::answer;
use crate::print::{note, out, plain, shown};

/// Least time between two plain lines.
const BETWEEN: Duration = Duration::from_secs(10);

/// Steps of a bar.
const LENGTH: u64 = 10_000;

pub struct Screen {
    json: bool,
    state: Mutex<State>,
}

struct State {
    bar: Option<ProgressBar>,
    /// State of the running job.
    start: Instant,
    /// Part of the work that was done when it started.
    first: Option<f64>,
    last_line: Instant,
}

impl Screen {
    pub fn new(json: bool) -> Self {
        let now = Instant::now();
        Screen {
            json,
            state: Mutex::new(State {
                bar: None,
                start: now,
                first: None,
                last_line: now,
            }),
        }
    }

    fn say(&self, text: &str) {
        let state = self.state.lock().expect("no panic while it is held");
        match &state.bar {
            Some(bar) => bar.suspend(|| note!("{text}")),
            None => note!("{text}"),
        }
    }

    fn start(&self, label: &str) {
        let mut state = self.state.lock().expect("no panic while it is held");
        let now = Instant::now();
        (state.start, state.last_line, state.first) = (now, now, None);
        if std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{prefix:16} {bar:24} {percent:>3} % {msg}");
            let target = ProgressDrawTarget::stderr_with_hz(5);
            let bar = ProgressBar::with_draw_target(Some(LENGTH), target);
            bar.set_style(style.expect("a valid template"));
            bar.set_prefix(plain(label));
            state.bar = Some(bar);
        }
    }

    fn progress(&self, label: &str, progress: &Progress) {
        let mut state = self.state.lock().expect("no panic while it is held");
        let first = *state.first.get_or_insert(progress.fraction);
        let message = message(progress, first, state.start.elapsed());
        if let Some(bar) = &state.bar {
            bar.set_position((progress.fraction * LENGTH as f64) as u64);
            bar.set_message(message);
        } else if state.last_line.elapsed() >= BETWEEN {
            state.last_line = Instant::now();
            note!("{label}: {:.0} %, {message}", 100.0 * progress.fraction);
        }
    }

    fn end(&self, report: &Report) {
        let bar = self
            .state
            .lock()
            .expect("no panic while it is held")
            .bar
            .take();
        if let Some(bar) = bar {
            bar.finish_and_clear();
        }
        if self.json {
            print_json(report);
        } else {
            print_line(report);
        }
    }
}

impl Watch for Screen {
    fn event(&self, event: &Event) {
        match event {
            Event::Waiting { job, holder } => self.say(&format!("{job}: waiting for {holder}")),
            Event::Started { decision } => {
                if let Some(start) = &decision.start {
                    self.say(&format!("{}: continuing from {start}", decision.label()));
                }
                self.start(&decision.label());
            }
            Event::Progress { job, progress } => self.progress(job, progress),
            Event::Warning { job, text } => self.say(&format!("warning: {job}: {text}")),
            Event::Kept { job, folder } => {
                let text = format!(
                    "checkpoints and frames so far are kept in {}",
                    folder.display()
                );
                self.say(&format!("warning: {job}: {text}"));
                if self.json {
                    out!("{}", json!({"stage": job, "kept": shown(folder)}));
                }
            }
            Event::Ended { report } => self.end(report),
        }
    }
}

/// `t = 3.1 of 40 ms, 2.1e6 particle-steps/s, 4 min left`.
fn message(progress: &Progress, first: f64, elapsed: Duration) -> String {
    let mut text = progress.text.clone();
    if progress.speed > 0.0 {
        text = format!("{text}, {:.2e} {}", progress.speed, progress.unit);
    }
    let done = progress.fraction - first;
    if done > 0.0 {
        let left = elapsed.as_secs_f64() / done * (1.0 - progress.fraction);
        text = format!("{text}, {} left", duration(left));
    }
    text
}

/// A time with a unit.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5940.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

fn print_line(report: &Report) {
    let word = report.status.word();
    let label = report.label();
    let digest = report.stamp.digest.short();
    if word == "fresh" {
        out!("{word:8} {label:20} {digest}");
        return;
    }
    let (wall, cpu) = (duration(report.seconds), duration(report.cpu_seconds));
    out!("{word:8} {label:20} {digest}  {wall} ({cpu} of CPU)");
    let notes = report.stamp.notes.iter();
    notes
        .filter(|note| !answer::is_warned(&report.stage, note))
        .for_each(|note| out!("{:8}   {note}", ""));
}

fn print_json(report: &Report) {
    let object = json!({
        "stage": report.stage,
        "body": report.body,
        "status": report.status.word(),
        "key": report.stamp.key,
        "digest": report.stamp.digest,
        "seconds": report.seconds,
        "cpu_seconds": report.cpu_seconds,
        "reasons": report.reasons,
        "folder": report.folder.to_string_lossy(),
        "notes": report.stamp.notes,
    });
    out!("{object}");
}
