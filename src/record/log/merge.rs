//! Merges segments into one log, and recovers a log that was cut off.

use std::fs::{self, Metadata};
use std::io::{BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::output::{Channel, Output};
use super::read::{Item, Items, MeasuresDecoder, Message, content_hasher};
use super::records::only_zeros;
use super::{LogError, cloud, read};
use crate::file::{self, FileError};
use crate::record::atomic::AtomicFile;
use crate::record::digest::{Digest, Hasher};

/// Metadata of a segment: `resumed_from_s`, if it is not the first.
pub(super) const SEGMENT: &str = "segment";

/// Metadata that state: all frames up to `time_s` precede this place and were durable.
pub(super) const DURABLE: &str = "durable";

/// A log of which a part is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The file.
    pub path: PathBuf,
    /// Simulated time of the checkpoint that it continues from, s; `None` at a fresh start.
    pub resumed_from: Option<f64>,
}

/// Content of a merged log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merged {
    /// Number of frames.
    pub frames: u64,
    /// Simulated time of the last frame, s; NaN if there is none.
    pub last_time: f64,
    /// Equal to [`content_digest`](read::content_digest) of the new file.
    pub digest: Digest,
}

/// Content recovered from a damaged log.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// Number of frames.
    pub frames: u64,
    /// Simulated time of the last frame, s.
    pub last_time: f64,
    /// What was wrong; `None` if the log was complete.
    pub damage: Option<String>,
}

pub(super) fn segment_path(folder: &Path, segment: u32) -> PathBuf {
    folder.join(format!("segment-{segment:03}.mcap"))
}

