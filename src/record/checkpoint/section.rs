//! One array as bytes: little-endian, shuffled by blocks, zstd.
//!
//! Shuffling puts the sign and exponent bytes of neighbours side by side, where they compress; the
//! noise of the mantissa's last bytes is separate. A block has 131072 elements, so that each of
//! its byte planes is exactly one zstd block of 128 KiB, and work space is 2 MiB for any length of
//! the array. In reading, memory grows as data are decoded, not with the declared length.

use std::io::{self, Read, Write};

use sha2::{Digest as _, Sha256};
use zstd::stream::write::Encoder;

use super::Array;
use super::codec::{ElementType, Section};
use crate::record::digest::Digest;

const BLOCK: usize = 128 << 10;

/// zstd's smallest block (4 bytes) contains at most 128 KiB: no frame expands more.
const LARGEST_EXPANSION: u64 = 32 << 10;

/// Most bytes that are added to what cannot be compressed, besides a sixty-fourth.
const OVERHEAD: u64 = 64 << 10;

/// Largest permitted window of a frame, log2 of bytes: that of level 19.
const WINDOW_LOG: u32 = 23;

/// The end of a compressed array.
pub struct Packed {
    pub bytes: Vec<u8>,
    pub digest: Digest,
}

/// Why a section does not agree with the table.
pub enum Unreadable {
    TooLarge(String),
    Corrupt(String),
}

/// Numbers of fixed width.
trait Element: Copy {
    const SIZE: usize;
    /// Writes `values` to `bytes`, little-endian.
    fn to_bytes(values: &[Self], bytes: &mut [u8]);
    fn from_bytes(bytes: &[u8], values: &mut Vec<Self>);
}

macro_rules! element {
    ($($number:ty),*) => {$(
        impl Element for $number {
            const SIZE: usize = size_of::<$number>();

            fn to_bytes(values: &[Self], bytes: &mut [u8]) {
                for (value, bytes) in values.iter().zip(bytes.chunks_exact_mut(Self::SIZE)) {
                    bytes.copy_from_slice(&value.to_le_bytes());
                }
            }

            fn from_bytes(bytes: &[u8], values: &mut Vec<Self>) {
                values.extend(bytes.chunks_exact(Self::SIZE).map(|bytes| {
                    <$number>::from_le_bytes(bytes.try_into().expect("exact chunk"))
                }));
            }
        }
    )*};
}
element!(f64, f32, u64, u32, u8);

/// Type of the elements of `array`.
pub fn element(array: &Array) -> ElementType {
    match array {
        Array::F64(_) => ElementType::F64,
        Array::F32(_) => ElementType::F32,
        Array::U64(_) => ElementType::U64,
        Array::U32(_) => ElementType::U32,
        Array::U8(_) => ElementType::U8,
    }
}

/// SHA-256 of the little-endian bytes.
pub fn digest(array: &Array) -> Digest {
    match array {
        Array::F64(values) => digest_of(values),
        Array::F32(values) => digest_of(values),
        Array::U64(values) => digest_of(values),
        Array::U32(values) => digest_of(values),
        Array::U8(values) => digest_of(values),
    }
}

/// Compresses and hashes an array whose elements come in parts.
pub struct Packer {
    encoder: Encoder<'static, Vec<u8>>,
    hasher: Sha256,
    /// Bytes of an element, and of a whole block.
    size: usize,
    block: usize,
    /// Bytes of the block that is not full yet, and room to shuffle it.
    plain: Vec<u8>,
    planes: Vec<u8>,
}

impl Packer {
    /// For `count` elements.
    pub fn new(element: ElementType, count: usize, level: i32) -> io::Result<Self> {
        let size = element.size();
        let block = BLOCK.min(count.max(1)) * size;
        let mut encoder = Encoder::new(Vec::new(), level)?;
        encoder.include_checksum(true)?;
        encoder.set_pledged_src_size(Some((count * size) as u64))?;
        Ok(Packer {
            encoder,
            hasher: Sha256::new(),
            size,
            block,
            plain: Vec::with_capacity(block),
            planes: vec![0; block],
        })
    }

    /// Adds the elements of `array`.
    pub fn add(&mut self, array: &Array) -> io::Result<()> {
        match array {
            Array::F64(values) => self.add_values(values),
            Array::F32(values) => self.add_values(values),
            Array::U64(values) => self.add_values(values),
            Array::U32(values) => self.add_values(values),
            Array::U8(values) => self.add_values(values),
        }
    }

    fn add_values<T: Element>(&mut self, mut values: &[T]) -> io::Result<()> {
        while !values.is_empty() {
            let begun = self.plain.len();
            let count = ((self.block - begun) / T::SIZE).min(values.len());
            let (here, rest) = values.split_at(count);
            self.plain.resize(begun + count * T::SIZE, 0);
            T::to_bytes(here, &mut self.plain[begun..]);
            values = rest;
            if self.plain.len() == self.block {
                self.close_block()?;
            }
        }
        Ok(())
    }

