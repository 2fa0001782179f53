//! `coronet recover`: a log that was cut off or damaged.

use anyhow::{Result, bail};
use coronet::file::exists;
use coronet::pipeline::content::LOG;
use coronet::pipeline::stamp;
use coronet::record::log::{self, LogError};
use serde_json::json;

use crate::arguments::RecoverArguments;
use crate::fault::{Stopped, Untrusted, Usage};
use crate::journal::FRAMES;
use crate::print::{out, shown};
use crate::signals;

/// Answer to a first signal.
const STOPPING: &str = "stopping after this frame";

pub fn recover(arguments: &RecoverArguments) -> Result<()> {
    let mut beside = arguments.log.file_stem().unwrap_or_default().to_os_string();
    beside.push(format!("-recovered.{LOG}"));
    let beside = arguments.log.with_file_name(beside);
    let new = arguments.output.clone().unwrap_or(beside);
    let is_log = new.file_name().is_some_and(|name| name == FRAMES);
    if is_log && exists(&new.with_file_name(stamp::FILE))? {
        let text = format!("{} is that of a result; give another --output", shown(&new));
        bail!(Usage(text));
    }
    let stop = signals::stop_flag(STOPPING)?;
    let recovered = log::recover_unless(&stop, &arguments.log, &new);
    let recovered = recovered.map_err(|error| match error {
        LogError::Stopped => Stopped(error.to_string()).into(),
        LogError::NotReplaced { .. } => Usage(error.to_string()).into(),
        LogError::Io(of) if of.is_not_found() => Usage(of.to_string()).into(),
        error if error.is_damage() => Untrusted(format!(
            "{error}; nothing was written. Run the pipeline again to get the frames: it continues \
             from its last checkpoint"
        ))
        .into(),
        error => anyhow::Error::from(error),
    })?;
    let (frames, last) = (recovered.frames, recovered.last_time);
    if arguments.json {
        let object = json!({"log": shown(&new), "frames": frames, "last_s": last,
            "damage": recovered.damage});
        out!("{object}");
        return Ok(());
    }
    match recovered.damage {
        None => out!("{} was complete", arguments.log.display()),
        Some(damage) => out!("{} is damaged: {damage}", arguments.log.display()),
    }
    out!("{} has {frames} frames up to t = {last} s", new.display());
    Ok(())
}
