//! The records of an MCAP file (<https://mcap.dev/spec>, version 0), in order, chunks decoded.
//!
//! The reader of the mcap crate allocates the lengths that a file declares. This one reads
//! untrusted files, so memory grows as data are read, and a file is rejected if
//!
//! * a record declares more bytes than the file has left, or more than [`RECORD`] outside a chunk;
//! * the chunks so far declare more than [`SMALL`] + [`EXPANSION`] times the bytes of the file so
//!   far: particles have different ids and walls different places, so that even a lattice at rest
//!   compresses less;
//! * a chunk decodes to another size than it declares, or needs a zstd window above
//!   2^[`WINDOW_LOG`];
//! * a check sum is wrong: of a chunk before its first record is returned, of the data section and
//!   of the summary at their ends.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crc32fast::Hasher;
use mcap::records::op;

use super::LogError;
use super::fields::Fields;
use crate::file::{self, FileError};

/// Largest record outside of chunks, bytes: texts and indexes.
const RECORD: u64 = 64 << 20;

/// Permitted decoded size of the chunks of any file, bytes.
const SMALL: u64 = 8 << 20;

/// Permitted decoded size of the chunks beyond that, over the length of the file.
const EXPANSION: u64 = 256;

/// Largest permitted window of a zstd frame, log2 of bytes: that of level 19.
const WINDOW_LOG: u32 = 23;

/// Bytes of an opcode and a length.
const HEAD: usize = 9;

/// The file, with the CRC-32 of what was read.
struct Source {
    file: BufReader<File>,
    position: u64,
    crc: Hasher,
}

impl Read for Source {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Source {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.file.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.crc.update(&self.file.buffer()[..count]);
        self.position += count as u64;
        self.file.consume(count);
    }
}

/// Opcode and body of one record after the other.
pub struct Records {
    path: PathBuf,
    source: Source,
    /// Length of the file, bytes.
    length: u64,
    /// Body of the current record, or the decoded chunk that it belongs to.
    buffer: Vec<u8>,
    /// Where the next records of the chunk are in `buffer`.
    chunk: Range<usize>,
    /// Where the chunk that was begun last ends in the file; 0 without one.
    chunk_end: u64,
    /// Bytes of all chunks so far.
    decoded: u64,
    is_in_summary: bool,
    /// Whether the file only ends too early, as after a kill or a loss of power.
    pub is_cut_off: bool,
}

