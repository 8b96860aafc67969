//! Definitions of messages, as logs carry them, and messages read by them: fields are found by name, nothing is copied.

mod builtin;
mod cdr;
mod cdr_types;
mod json;
mod limits;
mod protobuf;
mod ros2msg;
mod ros_z;
mod shape;
mod view;
mod wire;

use self::{cdr::CdrView, cdr_types::CdrTypes, json::JsonSchema, protobuf::ProtobufTypes};
pub use self::{ros2msg::complete as ros2_definition, shape::Shape, view::View};

/// Largest definition that is read, bytes: those of ROS 2's largest messages take some ten kilobytes.
const MAX_DEFINITION_BYTES: usize = 1 << 20;

/// Encoded definition of a topic's messages, as the log holds it.
#[derive(Debug, Clone, Copy)]
pub struct RawDefinition<'a> {
    /// Encoding of the messages: `cdr`, `json`, `protobuf`, `ros-z-cdr`.
    pub message_encoding: &'a str,
    /// Encoding of the definition: `ros2msg`, `ros2idl`, `jsonschema`, `protobuf`, `ros-z-schema-json`, or empty.
    pub schema_encoding: &'a str,
    /// Name of the messages' type, such as `sensor_msgs/msg/Image`.
    pub type_name: &'a str,
    /// Text or bytes of the definition; empty if the log has none.
    pub data: &'a [u8],
}

/// Definition of a topic's messages.
#[derive(Debug)]
pub struct Definition(Kind);

#[derive(Debug)]
enum Kind {
    Cdr(CdrTypes),
    Json(JsonSchema),
    Protobuf(ProtobufTypes),
    Unreadable(String),
}

impl Definition {
    /// Reads a definition. One that cannot be read is kept as such: its topic is listed, its messages are not read.
    pub fn read(raw: RawDefinition<'_>) -> Self {
        Self(Kind::read(raw).unwrap_or_else(Kind::Unreadable))
    }

    /// Returns why the messages cannot be read, if they cannot.
    pub fn fault(&self) -> Option<&str> {
        match &self.0 {
            Kind::Unreadable(reason) => Some(reason),
            _ => None,
        }
    }

    /// Returns the fields that messages have.
    pub fn shape(&self) -> Shape<'_> {
        match &self.0 {
            Kind::Cdr(types) => Shape::Cdr(types, types.fields(types.root)),
            Kind::Json(schema) => schema.schema.as_ref().map_or(Shape::Named(&schema.type_name), Shape::Json),
            Kind::Protobuf(types) => Shape::Protobuf(types, types.root_fields()),
            Kind::Unreadable(_) => Shape::Unknown,
        }
    }

    /// Opens a message; `None` if its bytes cannot be one, or if the definition cannot be read.
    pub fn view<'a>(&'a self, message: &'a [u8]) -> Option<View<'a>> {
        match &self.0 {
            Kind::Cdr(types) => CdrView::open(types, message).map(View::Cdr),
            Kind::Json(_) => json::JsonView::open(message).map(View::Json),
            Kind::Protobuf(types) => Some(View::Protobuf(types.open(message))),
            Kind::Unreadable(_) => None,
        }
    }
}

impl Kind {
    fn read(raw: RawDefinition<'_>) -> Result<Self, String> {
        if raw.data.len() > MAX_DEFINITION_BYTES {
            return Err("its definition is larger than a megabyte".to_owned());
        }
        match raw.message_encoding {
            "cdr" | "ros-z-cdr" => Self::read_cdr(raw),
            "json" => Ok(Self::Json(JsonSchema::read(raw.type_name, raw.data)?)),
            "protobuf" => ProtobufTypes::read(raw.type_name, raw.data)
                .map(Self::Protobuf)
                .ok_or_else(|| "its protobuf definition is damaged".to_owned()),
            other => Err(format!("messages encoded as `{other}` are not read")),
        }
    }

    fn read_cdr(raw: RawDefinition<'_>) -> Result<Self, String> {
        let text = std::str::from_utf8(raw.data).map_err(|_| "its definition is not text".to_owned())?;
        match raw.schema_encoding {
            "ros2msg" if !text.trim().is_empty() => ros2msg::parse(raw.type_name, text).map(Self::Cdr),
            "ros-z-schema-json" => ros_z::parse(text).map(Self::Cdr),
            // Without a definition that can be read, the name says which of the standard ones it is.
            encoding => ros2msg::standard(raw.type_name).map(Self::Cdr).ok_or_else(|| match encoding {
                "" => "the log holds no definition of its messages".to_owned(),
                encoding => format!("definitions in `{encoding}` are not read"),
            }),
        }
    }
}
