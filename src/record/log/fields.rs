//! The fields of an MCAP record, little-endian. A declared length is limited by the bytes left.

use std::collections::BTreeMap;

const TOO_SHORT: &str = "a record ends inside a field";

/// The part of a record that has not been read yet.
pub struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    pub fn bytes(&mut self, count: u64) -> Result<&'a [u8], &'static str> {
        let count = usize::try_from(count).map_err(|_| TOO_SHORT)?;
        let (bytes, rest) = self.0.split_at_checked(count).ok_or(TOO_SHORT)?;
        self.0 = rest;
        Ok(bytes)
    }

    pub fn u8(&mut self) -> Result<u8, &'static str> {
        self.array().map(u8::from_le_bytes)
    }

    pub fn u16(&mut self) -> Result<u16, &'static str> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, &'static str> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, &'static str> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn text(&mut self) -> Result<String, &'static str> {
        let length = self.u32()?;
        let bytes = self.bytes(length.into())?;
        let text = std::str::from_utf8(bytes).map_err(|_| "a text is not UTF-8")?;
        Ok(text.to_string())
    }

    /// Names and texts; no name twice.
    pub fn map(&mut self) -> Result<BTreeMap<String, String>, &'static str> {
        let length = self.u32()?;
        let mut entries = Fields(self.bytes(length.into())?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            if map.insert(entries.text()?, entries.text()?).is_some() {
                return Err("a name appears twice");
            }
        }
        Ok(map)
    }

    /// Fails if bytes are left.
    pub fn end(self) -> Result<(), &'static str> {
        match self.0.is_empty() {
            true => Ok(()),
            false => Err("a record is longer than its fields"),
        }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], &'static str> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(TOO_SHORT)?;
        self.0 = rest;
        Ok(*bytes)
    }
}
