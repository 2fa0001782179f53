//! The scalars of a frame as a self-describing protobuf message: `coronet.Measures`, one `double`
//! field for each scalar, `time_s` (the exact simulated time) first. Viewers plot
//! `/measures.kinetic_energy_J`.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

/// Name of the message.
pub const NAME: &str = "coronet.Measures";

const TIME: &str = "time_s";

/// Longest permitted descriptor, bytes: some thousand scalars. A parsed hostile one of empty fields
/// takes a hundred times its length.
const LONGEST: usize = 256 << 10;

/// protobuf wire type of a double.
const FIXED64: u64 = 1;

/// Names of the scalars, in the order of their field numbers from 2; field 1 is the time.
#[derive(Clone, Debug, PartialEq)]
pub struct Schema {
    names: Vec<String>,
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
            if name == TIME || names[..index].contains(name) {
                return Err(format!("scalar {name:?} appears twice"));
            }
        }
        Ok(Schema { names })
    }

    /// Whether `scalars` have these names in this order.
    pub fn fits(&self, scalars: &[(String, f64)]) -> bool {
        scalars.iter().map(|(name, _)| name).eq(&self.names)
    }

    /// The `FileDescriptorSet` that readers decode messages with.
    pub fn descriptor(&self) -> Vec<u8> {
        let names = std::iter::once(TIME).chain(self.names.iter().map(String::as_str));
        let field = |(index, name): (usize, &str)| FieldDescriptorProto {
            name: Some(name.to_string()),
            number: Some(index as i32 + 1),
            label: Some(Label::Optional.into()),
            r#type: Some(Type::Double.into()),
            json_name: Some(name.to_string()),
            ..FieldDescriptorProto::default()
        };
        let message = DescriptorProto {
            name: Some("Measures".into()),
            field: names.enumerate().map(field).collect(),
            ..DescriptorProto::default()
        };
        let file = FileDescriptorProto {
            name: Some("coronet/Measures.proto".into()),
            package: Some("coronet".into()),
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
        let names = names.collect::<Option<_>>()?;
        Some(Schema { names })
    }

    /// One message; `time` in s.
    pub fn encode(time: f64, scalars: &[(String, f64)]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(10 * (scalars.len() + 1));
        let values = std::iter::once(time).chain(scalars.iter().map(|(_, value)| *value));
        for (tag, value) in (1..).zip(values) {
            prost::encoding::double::encode(tag, &value, &mut bytes);
        }
        bytes
    }

    /// Time, s, and scalars of a message.
    pub fn decode(&self, mut bytes: &[u8]) -> Option<(f64, Vec<(String, f64)>)> {
        let mut values = vec![0.0; self.names.len() + 1];
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
        let scalars = self.names.iter().cloned().zip(values[1..].iter().copied());
        Some((values[0], scalars.collect()))
    }
}