    fn close_block(&mut self) -> io::Result<()> {
        let planes = &mut self.planes[..self.plain.len()];
        self.hasher.update(&self.plain);
        shuffle(&self.plain, planes, self.size);
        self.encoder.write_all(planes)?;
        self.plain.clear();
        Ok(())
    }

    /// Takes the bytes that are ready.
    pub fn ready(&mut self) -> Vec<u8> {
        std::mem::take(self.encoder.get_mut())
    }

    /// What is left.
    pub fn finish(mut self) -> io::Result<Packed> {
        self.close_block()?;
        Ok(Packed {
            bytes: self.encoder.finish()?,
            digest: Digest(self.hasher.finalize().into()),
        })
    }
}

/// Decompresses `bytes` to exactly the size of `section` and checks the hash.
pub fn unpack(section: &Section, bytes: &[u8]) -> Result<Array, Unreadable> {
    Ok(match section.element {
        ElementType::F64 => Array::F64(unpack_values(section, bytes)?),
        ElementType::F32 => Array::F32(unpack_values(section, bytes)?),
        ElementType::U64 => Array::U64(unpack_values(section, bytes)?),
        ElementType::U32 => Array::U32(unpack_values(section, bytes)?),
        ElementType::U8 => Array::U8(unpack_values(section, bytes)?),
    })
}

/// Number of bytes that the table declares, if the compressed bytes can contain them.
pub fn length(section: &Section) -> Result<u64, String> {
    let length = section.count.checked_mul(section.element.size() as u64);
    let most = section.compressed.saturating_mul(LARGEST_EXPANSION);
    let most_packed = |length: u64| length.saturating_add(length / 64 + OVERHEAD);
    match length {
        Some(length) if length <= most && section.compressed <= most_packed(length) => Ok(length),
        _ => Err(format!(
            "array {:?} of {} elements in {} bytes",
            section.name, section.count, section.compressed
        )),
    }
}

fn digest_of<T: Element>(values: &[T]) -> Digest {
    let mut hasher = Sha256::new();
    let mut bytes = vec![0; BLOCK.min(values.len()) * T::SIZE];
    for block in values.chunks(BLOCK) {
        let bytes = &mut bytes[..block.len() * T::SIZE];
        T::to_bytes(block, bytes);
        hasher.update(bytes);
    }
    Digest(hasher.finalize().into())
}

fn unpack_values<T: Element>(section: &Section, bytes: &[u8]) -> Result<Vec<T>, Unreadable> {
    let corrupt = |error: io::Error| Unreadable::Corrupt(error.to_string());
    length(section).map_err(Unreadable::TooLarge)?;
    let count = section.count as usize;
    let mut values = Vec::new();
    let mut decoder = zstd::stream::read::Decoder::with_buffer(bytes)
        .map_err(corrupt)?
        .single_frame();
    decoder.window_log_max(WINDOW_LOG).map_err(corrupt)?;
    let mut hasher = Sha256::new();
    let mut plain = vec![0; BLOCK.min(count) * T::SIZE];
    let mut planes = plain.clone();
    while values.len() < count {
        let left = count - values.len();
        let here = BLOCK.min(left) * T::SIZE;
        decoder.read_exact(&mut planes[..here]).map_err(corrupt)?;
        unshuffle(&planes[..here], &mut plain[..here], T::SIZE);
        hasher.update(&plain[..here]);
        if values.len() == values.capacity() {
            // Doubles, at most to the size of the array.
            let more = values.len().max(BLOCK).min(left);
            let reserved = values.try_reserve_exact(more);
            reserved.map_err(|error| Unreadable::TooLarge(error.to_string()))?;
        }
        T::from_bytes(&plain[..here], &mut values);
    }
    // Further reading also makes zstd compare its checksum.
    let beyond = decoder.read(&mut [0]).map_err(corrupt)?;
    if beyond != 0 || !decoder.finish().is_empty() {
        return Err(Unreadable::Corrupt("longer than in its table".into()));
    }
    if <[u8; 32]>::from(hasher.finalize()) != section.digest {
        return Err(Unreadable::Corrupt("SHA-256 does not match".into()));
    }
    Ok(values)
}

/// `planes` = byte 0 of all elements, byte 1 of all ...
fn shuffle(plain: &[u8], planes: &mut [u8], size: usize) {
    let count = plain.len() / size;
    if count == 0 {
        return;
    }
    for (k, plane) in planes.chunks_exact_mut(count).enumerate() {
        for (byte, element) in plane.iter_mut().zip(plain.chunks_exact(size)) {
            *byte = element[k];
        }
    }
}

fn unshuffle(planes: &[u8], plain: &mut [u8], size: usize) {
    let count = plain.len() / size;
    if count == 0 {
        return;
    }
    for (k, plane) in planes.chunks_exact(count).enumerate() {
        for (byte, element) in plane.iter().zip(plain.chunks_exact_mut(size)) {
            element[k] = *byte;
        }
    }
}
