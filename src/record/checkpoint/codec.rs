//! The header of a checkpoint file and its bytes.
//!
//! bincode's legacy layout (fixed-width little-endian integers, u64 lengths, u32 variants) is
//! frozen and has other implementations; only this module uses it. It is not self-describing: the
//! order of fields and variants below is the format.

use bincode::config::{self, Configuration, Fixint, Limit, LittleEndian};
use serde::{Deserialize, Serialize};

/// Version of the file format that this program writes.
pub const FORMAT_VERSION: u32 = 1;

/// Largest header, bytes, enough for ten thousand arrays. It also limits the lengths declared in a
/// header, so that a decoded one takes a few times this.
pub const HEADER_LIMIT: usize = 1 << 20;

/// Type of the elements of an array; the numbers are in files and digests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ElementType {
    /// 64-bit floating point.
    F64 = 0,
    /// 32-bit floating point.
    F32 = 1,
    /// 64-bit unsigned integer.
    U64 = 2,
    /// 32-bit unsigned integer.
    U32 = 3,
    /// 8-bit unsigned integer.
    U8 = 4,
}

impl ElementType {
    /// Bytes of one element.
    pub fn size(self) -> usize {
        match self {
            ElementType::F64 | ElementType::U64 => 8,
            ElementType::F32 | ElementType::U32 => 4,
            ElementType::U8 => 1,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub kind: String,
    pub time: f64,
    pub step: u64,
    pub scalars: Vec<(String, f64)>,
    pub texts: Vec<(String, String)>,
    pub sections: Vec<Section>,
}

/// One row of the section table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Section {
    pub name: String,
    pub element: ElementType,
    /// Number of elements.
    pub count: u64,
    /// Length in the file, bytes.
    pub compressed: u64,
    /// SHA-256 of the uncompressed little-endian bytes.
    pub digest: [u8; 32],
}

type Layout = Configuration<LittleEndian, Fixint, Limit<HEADER_LIMIT>>;

fn layout() -> Layout {
    config::legacy().with_limit::<HEADER_LIMIT>()
}

/// Bytes of a header, or the reason of a failure (too long).
pub fn encode(header: &Header) -> Result<Vec<u8>, String> {
    let bytes =
        bincode::serde::encode_to_vec(header, layout()).map_err(|error| error.to_string())?;
    if bytes.len() > HEADER_LIMIT {
        return Err(format!("{} bytes, limit {HEADER_LIMIT}", bytes.len()));
    }
    Ok(bytes)
}

/// Header of `bytes`, all of which it must use.
pub fn decode(bytes: &[u8]) -> Result<Header, String> {
    let (header, consumed) = bincode::serde::decode_from_slice::<Header, _>(bytes, layout())
        .map_err(|error| error.to_string())?;
    if consumed != bytes.len() {
        return Err(format!("{} bytes too many", bytes.len() - consumed));
    }
    Ok(header)
}
