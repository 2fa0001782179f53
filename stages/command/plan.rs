//! `coronet plan`, and the first output of `coronet run`.

use std::path::Path;

use anyhow::{Result, bail};
use coronet::pipeline::{self, Decision, Store, machine};
use serde_json::json;

use crate::arguments::{PipelineArguments, PlanArguments};
use crate::fault::Usage;
use crate::forecast;
use crate::jobs;
use crate::print::size;
use crate::print::{note, out};
use crate::ranks;
use crate::watch::duration;
use coronet::measure::series::{Reference, SeriesError};
use coronet::method::{MethodError, shared};
use coronet::scene::file::{self, Loaded};
use coronet::scene::{Scene, sanity};

/// Factor of this machine's memory from which a forecast is too much: its error may be a quarter.
const DOUBT: f64 = 1.25;

/// Size below which memory and disk are not reported, bytes.
const LITTLE: f64 = 1e8;

/// Loads the scene and checks its references: a mistake there would be found only after the run.
pub fn load(arguments: &PipelineArguments) -> Result<Loaded> {
    let loaded = file::load(&arguments.pipeline, &arguments.set)?;
    let folder = loaded.path.parent().unwrap_or(Path::new("."));
    for reference in &loaded.scene.post.references {
        match Reference::read(&folder.join(&reference.path), reference.clock) {
            Err(SeriesError::File(error)) if error.is_failure() => return Err(error.into()),
            Err(error) => bail!(Usage(format!("`post.references`: {error}"))),
            Ok(_) => {}
        }
    }
    Ok(loaded)
}

/// Warns of settings that are probably not intended.
pub fn warn(scene: &Scene) {
    for warning in sanity::warnings(scene) {
        note!("warning: {warning}");
    }
}

pub fn plan(arguments: &PlanArguments) -> Result<()> {
    let loaded = load(&arguments.pipeline)?;
    warn(&loaded.scene);
    let pipeline = jobs::pipeline(&loaded)?;
    let store = Store::new(&arguments.store.artifacts);
    let decisions = pipeline::plan(&store, &pipeline)?;
    let shared = arguments
        .ranks
        .map(|ranks| Shared::of(&loaded.scene, &decisions, ranks));
    let shared = shared.transpose()?;
    if arguments.store.json {
        for decision in &decisions {
            out!("{}", object(decision));
        }
        shared.iter().for_each(|shared| out!("{}", shared.object()));
        return fits_here(&decisions, arguments);
    }
    out!("{}", text(&decisions).trim_end());
    let stale = decisions.iter().filter(|decision| decision.fresh.is_none());
    if stale.clone().next().is_some() {
        let seconds: f64 = stale.clone().filter_map(|decision| decision.seconds).sum();
        let work = stale.filter_map(|decision| decision.work);
        let [memory, disk] = work.fold([0.0f64, 0.0], |[memory, disk], work| {
            [memory.max(work.memory), disk + work.disk]
        });
        let need = needs(memory, disk);
        out!("about {} of work{need}", duration(seconds));
    }
    shared.iter().for_each(|shared| out!("{}", shared.text()));
    fits_here(&decisions, arguments)
}

/// [`fits`] unless the run is to be shared, elsewhere.
fn fits_here(decisions: &[Decision], arguments: &PlanArguments) -> Result<()> {
    match arguments.ranks {
        None => fits(decisions, None),
        Some(_) => Ok(()),
    }
}

/// Whether several processes share a stage.
fn is_shared(decision: &Decision) -> bool {
    matches!(&*decision.stage, "pack" | "relax" | "impact")
}

/// A run on several processes.
struct Shared {
    ranks: u32,
    /// How many can have particles.
    most: usize,
    /// Wall time, s.
    seconds: f64,
    /// Of rank 0 and of each other one, bytes.
    memory: [f64; 2],
}

