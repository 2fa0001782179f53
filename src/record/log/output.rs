//! An MCAP file being written, with the options and the chunks that make it reproducible.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use foxglove::messages::{FrameTransform, PointCloud, Quaternion, Vector3};
use foxglove::{Encode, Schema as FoxgloveSchema};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, WriteOptions};
use prost::Message as _;

use super::{FIGURES, LogError, LogSetup, Message, REVOLVED, Tap, cloud, log_time, measures};
use crate::measure::series::Row;
use crate::particle::Frame;
use crate::record::atomic::FileError;
use crate::scene::Clock;

/// A chunk ends at the first end of a frame after this many bytes. A chunk contains at least a
/// frame; smaller chunks would compress worse and need a larger index.
const CHUNK: usize = 4 << 20;

/// zstd level of the chunks: noise of f32 limits the ratio, so a higher level gains nothing.
const LEVEL: u32 = 1;

/// Channel of a message.
#[derive(Clone, Copy)]
pub struct Channel<'a> {
    pub topic: &'a str,
    pub schema_name: &'a str,
    pub schema: &'a [u8],
    pub metadata: &'a BTreeMap<String, String>,
}

/// A channel in the file.
struct Known {
    id: u16,
    /// Number of messages so far.
    count: u32,
    schema: Vec<u8>,
}

/// Writes messages, metadata and attachments.
pub struct Output {
    writer: mcap::Writer<BufWriter<File>>,
    /// The open file, to make it durable.
    file: File,
    path: PathBuf,
    channels: HashMap<String, Known>,
    /// Bytes in the open chunk.
    pending: usize,
    tap: Option<Tap>,
}

impl Output {
    /// Starts a log in `file`, which is open for writing at `path`.
    pub fn new(file: File, path: &Path, tap: Option<Tap>) -> Result<Self, LogError> {
        let shared = file.try_clone().map_err(FileError::new(path, "open"))?;
        let writer = WriteOptions::new()
            // The default contains the version of the library, which would change the bytes.
            .library("coronet")
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(LEVEL)
            // A second thread pool would compete with the solver's, and change the bytes.
            .compression_threads(0)
            // Chunks end where frames end, see `end_frame`.
            .chunk_size(None)
            // A chunk is written as a whole.
            .disable_seeking(true)
            .create(BufWriter::new(shared))
            .map_err(LogError::writing(path))?;
        Ok(Output {
            writer,
            file,
            path: path.to_path_buf(),
            channels: HashMap::new(),
            pending: 0,
            tap,
        })
    }

    pub fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), LogError> {
        let record = Metadata {
            name: name.to_string(),
            metadata,
        };
        self.pending = 0;
        let written = self.writer.write_metadata(&record);
        written.map_err(LogError::writing(&self.path))
    }

    pub fn attachment(
        &mut self,
        name: &str,
        media_type: &str,
        data: &[u8],
    ) -> Result<(), LogError> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_string(),
            media_type: media_type.to_string(),
            data: data.into(),
        };
        self.pending = 0;
        let written = self.writer.attach(&attachment);
        written.map_err(LogError::writing(&self.path))
    }

    pub fn message(
        &mut self,
        channel: Channel<'_>,
        log_time: u64,
        data: &[u8],
    ) -> Result<(), LogError> {
        let wrong = LogError::writing(&self.path);
        if !self.channels.contains_key(channel.topic) {
            let schema = self
                .writer
                .add_schema(channel.schema_name, "protobuf", channel.schema)
                .map_err(&wrong)?;
            let id = self
                .writer
                .add_channel(schema, channel.topic, "protobuf", channel.metadata)
                .map_err(&wrong)?;
            let known = Known {
                id,
                count: 0,
                schema: channel.schema.to_vec(),
            };
            self.channels.insert(channel.topic.to_string(), known);
        }
        let known = self.channels.get_mut(channel.topic).expect("inserted");
        if known.schema != channel.schema {
            let what = format!("{} has another schema than before", channel.topic);
            return Err(LogError::Frame(what));
        }
        let header = MessageHeader {
            channel_id: known.id,
            sequence: known.count,
            log_time,
            publish_time: log_time,
        };
        known.count += 1;
        if let Some(tap) = &mut self.tap {
            tap(&Message {
                topic: channel.topic,
                schema_name: channel.schema_name,
                schema: channel.schema,
                log_time,
                data,
            });
        }
        self.pending += data.len();
        let written = self.writer.write_to_known_channel(&header, data);
        written.map_err(wrong)
    }

    /// A chunk may end here.
    pub fn end_frame(&mut self) -> Result<(), LogError> {
        if self.pending >= CHUNK {
            self.end_chunk()?;
        }
        Ok(())
    }

    /// Makes everything written so far durable.
    pub fn sync(&mut self) -> Result<(), LogError> {
        self.end_chunk()?;
        let synced = self.file.sync_data();
        Ok(synced.map_err(FileError::new(&self.path, "flush to disk"))?)
    }

    /// Ends the file and makes it durable.
    pub fn finish(mut self) -> Result<(), LogError> {
        self.writer
            .finish()
            .map_err(LogError::writing(&self.path))?;
        let io = FileError::new(&self.path, "write");
        self.writer.into_inner().flush().map_err(io)?;
        let synced = self.file.sync_all();
        Ok(synced.map_err(FileError::new(&self.path, "flush to disk"))?)
    }

    fn end_chunk(&mut self) -> Result<(), LogError> {
        self.pending = 0;
        let flushed = self.writer.flush();
        flushed.map_err(LogError::writing(&self.path))
    }
}

