//! Reading logs, record by record, in memory for one chunk.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::read::ChannelAccumulator;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::{LogBody, LogError, cloud, measures};
use crate::particle::Frame;
use crate::record::atomic::FileError;
use crate::record::digest::{Digest, Hasher};
use crate::scene::Dimension;

/// No record of our making expands more.
const LARGEST_EXPANSION: u64 = 256;

pub enum Item {
    Message(Message),
    Metadata(String, BTreeMap<String, String>),
    Attachment {
        name: String,
        media_type: String,
        data: Vec<u8>,
    },
}

pub struct Message {
    pub channel: Arc<mcap::Channel<'static>>,
    pub log_time: u64,
    pub data: Vec<u8>,
}

impl Message {
    /// Index of the body whose cloud this is.
    pub fn body(&self) -> Option<u8> {
        if !self.channel.topic.starts_with("/body/") {
            return None;
        }
        self.channel.metadata.get("body")?.parse().ok()
    }

    /// Whether this ends a frame.
    pub fn is_measures(&self) -> bool {
        self.channel.topic == "/measures"
    }
}

/// Records of an MCAP file in order. Ends after the first error; without one, the file was
/// complete.
pub struct Items {
    path: PathBuf,
    source: BufReader<File>,
    reader: LinearReader,
    channels: ChannelAccumulator<'static>,
    done: bool,
}

impl Items {
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let file = crate::file::open(path)?;
        let length = file.metadata().map_err(FileError::new(path, "read"))?.len();
        let mut start = Vec::new();
        (&file)
            .take(mcap::MAGIC.len() as u64)
            .read_to_end(&mut start)
            .map_err(FileError::new(path, "read"))?;
        if !mcap::MAGIC.starts_with(&start) {
            return Err(LogError::NotALog {
                path: path.to_path_buf(),
            });
        }
        let limit = length.saturating_mul(LARGEST_EXPANSION).max(1 << 26);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            // A chunk is looked at whole: if it is damaged, none of its messages comes out.
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(usize::try_from(limit).unwrap_or(usize::MAX));
        Ok(Items {
            path: path.to_path_buf(),
            source: BufReader::with_capacity(1 << 20, file),
            reader: LinearReader::new_with_options(options),
            channels: ChannelAccumulator::default(),
            done: false,
        })
    }

    /// The next record that matters; `None` at the end of a complete file.
    fn advance(&mut self) -> Result<Option<Item>, LogError> {
        loop {
            let damaged = |error: mcap::McapError| LogError::Damaged {
                path: self.path.clone(),
                what: error.to_string(),
            };
            let Some(event) = self.reader.next_event() else {
                return Ok(None);
            };
            match event.map_err(damaged)? {
                LinearReadEvent::ReadRequest(need) => {
                    let read = loop {
                        match self.source.read(self.reader.insert(need)) {
                            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                            other => break other.map_err(FileError::new(&self.path, "read"))?,
                        }
                    };
                    self.reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => {
                    let record = mcap::parse_record(opcode, data).map_err(damaged)?;
                    if let Some(item) = accept(&mut self.channels, record).map_err(damaged)? {
                        return Ok(Some(item));
                    }
                }
            }
        }
    }
}

impl Iterator for Items {
    type Item = Result<Item, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let item = self.advance().transpose();
        self.done = !matches!(item, Some(Ok(_)));
        item
    }
}

/// Notes schemas and channels; passes on messages, metadata and attachments.
fn accept(
    channels: &mut ChannelAccumulator<'static>,
    record: Record<'_>,
) -> Result<Option<Item>, mcap::McapError> {
    match record {
        Record::Schema { header, data } => channels.add_schema_from_slice(header, &data)?,
        Record::Channel(channel) => channels.add_channel(channel)?,
        Record::Message { header, data } => {
            let channel =
                channels
                    .get(header.channel_id)
                    .ok_or(mcap::McapError::UnknownChannel(
                        header.sequence,
                        header.channel_id,
                    ))?;
            return Ok(Some(Item::Message(Message {
                channel,
                log_time: header.log_time,
                data: data.into_owned(),
            })));
        }
        Record::Metadata(record) => {
            return Ok(Some(Item::Metadata(record.name, record.metadata)));
        }
        Record::Attachment { header, data, .. } => {
            return Ok(Some(Item::Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }));
        }
        _ => {}
    }
    Ok(None)
}

/// Decodes the scalars of frames, keeping the schemas seen.
#[derive(Default)]
pub struct MeasuresDecoder {
    schemas: HashMap<u16, measures::Schema>,
}

impl MeasuresDecoder {
    /// Time, s, and scalars of a `/measures` message.
    pub fn decode(&mut self, message: &Message) -> Result<(f64, Vec<(String, f64)>), String> {
        let channel = &message.channel;
        let schema = match self.schemas.entry(channel.id) {
            std::collections::hash_map::Entry::Occupied(entry) => entry.into_mut(),
            std::collections::hash_map::Entry::Vacant(entry) => {
                let parsed = channel
                    .schema
                    .as_ref()
                    .filter(|schema| schema.name == measures::NAME)
                    .and_then(|schema| measures::Schema::parse(&schema.data));
                entry.insert(parsed.ok_or("its measures have another schema")?)
            }
        };
        let decoded = schema.decode(&message.data);
        decoded.ok_or_else(|| "a measures message does not fit its schema".into())
    }
}

