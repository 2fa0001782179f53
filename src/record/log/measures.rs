//! Numbers of a frame as a self-describing protobuf message: `coronet.Measures` of the scalars of
//! the solver, `coronet.Figures` of the shape of the liquid. One `double` field for each, after
//! `time_s` (the exact simulated time) and `time_after_contact_s` (NaN before the contact of the
//! drop, and where nothing meets). Viewers plot `/measures.kinetic_energy_J`.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

/// Name of the message of scalars.
pub const NAME: &str = "coronet.Measures";
/// Name of the message of figures.
pub const FIGURES: &str = "coronet.Figures";

const TIME: &str = "time_s";
const AFTER: &str = "time_after_contact_s";

/// Longest permitted descriptor, bytes: some thousand scalars. A parsed hostile one of empty fields
/// takes a hundred times its length.
const LONGEST: usize = 256 << 10;

/// protobuf wire type of a double.
const FIXED64: u64 = 1;

/// Names of the scalars, in the order of their field numbers from 3; fields 1 and 2 are the times.
#[derive(Clone, Debug, PartialEq)]
pub struct Schema {
    names: Vec<String>,
    /// Number of fields of times: logs of earlier versions have one.
    times: usize,
}

impl Schema {
    /// Schema for these scalars; their names must be valid for protobuf fields and different.
    pub fn new(scalars: &[(String, f64)]) -> Result<Self, String> {
        let names: Vec<_> = scalars.iter().map(|(name, _)| name.clone()).collect();
        for (index, name) in names.iter().enumerate() {
            let mut letters = name.chars();
            let first = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
            if !first || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
                return Err(format!("{name:?} is not a valid name of a scalar"));
            }
            if name == TIME || name == AFTER || names[..index].contains(name) {
                return Err(format!("scalar {name:?} appears twice"));
            }
        }
        Ok(Schema { names, times: 2 })
    }

    /// Whether `scalars` have these names in this order.
    pub fn fits(&self, scalars: &[(String, f64)]) -> bool {
        scalars.iter().map(|(name, _)| name).eq(&self.names)
    }

    /// The `FileDescriptorSet` that readers decode messages with; `name`: of the message.
    pub fn descriptor(&self, name: &str) -> Vec<u8> {
        let (package, short) = name.split_once('.').unwrap_or(("coronet", name));
        let times = [TIME, AFTER].into_iter();
        let names = times.chain(self.names.iter().map(String::as_str));
        let field = |(index, name): (usize, &str)| FieldDescriptorProto {
            name: Some(name.to_string()),
            number: Some(index as i32 + 1),
            label: Some(Label::Optional.into()),
            r#type: Some(Type::Double.into()),
            json_name: Some(name.to_string()),
            ..FieldDescriptorProto::default()
        };
        let message = DescriptorProto {
            name: Some(short.into()),
            field: names.enumerate().map(field).collect(),
            ..DescriptorProto::default()
        };
        let file = FileDescriptorProto {
            name: Some(format!("{package}/{short}.proto")),
            package: Some(package.into()),
            message_type: vec![message],
            syntax: Some("proto3".into()),
            ..FileDescriptorProto::default()
        };
        FileDescriptorSet { file: vec![file] }.encode_to_vec()
    }

    /// The schema that [`descriptor`](Self::descriptor) describes.
    pub fn parse(descriptor: &[u8]) -> Option<Self> {
        if descriptor.len() > LONGEST {
            return None;
        }
        let set = FileDescriptorSet::decode(descriptor).ok()?;
        let message = set
            .file
            .into_iter()
            .next()?
            .message_type
            .into_iter()
            .next()?;
        let mut names = message.field.into_iter().enumerate().map(|(index, field)| {
            let plain = field.number == Some(index as i32 + 1) && field.r#type() == Type::Double;
            field.name.filter(|_| plain)
        });
        if names.next()?? != TIME {
            return None;
        }
        let mut names = names.collect::<Option<Vec<String>>>()?;
        let times = match names.first() {
            Some(name) if name == AFTER => 2,
            _ => 1,
        };
        names.drain(..times - 1);
        Some(Schema { names, times })
    }

    /// One message; times in s from the start and from contact.
    pub fn encode(time: f64, after: Option<f64>, scalars: &[(String, f64)]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(10 * (scalars.len() + 2));
        let times = [time, after.unwrap_or(f64::NAN)].into_iter();
        let values = times.chain(scalars.iter().map(|(_, value)| *value));
        for (tag, value) in (1..).zip(values) {
            prost::encoding::double::encode(tag, &value, &mut bytes);
        }
        bytes
    }

    /// Time, s, and scalars of a message.
    pub fn decode(&self, mut bytes: &[u8]) -> Option<(f64, Vec<(String, f64)>)> {
        let mut values = vec![0.0; self.times + self.names.len()];
        while !bytes.is_empty() {
            let key = prost::encoding::decode_varint(&mut bytes).ok()?;
            let (value, rest) = bytes.split_first_chunk::<8>()?;
            let index = usize::try_from(key >> 3).ok()?.checked_sub(1)?;
            if key & 7 != FIXED64 {
                return None;
            }
            *values.get_mut(index)? = f64::from_le_bytes(*value);
            bytes = rest;
        }
        let scalars = values[self.times..].iter().copied();
        let scalars = self.names.iter().cloned().zip(scalars);
        Some((values[0], scalars.collect()))
    }
}