/// Writes the setup records of a log.
pub fn write_setup(output: &mut Output, setup: &LogSetup) -> Result<(), LogError> {
    for (name, metadata) in setup.metadata() {
        output.metadata(name, metadata)?;
    }
    let scene = setup.scene_text.as_bytes();
    output.attachment("pipeline.toml", "application/toml", scene)?;
    let transform = FrameTransform {
        timestamp: Some(cloud::timestamp(0)),
        parent_frame_id: "world".into(),
        child_frame_id: cloud::BOX.into(),
        translation: Some(Vector3::default()),
        rotation: Some(Quaternion {
            w: 1.0,
            ..Quaternion::default()
        }),
    };
    let bytes = transform.encode_to_vec();
    write_foxglove::<FrameTransform>(output, "/tf", &BTreeMap::new(), 0, &bytes)?;
    if !setup.wall[0].is_empty() {
        let bytes = cloud::encode_wall(&setup.wall);
        write_foxglove::<PointCloud>(output, "/wall", &BTreeMap::new(), 0, &bytes)?;
    }
    Ok(())
}

/// Names of the numbers of frames, from the first one on.
#[derive(Default)]
pub struct Schemas {
    figures: Option<measures::Schema>,
    scalars: Option<measures::Schema>,
}

/// Writes one frame: a cloud for each body, of rings their body of revolution too, `figures`, then
/// the scalars.
pub fn write_frame(
    output: &mut Output,
    setup: &LogSetup,
    schemas: &mut Schemas,
    frame: &Frame,
    figures: &Row,
) -> Result<(), LogError> {
    check(frame, setup)?;
    let time = log_time(frame.time, setup.time_scale);
    for (index, body) in setup.bodies.iter().enumerate() {
        let bytes = cloud::encode(frame, index as u8, setup, time);
        let metadata = BTreeMap::from([("body".to_string(), index.to_string())]);
        let topic = format!("/body/{}", body.name);
        write_foxglove::<PointCloud>(output, &topic, &metadata, time, &bytes)?;
    }
    if !frame.mass.is_empty() {
        let bytes = cloud::encode_revolved(frame, setup, time);
        write_foxglove::<PointCloud>(output, REVOLVED, &BTreeMap::new(), time, &bytes)?;
    }
    let at = (frame.time, Clock::after_contact(frame.time, setup.contact));
    if !figures.is_empty() {
        let topic = (FIGURES, measures::FIGURES);
        write_numbers(output, topic, &mut schemas.figures, time, at, figures)?;
    }
    let topic = ("/measures", measures::NAME);
    write_numbers(
        output,
        topic,
        &mut schemas.scalars,
        time,
        at,
        &frame.scalars,
    )?;
    output.end_frame()
}

/// `at`: times from the start and from contact, s.
fn write_numbers(
    output: &mut Output,
    (topic, schema_name): (&str, &str),
    schema: &mut Option<measures::Schema>,
    log_time: u64,
    at: (f64, Option<f64>),
    numbers: &Row,
) -> Result<(), LogError> {
    let schema = match schema {
        Some(schema) if schema.fits(numbers) => schema,
        Some(_) => {
            let what = format!("its numbers of {topic} have other names");
            return Err(LogError::Frame(what));
        }
        None => schema.insert(measures::Schema::new(numbers).map_err(LogError::Frame)?),
    };
    let channel = Channel {
        topic,
        schema_name,
        schema: &schema.descriptor(schema_name),
        metadata: &BTreeMap::new(),
    };
    let bytes = measures::Schema::encode(at.0, at.1, numbers);
    output.message(channel, log_time, &bytes)
}

/// Checks the lengths of the arrays and the bodies of a frame.
fn check(frame: &Frame, setup: &LogSetup) -> Result<(), LogError> {
    let count = frame.id.len();
    let lengths = frame.position.iter().chain(&frame.velocity).map(Vec::len);
    let others = [
        frame.body.len(),
        frame.pressure.len(),
        frame.density.len(),
        frame.surface.len(),
    ];
    let of_mass = Some(frame.mass.len()).filter(|length| *length > 0);
    if lengths
        .chain(others)
        .chain(of_mass)
        .any(|length| length != count)
    {
        return Err(LogError::Frame("its arrays differ in length".into()));
    }
    if let Some(body) = frame
        .body
        .iter()
        .find(|b| **b as usize >= setup.bodies.len())
    {
        return Err(LogError::Frame(format!("there is no body {body}")));
    }
    if !frame.time.is_finite() {
        return Err(LogError::Frame(format!("its time is {}", frame.time)));
    }
    Ok(())
}

fn write_foxglove<T: Encode>(
    output: &mut Output,
    topic: &str,
    metadata: &BTreeMap<String, String>,
    log_time: u64,
    bytes: &[u8],
) -> Result<(), LogError> {
    let FoxgloveSchema { name, data, .. } = T::get_schema().expect("well-known messages have one");
    let channel = Channel {
        topic,
        schema_name: &name,
        schema: &data,
        metadata,
    };
    output.message(channel, log_time, bytes)
}