/// The frames of a log, see [`read_frames`].
pub struct Frames {
    items: Items,
    measures: MeasuresDecoder,
    done: bool,
}

/// Reads a log frame by frame, particles sorted by id as in the solver's frame. A cut-off or
/// damaged log gives the frames before the damage, then the error.
pub fn read_frames(path: &Path) -> Result<Frames, LogError> {
    Ok(Frames {
        items: Items::open(path)?,
        measures: MeasuresDecoder::default(),
        done: false,
    })
}

impl Frames {
    fn advance(&mut self) -> Result<Option<Frame>, LogError> {
        let mut frame = Frame::default();
        let path = self.items.path.clone();
        let foreign = |what| LogError::Foreign {
            path: path.clone(),
            what,
        };
        while let Some(item) = self.items.next() {
            let Item::Message(message) = item? else {
                continue;
            };
            if let Some(body) = message.body() {
                cloud::decode(&message.data, body, &mut frame).map_err(&foreign)?;
            } else if message.is_measures() {
                (frame.time, frame.scalars) = self.measures.decode(&message).map_err(foreign)?;
                sort_by_id(&mut frame);
                return Ok(Some(frame));
            }
        }
        Ok(None)
    }
}

impl Iterator for Frames {
    type Item = Result<Frame, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let frame = self.advance().transpose();
        self.done = !matches!(frame, Some(Ok(_)));
        frame
    }
}

/// Bodies come one after the other; ids usually do, too, and then nothing is to be done.
fn sort_by_id(frame: &mut Frame) {
    if frame.id.is_sorted() {
        return;
    }
    let mut order: Vec<usize> = (0..frame.id.len()).collect();
    order.sort_by_key(|i| frame.id[*i]);
    fn permute<T: Copy>(values: &mut Vec<T>, order: &[usize]) {
        *values = order.iter().map(|i| values[*i]).collect();
    }
    permute(&mut frame.id, &order);
    permute(&mut frame.body, &order);
    for component in frame.position.iter_mut().chain(&mut frame.velocity) {
        permute(component, &order);
    }
    permute(&mut frame.pressure, &order);
    permute(&mut frame.density, &order);
    permute(&mut frame.surface, &order);
}

/// What a log says once.
#[derive(Clone, Debug, PartialEq)]
pub struct Info {
    pub bodies: Vec<LogBody>,
    /// Particle spacing, m.
    pub spacing: f64,
    pub dimension: Dimension,
    /// Log time = simulated time x this.
    pub time_scale: f64,
    /// Text of the pipeline file.
    pub scene_text: String,
    pub provenance: BTreeMap<String, String>,
}

/// Reads what the log at `path` says once, at its beginning.
pub fn info(path: &Path) -> Result<Info, LogError> {
    let mut facts = BTreeMap::new();
    let mut bodies = BTreeMap::new();
    let mut provenance = BTreeMap::new();
    let mut scene_text = String::new();
    for item in Items::open(path)? {
        match item? {
            Item::Metadata(name, map) if name == "coronet" => facts = map,
            Item::Metadata(name, map) if name == "bodies" => bodies = map,
            Item::Metadata(name, map) if name == "provenance" => provenance = map,
            Item::Metadata(..) => {}
            Item::Attachment { data, .. } => {
                scene_text = String::from_utf8_lossy(&data).into_owned();
            }
            Item::Message(_) => break,
        }
    }
    let number = |name: &str| facts.get(name).and_then(|text| text.parse::<f64>().ok());
    let parsed = || {
        Some(Info {
            bodies: bodies
                .values()
                .map(|text| body(text))
                .collect::<Option<_>>()?,
            spacing: number("spacing_m")?,
            dimension: match facts.get("dimension")?.as_str() {
                "2" => Dimension::Two,
                "3" => Dimension::Three,
                _ => return None,
            },
            time_scale: number("time_scale")?,
            scene_text: scene_text.clone(),
            provenance: provenance.clone(),
        })
    };
    parsed().ok_or_else(|| LogError::Foreign {
        path: path.to_path_buf(),
        what: "its metadata are missing".into(),
    })
}

/// A body from `#rrggbb name`.
fn body(text: &str) -> Option<LogBody> {
    let (colour, name) = text.strip_prefix('#')?.split_once(' ')?;
    let colour = u32::from_str_radix(colour, 16).ok()?;
    let [_, r, g, b] = colour.to_be_bytes();
    Some(LogBody {
        name: name.to_string(),
        colour: [r, g, b],
    })
}

/// SHA-256 over all messages in order: topic, log time, data. Compression and chunks do not count.
pub fn content_digest(path: &Path) -> Result<Digest, LogError> {
    let mut hasher = content_hasher();
    for item in Items::open(path)? {
        if let Item::Message(message) = item? {
            hash_message(&mut hasher, &message);
        }
    }
    Ok(hasher.finish())
}

pub fn content_hasher() -> Hasher {
    Hasher::new("coronet log 1")
}

pub fn hash_message(hasher: &mut Hasher, message: &Message) {
    hasher.text(&message.channel.topic).number(message.log_time);
    hasher.bytes(&message.data);
}