/// The segments in `folder` in the order of their numbers, each with its start. A segment that was
/// cut off before its start, or is all zeros after a loss of power, contains no frame and is left
/// out.
///
/// # Errors
/// If the folder or a file cannot be read, and ([damage](LogError::is_damage)) if a segment begins
/// in another way.
pub fn segments(folder: &Path) -> Result<Vec<Segment>, LogError> {
    let entries = fs::read_dir(folder).map_err(FileError::new(folder, "list"))?;
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

/// `Some(resumed_from)` of a segment; `None` if it ends before this record.
fn start_of(path: &Path) -> Result<Option<Option<f64>>, LogError> {
    let mut items = match Items::open(path) {
        Err(LogError::NotALog { .. }) if is_blank(path)? => return Ok(None),
        other => other?,
    };
    match items.next() {
        Some(Ok(Item::Metadata(name, facts))) if name == SEGMENT => {
            let Some(text) = facts.get("resumed_from_s") else {
                return Ok(Some(None));
            };
            let time = text.parse().ok().filter(|time: &f64| time.is_finite());
            let time = time.ok_or_else(|| foreign(path, format!("it starts at {text:?} s")))?;
            Ok(Some(Some(time)))
        }
        None => Ok(None),
        Some(Err(error)) if error.is_damage() && items.is_cut_off() => Ok(None),
        Some(Err(error)) => Err(error),
        Some(Ok(_)) => Err(foreign(path, "it does not begin as a segment".into())),
    }
}

/// Whether a file has only zeros.
fn is_blank(path: &Path) -> Result<bool, LogError> {
    let zeros = only_zeros(&mut BufReader::new(file::open(path)?));
    Ok(zeros.map_err(FileError::new(path, "read"))?)
}

/// Writes to `out`, atomically, the log of an uninterrupted run. It takes from each segment the
/// frames after the time from which it was resumed and up to the earliest time from which a later
/// one was resumed. Setup records are taken from the last segment, which must be complete; no
/// required frame of the others may be missing.
///
/// # Errors
/// If a file cannot be read or written, and ([damage](LogError::is_damage)) if a segment is
/// damaged or incomplete.
pub fn merge(segments: &[Segment], out: &Path) -> Result<Merged, LogError> {
    let mut file = AtomicFile::create(out)?;
    let shared = file.file().try_clone();
    let mut output = Output::new(shared.map_err(FileError::new(out, "open"))?, out, None)?;
    let never = AtomicBool::new(false);
    let mut copy = Copy::new(&mut output, &never);
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
/// byte or damaged. Of a damaged chunk the frames are lost; of other damage all that follow. On an
/// error `out` stays as it was.
///
/// # Errors
/// If a file cannot be read or written; if `out` is the same file as `path`, or exists and is
/// neither empty nor a log of Coronet ([`LogError::NotReplaced`]); and
/// ([damage](LogError::is_damage)) if there is no whole frame.
pub fn recover(path: &Path, out: &Path) -> Result<Recovered, LogError> {
    recover_unless(&AtomicBool::new(false), path, out)
}

/// As [`recover`], unless `stop` is set meanwhile.
///
/// # Errors
/// As there, and [`LogError::Stopped`].
pub fn recover_unless(stop: &AtomicBool, path: &Path, out: &Path) -> Result<Recovered, LogError> {
    check_output(path, out)?;
    let mut file = AtomicFile::create(out)?;
    let shared = file.file().try_clone();
    let mut output = Output::new(shared.map_err(FileError::new(out, "open"))?, out, None)?;
    let mut copy = Copy::new(&mut output, stop);
    copy.start(path)?;
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    let mut items = Items::open(path)?;
    let mut damage = None;
    while let (Some(what), _) = copy.frames(path, &mut items, all)? {
        damage.get_or_insert(what);
        if !items.pass_damage()? {
            break;
        }
    }
    let merged = copy.result();
    if merged.frames == 0 {
        return Err(LogError::NoFrames {
            path: path.to_path_buf(),
            what: damage.unwrap_or_else(|| "it is complete, but empty".into()),
        });
    }
    output.finish()?;
    file.commit()?;
    Ok(Recovered {
        frames: merged.frames,
        last_time: merged.last_time,
        damage,
    })
}

/// Fails if writing `out` would overwrite something other than an earlier log.
fn check_output(path: &Path, out: &Path) -> Result<(), LogError> {
    let not_replaced = |what| LogError::NotReplaced {
        path: out.to_path_buf(),
        what,
    };
    let input = fs::metadata(path).map_err(FileError::new(path, "read"))?;
    let there = match fs::metadata(out) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        other => other.map_err(FileError::new(out, "examine"))?,
    };
    if is_same_file(&input, path, &there, out) {
        return Err(not_replaced(
            "it is the damaged log itself; name another file",
        ));
    }
    if !there.is_file() {
        return Err(not_replaced("it is not a regular file"));
    }
    if there.len() == 0 {
        return Ok(());
    }
    match read::info(out) {
        Ok(_) => Ok(()),
        Err(error) if error.is_damage() => Err(not_replaced(
            "it exists and is not a log of Coronet; remove it or name another file",
        )),
        Err(error) => Err(error),
    }
}

#[cfg(unix)]
fn is_same_file(a: &Metadata, _: &Path, b: &Metadata, _: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_same_file(_: &Metadata, a: &Path, _: &Metadata, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Copies messages frame by frame.
struct Copy<'a> {
    output: &'a mut Output,
    stop: &'a AtomicBool,
    hasher: Hasher,
    measures: MeasuresDecoder,
    frames: u64,
    last_time: f64,
}

impl<'a> Copy<'a> {
    fn new(output: &'a mut Output, stop: &'a AtomicBool) -> Self {
        Copy {
            output,
            stop,
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

    /// Copies the setup records of the log at `path`, before its first frame.
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
                // The copy of the frames finds the damage again and handles it.
                Err(error) if error.is_damage() => break,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Copies the frames of `segment` with `after < time <= until`; fails if some are lost.
    fn segment(&mut self, segment: &Segment, after: f64, until: f64) -> Result<(), LogError> {
        // Channel numbers are different in every file.
        self.measures = MeasuresDecoder::default();
        let mut items = Items::open(&segment.path)?;
        let (damage, durable) = self.frames(&segment.path, &mut items, [after, until])?;
        match damage {
            Some(what) if durable < until => Err(LogError::FramesLost {
                path: segment.path.clone(),
                until,
                what,
            }),
            _ => Ok(()),
        }
    }

    /// Copies the frames of the rest of a log with `after < time <= until`, up to the first damage.
    /// Returns it, if any, and the last time up to which its frames were durable, s.
    fn frames(
        &mut self,
        path: &Path,
        items: &mut Items,
        [after, until]: [f64; 2],
    ) -> Result<(Option<String>, f64), LogError> {
        let mut durable = f64::NEG_INFINITY;
        let mut clouds = Vec::new();
        for item in items {
            if self.stop.load(Ordering::Relaxed) {
                return Err(LogError::Stopped);
            }
            match item {
                Ok(Item::Message(message)) if message.is_measures() => {
                    let time = match self.measures.decode(&message) {
                        Ok((time, _)) => time,
                        Err(what) => return Ok((Some(what), durable)),
                    };
                    clouds.push(message);
                    if after < time && time <= until {
                        self.frame(path, time, &clouds)?;
                    }
                    clouds.clear();
                }
                Ok(Item::Message(message)) if message.body().is_some() => {
                    if let Err(what) = cloud::parse(&message.data) {
                        return Ok((Some(what), durable));
                    }
                    clouds.push(message);
                }
                Ok(Item::Message(message)) if message.is_for_viewers() => clouds.push(message),
                Ok(Item::Metadata(name, facts)) if name == DURABLE => {
                    let time = facts.get("time_s").and_then(|text| text.parse().ok());
                    let Some(time) = time.filter(|time: &f64| time.is_finite()) else {
                        return Ok((Some("a durable time is not a number".into()), durable));
                    };
                    durable = durable.max(time);
                }
                Ok(_) => {}
                Err(LogError::Damaged { what, .. }) => return Ok((Some(what), durable)),
                Err(error) => return Err(error),
            }
        }
        Ok((None, durable))
    }

    fn frame(&mut self, path: &Path, time: f64, messages: &[Message]) -> Result<(), LogError> {
        for message in messages {
            self.message(message).map_err(|error| match error {
                // The copied content is wrong, not the writer.
                LogError::Frame(what) => foreign(path, what),
                other => other,
            })?;
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

fn foreign(path: &Path, what: String) -> LogError {
    LogError::Foreign {
        path: path.to_path_buf(),
        what,
    }
}
