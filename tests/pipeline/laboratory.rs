//! A toy pipeline: `grow` makes a number, `sum` adds the numbers of two.

use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use coronet::pipeline::remote::Remote;
use coronet::pipeline::*;
use coronet::record::{Array, Checkpoint};

pub const FILE: &str = "number.checkpoint";

/// Counts calls, can misbehave on demand.
#[derive(Default)]
pub struct Lab {
    pub calls: AtomicU32,
    /// Added to results that no setting explains: non-determinism.
    pub drift: AtomicU32,
    pub interrupt: AtomicBool,
    pub version: AtomicU32,
}

struct Grow<'a> {
    lab: &'a Lab,
    identity: Identity,
    size: u32,
}

struct Sum<'a> {
    lab: &'a Lab,
    identity: Identity,
    end: u32,
}

/// `idle` does not influence the result, only the key.
pub fn grow<'a>(lab: &'a Lab, body: &str, size: u32, idle: u32) -> Box<dyn Stage + 'a> {
    let identity = Identity {
        name: "grow",
        part: body.into(),
        version: 1 + lab.version.load(Ordering::Relaxed),
        settings: vec![setting("grow.size", size), setting("grow.idle", idle)],
    };
    Box::new(Grow {
        lab,
        identity,
        size,
    })
}

fn sum(lab: &Lab, end: u32) -> Box<dyn Stage + '_> {
    let identity = Identity {
        name: "sum",
        part: String::new(),
        version: 1,
        settings: vec![setting("sum.end", end)],
    };
    Box::new(Sum { lab, identity, end })
}

pub fn setting(name: &str, value: u32) -> Setting {
    Setting {
        name: name.into(),
        shown: format!("{value} m"),
        canonical: value.to_le_bytes().to_vec(),
    }
}

pub fn write(context: &Context, value: f64) -> Result<Vec<Output>, StageError> {
    let checkpoint = Checkpoint {
        kind: "number".into(),
        scalars: vec![("value".into(), value)],
        arrays: vec![("values".into(), Array::F64(vec![value; 1000]))],
        ..Checkpoint::default()
    };
    let path = context.output().join(FILE);
    checkpoint.write(&path, 1).map_err(StageError::failed)?;
    fs::write(
        context.output().join("page.txt"),
        std::process::id().to_string(),
    )
    .map_err(StageError::failed)?;
    Ok(vec![Output::counted(FILE), Output::shown("page.txt")])
}

impl Stage for Grow<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }
    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        self.lab.calls.fetch_add(1, Ordering::Relaxed);
        let drift = self.lab.drift.load(Ordering::Relaxed);
        write(context, f64::from(self.size + drift))
    }
}

impl Stage for Sum<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }
    fn inputs(&self) -> Vec<usize> {
        vec![0, 1]
    }
    fn extends(&self) -> Option<&str> {
        Some("sum.end")
    }
    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        self.lab.calls.fetch_add(1, Ordering::Relaxed);
        if self.lab.interrupt.load(Ordering::Relaxed) {
            fs::write(context.work().join("half.checkpoint"), "x").map_err(StageError::failed)?;
            return Err(StageError::Interrupted);
        }
        if context.work().join("half.checkpoint").exists() || !context.relatives.is_empty() {
            context.resumed();
        }
        let mut sum = f64::from(self.end);
        for index in 0..2 {
            sum += context
                .checkpoint(index, FILE)?
                .scalar("value")
                .expect("written above");
        }
        write(context, sum)
    }
}

pub fn pipeline<'a>(lab: &'a Lab, drop: u32, end: u32) -> Pipeline<'a> {
    Pipeline {
        name: "toy".into(),
        jobs: vec![
            grow(lab, "drop", drop, 0),
            grow(lab, "pool", 7, 0),
            sum(lab, end),
        ],
    }
}

/// Remembers warnings.
#[derive(Default)]
pub struct Notes(pub Mutex<Vec<String>>);

impl Watch for Notes {
    fn event(&self, event: &Event) {
        if let Event::Warning { text, .. } = event {
            self.0.lock().unwrap().push(text.to_string());
        }
    }
}

pub fn go(store: &Store, pipeline: &Pipeline) -> Result<Vec<Report>, PipelineError> {
    watched(store, pipeline, &Silent)
}

pub fn watched(
    store: &Store,
    pipeline: &Pipeline,
    watch: &dyn Watch,
) -> Result<Vec<Report>, PipelineError> {
    shared(store, pipeline, watch, None)
}

pub fn shared(
    store: &Store,
    pipeline: &Pipeline,
    watch: &dyn Watch,
    remote: Option<&Remote>,
) -> Result<Vec<Report>, PipelineError> {
    let ended = run(&Run {
        store,
        pipeline,
        also: None,
        until: None,
        stop: &AtomicBool::new(false),
        watch,
        remote,
        threads: 1,
        program: "toy".into(),
    })?;
    assert!(ended.unnamed.is_none(), "{:?}", ended.unnamed);
    Ok(ended.reports)
}

pub fn words(reports: &[Report]) -> Vec<&'static str> {
    reports.iter().map(|report| report.status.word()).collect()
}

/// Flips one bit in the middle of a file.
pub fn damage(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(path, bytes).unwrap();
}

pub fn store() -> (tempfile::TempDir, Store) {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path().join("artifacts"));
    (folder, store)
}
