//! Making one log of segments, and of a log that was cut off.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::output::{Channel, Output};
use super::read::{Item, Items, MeasuresDecoder, Message, content_hasher};
use super::{LogError, read};
use crate::record::atomic::{AtomicFile, FileError};
use crate::record::digest::{Digest, Hasher};

/// Metadata of a segment: `resumed_from_s`, if it is not the first.
pub(super) const SEGMENT: &str = "segment";

/// Metadata that say: all frames up to `time_s` lie before this place and were durable.
pub(super) const DURABLE: &str = "durable";

/// A log of which a part is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    pub path: PathBuf,
    /// Simulated time of the checkpoint that it goes on from, s; `None` at a fresh start.
    pub resumed_from: Option<f64>,
}

/// What a merged log holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merged {
    pub frames: u64,
    /// Simulated time of the last frame, s; NaN if there is none.
    pub last_time: f64,
    /// Same as [`content_digest`](read::content_digest) of the new file.
    pub digest: Digest,
}

/// What was saved from a damaged log.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    pub frames: u64,
    /// Simulated time of the last frame, s; NaN if there is none.
    pub last_time: f64,
    /// What was wrong; `None` if the log was complete.
    pub damage: Option<String>,
}

pub(super) fn segment_path(folder: &Path, segment: u32) -> PathBuf {
    folder.join(format!("segment-{segment:03}.mcap"))
}

/// The segments in `folder` in the order of their numbers, each with what it says about its start.
/// One that was cut off before it said anything holds no frame and is left out.
pub fn segments(folder: &Path) -> Result<Vec<Segment>, LogError> {
    let entries = std::fs::read_dir(folder).map_err(FileError::new(folder, "list"))?;
    let mut paths = Vec::new();
    for entry in entries {
        let name = entry.map_err(FileError::new(folder, "list"))?.file_name();
        let number = name
            .to_str()
            .and_then(|name| name.strip_prefix("segment-")?.strip_suffix(".mcap"))
            .and_then(|digits| digits.parse::<u32>().ok());
        if let Some(number) = number {
            paths.push((number, folder.join(name)));
        }
    }
    paths.sort();
    let mut segments = Vec::new();
    for (_, path) in paths {
        if let Some(resumed_from) = start_of(&path)? {
            segments.push(Segment { path, resumed_from });
        }
    }
    Ok(segments)
}

/// `Some(resumed_from)` of a segment; `None` if it ends before it says so.
fn start_of(path: &Path) -> Result<Option<Option<f64>>, LogError> {
    match Items::open(path)?.next() {
        Some(Ok(Item::Metadata(name, facts))) if name == SEGMENT => {
            let time = facts.get("resumed_from_s").map(|text| text.parse());
            time.transpose()
                .map(Some)
                .map_err(|_| foreign(path, "its start is no number".into()))
        }
        Some(Err(LogError::Damaged { .. })) | None => Ok(None),
        Some(Err(error)) => Err(error),
        Some(Ok(_)) => Err(foreign(path, "it does not begin as a segment".into())),
    }
}

/// Writes to `out`, atomically, the log that an undisturbed run would have written. Of each segment
/// it takes the frames after the time that it was resumed from and up to the earliest time that a
/// later one was resumed from. What a log says once is taken from the last segment, which must be
/// complete; of the others it must be certain that no wanted frame is missing.
pub fn merge(segments: &[Segment], out: &Path) -> Result<Merged, LogError> {
    let mut file = AtomicFile::create(out)?;
    let shared = file.file().try_clone();
    let mut output = Output::new(shared.map_err(FileError::new(out, "open"))?, out)?;
    let mut copy = Copy::new(&mut output);
    if let Some(last) = segments.last() {
        copy.start(&last.path)?;
    }
    for (index, segment) in segments.iter().enumerate() {
        let after = segment.resumed_from.unwrap_or(f64::NEG_INFINITY);
        let later = segments[index + 1..].iter();
        let until = later
            .map(|later| later.resumed_from.unwrap_or(f64::NEG_INFINITY))
            .fold(f64::INFINITY, f64::min);
        if after < until {
            copy.segment(segment, after, until)?;
        }
    }
    let merged = copy.result();
    output.finish()?;
    file.commit()?;
    Ok(merged)
}

/// Writes to `out`, atomically, all whole frames of the log at `path`, which may be cut off at any
/// byte or damaged; frames after the damage are lost.
pub fn recover(path: &Path, out: &Path) -> Result<Recovered, LogError> {
    let mut file = AtomicFile::create(out)?;
    let shared = file.file().try_clone();
    let mut output = Output::new(shared.map_err(FileError::new(out, "open"))?, out)?;
    let mut copy = Copy::new(&mut output);
    copy.start(path)?;
    let (damage, _) = copy.frames(path, f64::NEG_INFINITY, f64::INFINITY)?;
    let merged = copy.result();
    output.finish()?;
    file.commit()?;
    Ok(Recovered {
        frames: merged.frames,
        last_time: merged.last_time,
        damage,
    })
}

