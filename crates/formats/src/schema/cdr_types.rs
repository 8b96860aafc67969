//! Types of messages in CDR, the encoding of DDS and ROS 2.

use super::limits::MAX_DEPTH;

/// Number of a structure among those of a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StructId(pub(super) usize);

/// Type of a value.
#[derive(Debug, Clone, PartialEq)]
pub enum CdrType {
    /// Number of a fixed size.
    Number(Number),
    /// Text: its length with the final zero, then its bytes.
    Text,
    /// Structure.
    Struct(StructId),
    /// Fixed number of values.
    Array(Box<CdrType>, usize),
    /// Number of values, then these.
    Sequence(Box<CdrType>),
    /// 32-bit flag, then the value if the flag is 1.
    Optional(Box<CdrType>),
    /// Something that is not read; neither is what comes after it.
    Opaque,
}

/// Kind of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// Truth value, one byte.
    Bool,
    /// Unsigned number of 1, 2, 4 or 8 bytes.
    Unsigned(usize),
    /// Signed number of 1, 2, 4 or 8 bytes.
    Signed(usize),
    /// Floating-point number of 4 or 8 bytes.
    Float(usize),
}

impl Number {
    /// Returns its size, bytes.
    pub fn size(self) -> usize {
        match self {
            Self::Bool => 1,
            Self::Unsigned(size) | Self::Signed(size) | Self::Float(size) => size,
        }
    }

    /// Returns the number that ROS 2 calls by a name.
    pub fn of_ros(name: &str) -> Option<Self> {
        Some(match name {
            "bool" | "boolean" => Self::Bool,
            "byte" | "char" | "uint8" | "octet" => Self::Unsigned(1),
            "int8" => Self::Signed(1),
            "uint16" => Self::Unsigned(2),
            "int16" => Self::Signed(2),
            "uint32" => Self::Unsigned(4),
            "int32" => Self::Signed(4),
            "uint64" => Self::Unsigned(8),
            "int64" => Self::Signed(8),
            "float32" | "float" => Self::Float(4),
            "float64" | "double" => Self::Float(8),
            _ => return None,
        })
    }

    /// Returns the number that Rust calls by a name.
    pub fn of_rust(name: &str) -> Option<Self> {
        Some(match name {
            "bool" => Self::Bool,
            "u8" => Self::Unsigned(1),
            "i8" => Self::Signed(1),
            "u16" => Self::Unsigned(2),
            "i16" => Self::Signed(2),
            "u32" => Self::Unsigned(4),
            "i32" => Self::Signed(4),
            "u64" => Self::Unsigned(8),
            "i64" => Self::Signed(8),
            "f32" => Self::Float(4),
            "f64" => Self::Float(8),
            _ => return None,
        })
    }
}

/// Field of a structure.
#[derive(Debug, Clone, PartialEq)]
pub struct CdrField {
    /// Name of the field.
    pub name: String,
    /// Type of its value.
    pub kind: CdrType,
}

/// Definition of a message with all structures that it uses.
#[derive(Debug, Clone, PartialEq)]
pub struct CdrTypes {
    pub(super) structs: Vec<Vec<CdrField>>,
    pub(super) root: StructId,
}

impl CdrTypes {
    /// Returns the fields of a structure.
    pub fn fields(&self, id: StructId) -> &[CdrField] {
        self.structs.get(id.0).map_or(&[], Vec::as_slice)
    }

    /// Returns the fields of a structure, or of the values of an array or sequence.
    pub(super) fn fields_within<'a>(&'a self, mut kind: &'a CdrType) -> Option<&'a [CdrField]> {
        for _ in 0..MAX_DEPTH {
            match kind {
                CdrType::Struct(id) => return Some(self.fields(*id)),
                CdrType::Array(inner, _) | CdrType::Sequence(inner) | CdrType::Optional(inner) => {
                    kind = inner;
                }
                _ => return None,
            }
        }
        None
    }
}