impl Records {
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let file = file::open(path)?;
        let length = file.metadata().map_err(FileError::new(path, "read"))?.len();
        let mut records = Records {
            path: path.to_path_buf(),
            source: Source {
                file: BufReader::with_capacity(1 << 20, file),
                position: 0,
                crc: Hasher::new(),
            },
            length,
            buffer: Vec::new(),
            chunk: 0..0,
            chunk_end: 0,
            decoded: 0,
            is_in_summary: false,
            is_cut_off: false,
        };
        records.read(mcap::MAGIC.len() as u64)?;
        if mcap::MAGIC.starts_with(&records.buffer) {
            return Ok(records);
        }
        Err(LogError::NotALog {
            path: path.to_path_buf(),
        })
    }

    /// The next record with content; `None` at the end of a complete file.
    pub fn advance(&mut self) -> Result<Option<(u8, &[u8])>, LogError> {
        let found = match self.in_chunk()? {
            Some(found) => Some(found),
            None => self.in_file()?,
        };
        Ok(found.map(|(opcode, place)| (opcode, &self.buffer[place])))
    }

    /// After damage in a chunk: goes to its end, from where [`Records::advance`] continues. False
    /// if the damage is elsewhere.
    pub fn pass_chunk(&mut self) -> Result<bool, LogError> {
        let end = std::mem::take(&mut self.chunk_end);
        if self.is_cut_off || end > self.length || end < self.source.position {
            return Ok(false);
        }
        self.chunk = 0..0;
        let left = end - self.source.position;
        let mut rest = (&mut self.source).take(left);
        io::copy(&mut rest, &mut io::sink()).map_err(FileError::new(&self.path, "read"))?;
        Ok(true)
    }

    fn in_chunk(&mut self) -> Result<Option<(u8, Range<usize>)>, LogError> {
        if self.chunk.is_empty() {
            return Ok(None);
        }
        let mut fields = Fields(&self.buffer[self.chunk.clone()]);
        let mut head = || {
            let (opcode, length) = (fields.u8()?, fields.u64()?);
            Ok((opcode, fields.bytes(length)?.len()))
        };
        let (opcode, length) = head().map_err(|what: &str| self.damaged(what))?;
        if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
            return Err(self.damaged(format!("a record {opcode:#x} in a chunk")));
        }
        let start = self.chunk.start + HEAD;
        self.chunk.start = start + length;
        Ok(Some((opcode, start..start + length)))
    }

    fn in_file(&mut self) -> Result<Option<(u8, Range<usize>)>, LogError> {
        loop {
            let crc = self.source.crc.clone();
            self.read_all(HEAD as u64)?;
            self.chunk_end = 0;
            let opcode = self.buffer[0];
            let length = u64::from_le_bytes(self.buffer[1..HEAD].try_into().expect("8 bytes"));
            if opcode == 0 {
                return Err(self.zeroed()?);
            }
            match (opcode, self.is_in_summary) {
                (op::CHUNK, false) => {
                    self.chunk_end = self.source.position.saturating_add(length);
                    self.read_chunk(length)?;
                    if let Some(found) = self.in_chunk()? {
                        return Ok(Some(found));
                    }
                }
                (op::DATA_END, false) => {
                    self.read_all(length)?;
                    let saved = Fields(&self.buffer).u32();
                    let saved = saved.map_err(|what| self.damaged(what))?;
                    self.compare(saved, crc)?;
                    self.source.crc = Hasher::new();
                    self.is_in_summary = true;
                }
                (op::FOOTER, true) => {
                    self.footer(length)?;
                    return Ok(None);
                }
                // The summary only repeats earlier records.
                (op::HEADER, false) | (op::SCHEMA..=op::SUMMARY_OFFSET, true) => {
                    self.read_all(length)?;
                }
                (op::MESSAGE_INDEX, false) => {
                    self.read_all(length)?;
                    let mut fields = Fields(&self.buffer);
                    let entries = fields.u16().and_then(|_| fields.u32());
                    if entries != Ok(fields.0.len() as u32) {
                        return Err(self.damaged("an index of messages has a wrong length"));
                    }
                }
                (op::SCHEMA | op::CHANNEL | op::MESSAGE | op::ATTACHMENT | op::METADATA, false) => {
                    self.read_all(length)?;
                    return Ok(Some((opcode, 0..self.buffer.len())));
                }
                _ => return Err(self.damaged(format!("a record {opcode:#x}"))),
            }
        }
    }

    /// Reads a chunk of `length` bytes and decodes it.
    fn read_chunk(&mut self, length: u64) -> Result<(), LogError> {
        // Two times, size, check sum, length of the compression's name.
        self.read_all(32)?;
        let number = |at: usize| self.buffer[at..at + 4].try_into().expect("4 bytes");
        let (crc, name) = [number(24), number(28)].map(u32::from_le_bytes).into();
        let size = u64::from_le_bytes(self.buffer[16..24].try_into().expect("8 bytes"));
        if ![0, 4].contains(&name) {
            return Err(self.damaged("a chunk of another compression"));
        }
        self.read_all(u64::from(name) + 8)?;
        let (name, packed) = self.buffer.split_at(name as usize);
        let packed = u64::from_le_bytes(packed.try_into().expect("8 bytes"));
        let is_zstd = name == b"zstd";
        if !is_zstd && !name.is_empty() {
            return Err(self.damaged("a chunk of another compression"));
        }
        if (40 + name.len() as u64).checked_add(packed) != Some(length) {
            return Err(self.damaged("a chunk of a wrong length"));
        }
        self.check_left(packed)?;
        let most = SMALL + EXPANSION.saturating_mul(self.source.position + packed);
        self.decoded = self.decoded.saturating_add(size);
        if self.decoded > most {
            return Err(self.damaged(format!("a chunk claims {size} bytes in {packed}")));
        }
        self.decode(packed, size, is_zstd)?;
        if crc != 0 && crc != crc32fast::hash(&self.buffer) {
            return Err(self.damaged("the check sum of a chunk is wrong"));
        }
        self.chunk = 0..self.buffer.len();
        Ok(())
    }

    /// Decodes the next `packed` bytes of the file, which must give `size` bytes.
    fn decode(&mut self, packed: u64, size: u64, is_zstd: bool) -> Result<(), LogError> {
        self.buffer.clear();
        let mut input = (&mut self.source).take(packed);
        let mut unpack = || -> io::Result<()> {
            // One byte more, to detect a chunk that is too long.
            if !is_zstd {
                return input.read_to_end(&mut self.buffer).map(drop);
            }
            let mut decoder = zstd::stream::read::Decoder::with_buffer(&mut input)?;
            decoder.window_log_max(WINDOW_LOG)?;
            decoder.take(size + 1).read_to_end(&mut self.buffer)?;
            Ok(())
        };
        let unpacked = unpack();
        let rest = input.limit();
        match unpacked {
            // The decoder passes on errors of the file; its own errors have no number.
            Err(error) if error.raw_os_error().is_some() => {
                Err(FileError::new(&self.path, "read")(error).into())
            }
            Err(error) => Err(self.damaged(format!("a chunk: {error}"))),
            Ok(()) if self.buffer.len() as u64 != size || rest != 0 => {
                Err(self.damaged("a chunk is shorter or longer than it claims"))
            }
            Ok(()) => Ok(()),
        }
    }

    /// Reads the footer and what must follow.
    fn footer(&mut self, length: u64) -> Result<(), LogError> {
        if length != 20 {
            return Err(self.damaged("a footer of a wrong length"));
        }
        self.read_all(16)?;
        let crc = self.source.crc.clone();
        self.read_all(4)?;
        let saved = u32::from_le_bytes(self.buffer[..].try_into().expect("4 bytes"));
        self.compare(saved, crc)?;
        self.read_all(mcap::MAGIC.len() as u64)?;
        if self.buffer != mcap::MAGIC {
            return Err(self.damaged("its last bytes are wrong"));
        }
        self.read(1)?;
        match self.buffer.is_empty() {
            true => Ok(()),
            false => Err(self.damaged("bytes after its end")),
        }
    }

    fn compare(&self, saved: u32, crc: Hasher) -> Result<(), LogError> {
        // Zero: no check sum.
        match saved == 0 || saved == crc.finalize() {
            true => Ok(()),
            false => Err(self.damaged("the check sum of a section is wrong")),
        }
    }

    /// Reads exactly `count` bytes into the buffer.
    fn read_all(&mut self, count: u64) -> Result<(), LogError> {
        self.check_left(count)?;
        if count > RECORD {
            return Err(self.damaged(format!("a record claims {count} bytes")));
        }
        self.read(count)?;
        if self.buffer.len() as u64 != count {
            return Err(self.cut_off());
        }
        Ok(())
    }

    /// Fails if the file has less than `count` bytes left.
    fn check_left(&mut self, count: u64) -> Result<(), LogError> {
        match count > self.length.saturating_sub(self.source.position) {
            true => Err(self.cut_off()),
            false => Ok(()),
        }
    }

    /// Reads up to `count` bytes into the buffer, less at the end of the file.
    fn read(&mut self, count: u64) -> Result<(), LogError> {
        self.buffer.clear();
        let read = (&mut self.source).take(count).read_to_end(&mut self.buffer);
        read.map_err(FileError::new(&self.path, "read"))?;
        Ok(())
    }

    /// The error for zeros in place of a record.
    fn zeroed(&mut self) -> Result<LogError, LogError> {
        let zeros = only_zeros(&mut self.source).map_err(FileError::new(&self.path, "read"))?;
        self.is_cut_off = zeros && self.buffer.iter().all(|byte| *byte == 0);
        Ok(self.damaged(match self.is_cut_off {
            true => "its end is only zeros",
            false => "a record 0x0",
        }))
    }

    fn cut_off(&mut self) -> LogError {
        self.is_cut_off = true;
        self.damaged("it ends too early")
    }

    fn damaged(&self, what: impl Into<String>) -> LogError {
        LogError::Damaged {
            path: self.path.clone(),
            what: what.into(),
        }
    }
}

/// Whether the rest of `source` is only zeros.
pub fn only_zeros(source: &mut impl BufRead) -> io::Result<bool> {
    loop {
        let block = match source.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        if block.is_empty() {
            return Ok(true);
        }
        if block.iter().any(|byte| *byte != 0) {
            return Ok(false);
        }
        let count = block.len();
        source.consume(count);
    }
}
