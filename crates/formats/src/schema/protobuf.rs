//! Messages in protobuf, read where they lie, by the descriptors (`FileDescriptorSet`) that come with them.

use std::{borrow::Cow, collections::HashMap, str};

use super::wire::{WireFields, WireValue, fixed32, fixed64, varint};

/// Depth to which descriptors may be nested.
const MAX_NESTING: usize = 16;

/// Messages that are described, by their full names.
#[derive(Debug)]
pub struct ProtobufTypes {
    messages: HashMap<String, Vec<ProtobufField>>,
    root: String,
}

/// Field of a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProtobufField {
    /// Name of the field.
    pub name: String,
    number: u32,
    is_repeated: bool,
    kind: FieldKind,
}

/// Type of a field.
#[derive(Debug, Clone, PartialEq, Eq)]
enum FieldKind {
    Double,
    Float,
    /// Number of a variable length: negative ones take ten bytes.
    Varint,
    /// Number of a variable length whose last bit is its sign.
    ZigZag,
    Fixed64,
    Fixed32,
    Text,
    Bytes,
    Message(String),
}

impl ProtobufTypes {
    /// Reads a set of descriptors; `None` if the named message is not in it.
    pub fn read(type_name: &str, set: &[u8]) -> Option<Self> {
        let mut messages = HashMap::new();
        for file in parts(set, 1) {
            let package = text(file, 2).unwrap_or_default();
            for message in parts(file, 4) {
                collect(&mut messages, package, message, 0);
            }
        }
        let root = type_name.trim_start_matches('.').to_owned();
        messages.contains_key(&root).then_some(Self { messages, root })
    }

    /// Opens a message.
    pub fn open<'a>(&'a self, bytes: &'a [u8]) -> ProtobufView<'a> {
        ProtobufView { types: self, kind: ViewKind::Message(self.fields(&self.root), bytes) }
    }

    /// Returns the fields that messages have.
    pub fn root_fields(&self) -> &[ProtobufField] {
        self.fields(&self.root)
    }

    fn fields(&self, name: &str) -> &[ProtobufField] {
        self.messages.get(name).map_or(&[], Vec::as_slice)
    }

    /// Returns the fields of a field's messages, if it has messages.
    pub(super) fn fields_within(&self, field: &ProtobufField) -> Option<&[ProtobufField]> {
        match &field.kind {
            FieldKind::Message(name) => Some(self.fields(name)),
            _ => None,
        }
    }
}

/// Returns all messages in the field of a number.
fn parts(bytes: &[u8], wanted: u32) -> impl Iterator<Item = &[u8]> {
    WireFields(bytes).filter_map(move |(number, value)| match value {
        WireValue::Bytes(bytes) if number == wanted => Some(bytes),
        _ => None,
    })
}

fn text(bytes: &[u8], wanted: u32) -> Option<&str> {
    parts(bytes, wanted).last().and_then(|bytes| str::from_utf8(bytes).ok())
}

fn collect(messages: &mut HashMap<String, Vec<ProtobufField>>, scope: &str, message: &[u8], depth: usize) {
    let Some(name) = text(message, 1).filter(|_| depth < MAX_NESTING) else { return };
    let name = if scope.is_empty() { name.to_owned() } else { format!("{scope}.{name}") };
    for nested in parts(message, 3) {
        collect(messages, &name, nested, depth + 1);
    }
    messages.insert(name, parts(message, 2).filter_map(field_of).collect());
}

/// Reads the descriptor of a field; `None` if it is damaged or of a kind that is not read.
fn field_of(descriptor: &[u8]) -> Option<ProtobufField> {
    let number_in = |wanted: u32| {
        WireFields(descriptor).find_map(|(number, value)| match value {
            WireValue::Varint(value) if number == wanted => Some(value),
            _ => None,
        })
    };
    let kind = match number_in(5)? {
        1 => FieldKind::Double,
        2 => FieldKind::Float,
        3 | 4 | 5 | 8 | 13 | 14 => FieldKind::Varint,
        6 | 16 => FieldKind::Fixed64,
        7 | 15 => FieldKind::Fixed32,
        9 => FieldKind::Text,
        11 => FieldKind::Message(text(descriptor, 6)?.trim_start_matches('.').to_owned()),
        12 => FieldKind::Bytes,
        17 | 18 => FieldKind::ZigZag,
        _ => return None,
    };
    Some(ProtobufField {
        name: text(descriptor, 1)?.to_owned(),
        number: u32::try_from(number_in(3)?).ok()?,
        is_repeated: number_in(4) == Some(3),
        kind,
    })
}

/// Value in a message. A field that is not there has its default, as protobuf has it.
#[derive(Debug, Clone, Copy)]
pub struct ProtobufView<'a> {
    types: &'a ProtobufTypes,
    kind: ViewKind<'a>,
}

