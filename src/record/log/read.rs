//! Reads logs item by item, with memory for one chunk.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::read::ChannelAccumulator;
use mcap::records::{Channel, SchemaHeader, op};

use super::fields::Fields;
use super::records::Records;
use super::{FIGURES, LogBody, LogError, REVOLVED, cloud, measures};
use crate::particle::Frame;
use crate::record::digest::{Digest, Hasher};
use crate::scene::error::SceneError;
use crate::scene::{Dimension, Scene, file};

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

    /// Whether this is of a frame, but for viewers: the body of revolution, the figures.
    pub fn is_for_viewers(&self) -> bool {
        [REVOLVED, FIGURES].contains(&self.channel.topic.as_str())
    }

    /// Whether this ends a frame.
    pub fn is_measures(&self) -> bool {
        self.channel.topic == "/measures"
    }
}

/// The items of an MCAP file, in order. Ends after the first error; without one, the file is
/// complete.
pub struct Items {
    path: PathBuf,
    records: Records,
    channels: ChannelAccumulator<'static>,
    done: bool,
}

impl Items {
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Ok(Items {
            path: path.to_path_buf(),
            records: Records::open(path)?,
            channels: ChannelAccumulator::default(),
            done: false,
        })
    }

    /// Whether the error is that the file ends too early.
    pub fn is_cut_off(&self) -> bool {
        self.records.is_cut_off
    }

    /// After damage inside a chunk, which ends with a frame: continues behind it. False if the
    /// damage is elsewhere.
    pub fn pass_damage(&mut self) -> Result<bool, LogError> {
        self.done = !self.records.pass_chunk()?;
        Ok(!self.done)
    }

    /// The next item; `None` at the end of a complete file.
    fn advance(&mut self) -> Result<Option<Item>, LogError> {
        while let Some((opcode, body)) = self.records.advance()? {
            let item = accept(&mut self.channels, opcode, body);
            let damaged = |what| LogError::Damaged {
                path: self.path.clone(),
                what,
            };
            if let Some(item) = item.map_err(damaged)? {
                return Ok(Some(item));
            }
        }
        Ok(None)
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

/// Records schemas and channels; returns messages, metadata and attachments.
fn accept(
    channels: &mut ChannelAccumulator<'static>,
    opcode: u8,
    body: &[u8],
) -> Result<Option<Item>, String> {
    let mut fields = Fields(body);
    let item = match opcode {
        op::SCHEMA => {
            let header = SchemaHeader {
                id: fields.u16()?,
                name: fields.text()?,
                encoding: fields.text()?,
            };
            let length = fields.u32()?;
            let added = channels.add_schema_from_slice(header, fields.bytes(length.into())?);
            added.map_err(|error| error.to_string())?;
            None
        }
        op::CHANNEL => {
            let channel = Channel {
                id: fields.u16()?,
                schema_id: fields.u16()?,
                topic: fields.text()?,
                message_encoding: fields.text()?,
                metadata: fields.map()?,
            };
            let added = channels.add_channel(channel);
            added.map_err(|error| error.to_string())?;
            None
        }
        op::MESSAGE => {
            let id = fields.u16()?;
            let _sequence = fields.u32()?;
            let log_time = fields.u64()?;
            let _publish_time = fields.u64()?;
            let channel = channels.get(id).ok_or("a message of an unknown channel")?;
            let data = std::mem::take(&mut fields.0).to_vec();
            Some(Item::Message(Message {
                channel,
                log_time,
                data,
            }))
        }
        op::METADATA => Some(Item::Metadata(fields.text()?, fields.map()?)),
        op::ATTACHMENT => Some(attachment(&mut fields, body)?),
        _ => return Ok(None),
    };
    fields.end()?;
    Ok(item)
}

fn attachment(fields: &mut Fields, body: &[u8]) -> Result<Item, &'static str> {
    let _times = (fields.u64()?, fields.u64()?);
    let (name, media_type) = (fields.text()?, fields.text()?);
    let length = fields.u64()?;
    let data = fields.bytes(length)?.to_vec();
    let hashed = &body[..body.len() - fields.0.len()];
    // Zero: no check sum.
    let crc = fields.u32()?;
    if crc != 0 && crc != crc32fast::hash(hashed) {
        return Err("the check sum of an attachment is wrong");
    }
    Ok(Item::Attachment {
        name,
        media_type,
        data,
    })
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
        let decoded = decoded.ok_or("a measures message does not fit its schema")?;
        // Frames are selected by comparison of their times.
        match decoded.0.is_finite() {
            true => Ok(decoded),
            false => Err(format!("a frame's time is {}", decoded.0)),
        }
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
///
/// # Errors
/// If the file cannot be opened or is not an MCAP file.
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
        for item in &mut self.items {
            let Item::Message(message) = item? else {
                continue;
            };
            if let Some(body) = message.body() {
                cloud::decode(&message.data, body, &mut frame).map_err(&foreign)?;
            } else if message.is_measures() {
                (frame.time, frame.scalars) = self.measures.decode(&message).map_err(&foreign)?;
                if !frame.mass.is_empty() && frame.mass.len() != frame.id.len() {
                    return Err(foreign(
                        "some bodies of a frame have masses, some not".into(),
                    ));
                }
                frame.sort();
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

/// Facts that a log states once, at its beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct Info {
    /// In the order of `Frame::body`.
    pub bodies: Vec<LogBody>,
    /// Particle spacing, m.
    pub spacing: f64,
    /// Number of space dimensions.
    pub dimension: Dimension,
    /// Log time = simulated time x this.
    pub time_scale: f64,
    /// Time of contact of the drop, s; `None` if nothing meets, and in logs of earlier versions.
    pub contact: Option<f64>,
    /// Text of the pipeline file.
    pub scene_text: String,
    /// Names and values: keys, versions, settings.
    pub provenance: BTreeMap<String, String>,
}

impl Info {
    /// The scene, without its reference curves, which are in files beside the pipeline file.
    ///
    /// # Errors
    /// If the text is not a scene of this version.
    pub fn scene(&self, path: &Path) -> Result<Scene, SceneError> {
        let sets = ["post.references=[]".to_string()];
        let name = path.with_extension("toml");
        Ok(file::read(&self.scene_text, &name, &sets)?.scene)
    }
}

/// Reads the facts at the beginning of the log at `path`.
///
/// # Errors
/// If the file cannot be read or is not a log of Coronet.
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
            contact: number("contact_s"),
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
///
/// # Errors
/// If the file cannot be read to its end.
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
