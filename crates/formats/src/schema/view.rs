//! Value in a message, whatever its encoding.

use std::borrow::Cow;

use super::{cdr::CdrView, json::JsonView, protobuf::ProtobufView};

/// Most numbers that are read of an array: calibrations have a dozen, robots some dozens of joints.
const MAX_NUMBERS: usize = 4096;

/// Value in a message, not copied. Every method returns `None` where the value is of another kind or the message is damaged.
#[derive(Debug, Clone, Copy)]
pub enum View<'a> {
    /// Value in CDR.
    Cdr(CdrView<'a>),
    /// Value in JSON.
    Json(JsonView<'a>),
    /// Value in protobuf.
    Protobuf(ProtobufView<'a>),
}

impl<'a> View<'a> {
    /// Returns a field's value.
    pub fn field(&self, name: &str) -> Option<Self> {
        match self {
            Self::Cdr(view) => view.field(name).map(Self::Cdr),
            Self::Json(view) => view.field(name).map(Self::Json),
            Self::Protobuf(view) => view.field(name).map(Self::Protobuf),
        }
    }

    /// Returns the value of the first of some fields that is there: formats differ in names only.
    pub fn any_field(&self, names: &[&str]) -> Option<Self> {
        names.iter().find_map(|name| self.field(name))
    }

    /// Returns a number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Cdr(view) => view.number(),
            Self::Json(view) => view.number(),
            Self::Protobuf(view) => view.number(),
        }
    }

    /// Returns a whole number.
    pub fn integer(&self) -> Option<i64> {
        match self {
            Self::Cdr(view) => view.integer(),
            Self::Json(view) => view.integer(),
            Self::Protobuf(view) => view.integer(),
        }
    }

    /// Returns a text.
    pub fn text(&self) -> Option<Cow<'a, str>> {
        match self {
            Self::Cdr(view) => view.text(),
            Self::Json(view) => view.text(),
            Self::Protobuf(view) => view.text(),
        }
    }

    /// Returns bytes.
    pub fn bytes(&self) -> Option<Cow<'a, [u8]>> {
        match self {
            Self::Cdr(view) => view.bytes(),
            Self::Json(view) => view.bytes(),
            Self::Protobuf(view) => view.bytes(),
        }
    }

    /// Hands over the values of an array one after the other.
    pub fn each(&self, visit: &mut dyn FnMut(Self)) -> Option<()> {
        match self {
            Self::Cdr(view) => view.each(&mut |view| visit(Self::Cdr(view))),
            Self::Json(view) => view.each(&mut |view| visit(Self::Json(view))),
            Self::Protobuf(view) => view.each(&mut |view| visit(Self::Protobuf(view))),
        }
    }

    /// Returns the numbers of an array; `None` also if there are more than 4096.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        let mut numbers = Vec::new();
        let mut is_whole = true;
        self.each(&mut |view| match view.number() {
            Some(number) if numbers.len() < MAX_NUMBERS => numbers.push(number),
            _ => is_whole = false,
        })?;
        is_whole.then_some(numbers)
    }
}