/// Copies messages frame by frame.
struct Copy<'a> {
    output: &'a mut Output,
    hasher: Hasher,
    measures: MeasuresDecoder,
    frames: u64,
    last_time: f64,
}

impl<'a> Copy<'a> {
    fn new(output: &'a mut Output) -> Self {
        Copy {
            output,
            hasher: content_hasher(),
            measures: MeasuresDecoder::default(),
            frames: 0,
            last_time: f64::NAN,
        }
    }

    fn result(self) -> Merged {
        Merged {
            frames: self.frames,
            last_time: self.last_time,
            digest: self.hasher.finish(),
        }
    }

    /// Copies what the log at `path` says once, before its first frame.
    fn start(&mut self, path: &Path) -> Result<(), LogError> {
        for item in Items::open(path)? {
            match item {
                Ok(Item::Metadata(name, _)) if name == SEGMENT || name == DURABLE => {}
                Ok(Item::Metadata(name, facts)) => self.output.metadata(&name, facts)?,
                Ok(Item::Attachment {
                    name,
                    media_type,
                    data,
                }) => self.output.attachment(&name, &media_type, &data)?,
                Ok(Item::Message(message)) if message.is_measures() => break,
                Ok(Item::Message(message)) if message.body().is_some() => break,
                Ok(Item::Message(message)) => self.message(&message)?,
                // Whoever copies the frames meets the damage again and judges it.
                Err(LogError::Damaged { .. }) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Copies the frames of `segment` with `after < time <= until`, or tells that some are lost.
    fn segment(&mut self, segment: &Segment, after: f64, until: f64) -> Result<(), LogError> {
        let (damage, durable) = self.frames(&segment.path, after, until)?;
        match damage {
            Some(what) if durable < until => Err(LogError::FramesLost {
                path: segment.path.clone(),
                until,
                what,
            }),
            _ => Ok(()),
        }
    }

    /// Copies the frames of a log with `after < time <= until`. Returns its damage, if any, and the
    /// last time up to which its frames were durable, s.
    fn frames(
        &mut self,
        path: &Path,
        after: f64,
        until: f64,
    ) -> Result<(Option<String>, f64), LogError> {
        // Channel numbers mean something else in every file.
        self.measures = MeasuresDecoder::default();
        let mut durable = f64::NEG_INFINITY;
        let mut clouds = Vec::new();
        for item in Items::open(path)? {
            match item {
                Ok(Item::Message(message)) if message.is_measures() => {
                    let decoded = self.measures.decode(&message);
                    let (time, _) = decoded.map_err(|what| foreign(path, what))?;
                    clouds.push(message);
                    if after < time && time <= until {
                        self.frame(time, &clouds)?;
                    }
                    clouds.clear();
                }
                Ok(Item::Message(message)) if message.body().is_some() => clouds.push(message),
                Ok(Item::Metadata(name, facts)) if name == DURABLE => {
                    durable = durable.max(time_of(path, &facts)?);
                }
                Ok(_) => {}
                Err(LogError::Damaged { what, .. }) => return Ok((Some(what), durable)),
                Err(error) => return Err(error),
            }
        }
        Ok((None, durable))
    }

    fn frame(&mut self, time: f64, messages: &[Message]) -> Result<(), LogError> {
        for message in messages {
            self.message(message)?;
        }
        self.frames += 1;
        self.last_time = time;
        self.output.end_frame()
    }

    fn message(&mut self, message: &Message) -> Result<(), LogError> {
        read::hash_message(&mut self.hasher, message);
        let schema = message.channel.schema.as_deref();
        let channel = Channel {
            topic: &message.channel.topic,
            schema_name: schema.map_or("", |schema| &schema.name),
            schema: schema.map_or(&[], |schema| &schema.data),
            metadata: &message.channel.metadata,
        };
        self.output
            .message(channel, message.log_time, &message.data)
    }
}

fn time_of(path: &Path, facts: &BTreeMap<String, String>) -> Result<f64, LogError> {
    let time = facts.get("time_s").and_then(|text| text.parse().ok());
    time.ok_or_else(|| foreign(path, "a durable time is no number".into()))
}

fn foreign(path: &Path, what: String) -> LogError {
    LogError::Foreign {
        path: path.to_path_buf(),
        what,
    }
}