impl Shared {
    fn of(scene: &Scene, decisions: &[Decision], ranks: u32) -> Result<Self> {
        if let Some(reason) = shared::alone(scene) {
            bail!(Usage(MethodError::Alone(reason).to_string()));
        }
        let most = shared::most(scene).map_err(|error| Usage(error.to_string()))?;
        let working = (ranks as usize).min(most) as f64;
        let seconds = |decision: &Decision| {
            let seconds = decision.seconds.filter(|_| decision.fresh.is_none());
            seconds.unwrap_or(0.0) / if is_shared(decision) { working } else { 1.0 }
        };
        Ok(Shared {
            ranks,
            most,
            seconds: decisions.iter().map(seconds).sum(),
            memory: forecast::memory::shared(scene, working),
        })
    }

    fn text(&self) -> String {
        let [first, other] = self.memory.map(|bytes| size(bytes as u64));
        let (ranks, time) = (self.ranks, duration(self.seconds));
        let mut text = format!(
            "on {ranks} ranks about {time}, {first} of memory on rank 0, {other} on others"
        );
        if self.most < ranks as usize {
            text += &format!("; only {} of them can have particles", self.most);
        }
        text
    }

    fn object(&self) -> serde_json::Value {
        json!({
            "ranks": self.ranks,
            "ranks_with_particles": self.most.min(self.ranks as usize),
            "seconds": self.seconds,
            "memory_bytes": self.memory,
        })
    }
}

fn needs(memory: f64, disk: f64) -> String {
    let [memory, disk] = [memory, disk].map(|bytes| size(bytes as u64));
    format!(", {memory} of memory, {disk} of disk")
}

/// Fails if the forecast is certainly more than this machine's memory. `shared`: what processes
/// here need of it for a stage that they share with others, bytes.
pub fn fits(decisions: &[Decision], shared: Option<f64>) -> Result<()> {
    let memory = machine::memory();
    for decision in decisions.iter().filter(|decision| decision.fresh.is_none()) {
        let need = match shared {
            Some(bytes) if is_shared(decision) => Some(bytes),
            _ => decision.work.map(|work| work.memory),
        };
        let Some(need) = need.filter(|need| *need > DOUBT * memory) else {
            continue;
        };
        let [need, has] = [need, memory].map(|bytes| size(bytes as u64));
        let label = decision.label();
        return Err(Usage(format!(
            "{label} needs about {need} of memory, this machine has {has}; raise pack.spacing, \
             make the box smaller, set box.symmetry = \"quarter\" where the scene is symmetric, or \
             share the run among more machines, see `coronet plan --ranks`"
        ))
        .into());
    }
    Ok(())
}

/// Memory of the processes on this machine in a stage that they share with others, bytes.
pub fn shared_here(scene: &Scene) -> Option<f64> {
    let size = ranks::world()?.size();
    let working = shared::most(scene).map_or(size, |most| size.min(most));
    let [first, other] = forecast::memory::shared(scene, working as f64);
    let here = ranks::beside().min(working);
    Some(first + other * (here as f64 - 1.0))
}

/// One line for each job; the reasons of a stale one follow, one per line.
pub fn text(decisions: &[Decision]) -> String {
    let mut text = String::new();
    for decision in decisions {
        let (word, label) = (decision.word(), decision.label());
        let mut details = decision.reasons.clone();
        if let Some(start) = &decision.start {
            details.push(format!("continues from {start}"));
        }
        if let Some(seconds) = decision.seconds {
            let need = decision.work.filter(|work| work.memory > LITTLE);
            let need = need.map_or(String::new(), |work| needs(work.memory, work.disk));
            details.push(format!("about {}{need}", duration(seconds)));
        }
        if let Some(stamp) = &decision.fresh {
            details.push(stamp.digest.short());
        }
        for (index, detail) in details.iter().enumerate() {
            let (word, label) = if index == 0 {
                (word, label.as_str())
            } else {
                ("", "")
            };
            text += &format!("{word:8} {label:20} {detail}\n");
        }
    }
    text
}

fn object(decision: &Decision) -> serde_json::Value {
    json!({
        "stage": decision.stage,
        "body": decision.body,
        "status": decision.word(),
        "key": decision.key,
        "digest": decision.fresh.as_ref().map(|stamp| stamp.digest),
        "reasons": decision.reasons,
        "start": decision.start,
        "seconds": decision.seconds,
        "memory_bytes": decision.work.map(|work| work.memory),
        "disk_bytes": decision.work.map(|work| work.disk),
    })
}