#[derive(Debug, Clone, Copy)]
enum ViewKind<'a> {
    Message(&'a [ProtobufField], &'a [u8]),
    Value(&'a FieldKind, Option<WireValue<'a>>),
    /// Repeated field, in the message that holds it.
    Repeated(&'a ProtobufField, &'a [u8]),
}

impl<'a> ProtobufView<'a> {
    /// Returns a field's value.
    pub fn field(&self, name: &str) -> Option<Self> {
        let ViewKind::Message(fields, bytes) = self.kind else { return None };
        let field = fields.iter().find(|field| field.name == name)?;
        let kind = if field.is_repeated {
            ViewKind::Repeated(field, bytes)
        } else {
            let values = WireFields(bytes).filter(|(number, _)| *number == field.number);
            self.value(&field.kind, values.last().map(|(_, value)| value))?
        };
        Some(Self { kind, ..*self })
    }

    fn value(&self, kind: &'a FieldKind, value: Option<WireValue<'a>>) -> Option<ViewKind<'a>> {
        match (kind, value) {
            (FieldKind::Message(name), None) => Some(ViewKind::Message(self.types.fields(name), &[])),
            (FieldKind::Message(name), Some(WireValue::Bytes(bytes))) => {
                Some(ViewKind::Message(self.types.fields(name), bytes))
            }
            (FieldKind::Message(_), Some(_)) => None,
            (kind, value) => Some(ViewKind::Value(kind, value)),
        }
    }

    /// Returns a number.
    pub fn number(&self) -> Option<f64> {
        let ViewKind::Value(kind, value) = self.kind else { return None };
        match (kind, value) {
            (FieldKind::Double | FieldKind::Float, None) => Some(0.0),
            (FieldKind::Double, Some(WireValue::Fixed64(bits))) => Some(f64::from_bits(bits)),
            (FieldKind::Float, Some(WireValue::Fixed32(bits))) => Some(f64::from(f32::from_bits(bits))),
            _ => self.integer().map(|value| value as f64),
        }
    }

    /// Returns a whole number.
    pub fn integer(&self) -> Option<i64> {
        let ViewKind::Value(kind, value) = self.kind else { return None };
        match (kind, value) {
            (FieldKind::Varint | FieldKind::ZigZag | FieldKind::Fixed64 | FieldKind::Fixed32, None) => {
                Some(0)
            }
            (FieldKind::Varint, Some(WireValue::Varint(value))) => Some(value as i64),
            (FieldKind::ZigZag, Some(WireValue::Varint(value))) => {
                Some((value >> 1) as i64 ^ -((value & 1) as i64))
            }
            (FieldKind::Fixed64, Some(WireValue::Fixed64(value))) => Some(value as i64),
            (FieldKind::Fixed32, Some(WireValue::Fixed32(value))) => Some(i64::from(value as i32)),
            _ => None,
        }
    }

    /// Returns a text.
    pub fn text(&self) -> Option<Cow<'a, str>> {
        match self.kind {
            ViewKind::Value(FieldKind::Text, None) => Some(Cow::Borrowed("")),
            ViewKind::Value(FieldKind::Text, Some(WireValue::Bytes(bytes))) => {
                str::from_utf8(bytes).ok().map(Cow::Borrowed)
            }
            _ => None,
        }
    }

    /// Returns bytes.
    pub fn bytes(&self) -> Option<Cow<'a, [u8]>> {
        match self.kind {
            ViewKind::Value(FieldKind::Bytes, None) => Some(Cow::Borrowed(&[])),
            ViewKind::Value(FieldKind::Bytes, Some(WireValue::Bytes(bytes))) => Some(Cow::Borrowed(bytes)),
            _ => None,
        }
    }

    /// Hands over the values of a repeated field one after the other.
    pub fn each(&self, visit: &mut dyn FnMut(Self)) -> Option<()> {
        let ViewKind::Repeated(field, bytes) = self.kind else { return None };
        for (_, value) in WireFields(bytes).filter(|(number, _)| *number == field.number) {
            match (&field.kind, value) {
                (FieldKind::Message(_) | FieldKind::Text | FieldKind::Bytes, value) => {
                    visit(Self { kind: self.value(&field.kind, Some(value))?, ..*self });
                }
                (kind, WireValue::Bytes(mut packed)) => {
                    while !packed.is_empty() {
                        let value = unpacked(kind, &mut packed)?;
                        visit(Self { kind: ViewKind::Value(kind, Some(value)), ..*self });
                    }
                }
                (kind, value) => visit(Self { kind: ViewKind::Value(kind, Some(value)), ..*self }),
            }
        }
        Some(())
    }
}

/// Reads one of several numbers that lie together.
fn unpacked<'a>(kind: &FieldKind, packed: &mut &'a [u8]) -> Option<WireValue<'a>> {
    match kind {
        FieldKind::Double | FieldKind::Fixed64 => fixed64(packed).map(WireValue::Fixed64),
        FieldKind::Float | FieldKind::Fixed32 => fixed32(packed).map(WireValue::Fixed32),
        _ => varint(packed).map(WireValue::Varint),
    }
}
