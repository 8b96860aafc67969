//! Fields that messages have, by which it is told what they are.

use serde_json::Value;

use super::{
    cdr_types::{CdrField, CdrTypes},
    protobuf::{ProtobufField, ProtobufTypes},
};

/// Fields of a message or of a part of it.
#[derive(Debug, Clone, Copy)]
pub enum Shape<'a> {
    /// Fields in CDR.
    Cdr(&'a CdrTypes, &'a [CdrField]),
    /// JSON schema.
    Json(&'a Value),
    /// Fields in protobuf.
    Protobuf(&'a ProtobufTypes, &'a [ProtobufField]),
    /// Nothing but the name of the type.
    Named(&'a str),
    /// Nothing.
    Unknown,
}

impl Shape<'_> {
    /// Returns whether messages have a field, given by the names on the way to it, with dots between; the elements of arrays and
    /// sequences are on the way as if there were one.
    pub fn has(&self, path: &str) -> bool {
        let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
        match self.within(first) {
            None => false,
            Some(inner) => rest.is_none_or(|rest| inner.is_some_and(|inner| inner.has(rest))),
        }
    }

    /// Returns the fields within a field; `None` if there is no such field, `Some(None)` if it has none.
    fn within(&self, name: &str) -> Option<Option<Self>> {
        match *self {
            Self::Cdr(types, fields) => {
                let field = fields.iter().find(|field| field.name == name)?;
                Some(types.fields_within(&field.kind).map(|fields| Self::Cdr(types, fields)))
            }
            Self::Protobuf(types, fields) => {
                let field = fields.iter().find(|field| field.name == name)?;
                Some(types.fields_within(field).map(|fields| Self::Protobuf(types, fields)))
            }
            Self::Json(schema) => {
                let field = schema.get("properties")?.get(name)?;
                Some(Some(Self::Json(field.get("items").unwrap_or(field))))
            }
            Self::Named(_) | Self::Unknown => None,
        }
    }

    /// Returns the type's name where nothing else is known.
    pub fn name_alone(&self) -> Option<&str> {
        match self {
            Self::Named(name) => Some(name),
            _ => None,
        }
    }
}
