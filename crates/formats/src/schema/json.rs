//! Messages in JSON, read where they lie, and their definitions (`jsonschema`).

use std::{borrow::Cow, fmt};

use base64::{Engine, engine::general_purpose::STANDARD};
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Value, value::RawValue};

/// Definition of messages in JSON.
#[derive(Debug)]
pub struct JsonSchema {
    /// Name of the messages' type.
    pub type_name: String,
    /// JSON schema, if the log holds one.
    pub schema: Option<Value>,
}

impl JsonSchema {
    /// Reads a definition; an empty one says nothing but the name.
    pub fn read(type_name: &str, data: &[u8]) -> Result<Self, String> {
        let schema = match data.trim_ascii() {
            [] => None,
            data => Some(serde_json::from_slice(data).map_err(|_| "its JSON schema is damaged".to_owned())?),
        };
        Ok(Self { type_name: type_name.to_owned(), schema })
    }
}

/// Value in a message.
#[derive(Debug, Clone, Copy)]
pub struct JsonView<'a>(&'a RawValue);

impl<'a> JsonView<'a> {
    /// Opens a message; `None` if it is not JSON.
    pub fn open(message: &'a [u8]) -> Option<Self> {
        serde_json::from_slice(message).ok().map(Self)
    }

    /// Returns a field's value.
    pub fn field(&self, name: &str) -> Option<Self> {
        let mut deserializer = serde_json::Deserializer::from_str(self.0.get());
        Member(name).deserialize(&mut deserializer).ok().flatten().map(Self)
    }

    /// Returns a number. Numbers that JSON cannot hold, such as NaN, are texts in Foxglove's JSON.
    pub fn number(&self) -> Option<f64> {
        serde_json::from_str(self.0.get()).ok()
    }

    /// Returns a whole number.
    pub fn integer(&self) -> Option<i64> {
        serde_json::from_str(self.0.get()).ok()
    }

    /// Returns a text.
    pub fn text(&self) -> Option<Cow<'a, str>> {
        if let Ok(text) = serde_json::from_str::<&str>(self.0.get()) {
            return Some(Cow::Borrowed(text));
        }
        serde_json::from_str::<String>(self.0.get()).ok().map(Cow::Owned)
    }

    /// Returns bytes: a text in Base64.
    pub fn bytes(&self) -> Option<Cow<'a, [u8]>> {
        STANDARD.decode(self.text()?.as_bytes()).ok().map(Cow::Owned)
    }

    /// Hands over the values of an array one after the other.
    pub fn each(&self, visit: &mut dyn FnMut(Self)) -> Option<()> {
        let mut deserializer = serde_json::Deserializer::from_str(self.0.get());
        Elements(visit).deserialize(&mut deserializer).ok()
    }
}

/// Finds a member of an object.
struct Member<'n>(&'n str);

impl<'de> DeserializeSeed<'de> for Member<'_> {
    type Value = Option<&'de RawValue>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Member<'_> {
    type Value = Option<&'de RawValue>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut found = None;
        while let Some(is_wanted) = map.next_key_seed(NameIs(self.0))? {
            if is_wanted {
                found = Some(map.next_value()?);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(found)
    }
}

/// Compares the name of a member.
struct NameIs<'n>(&'n str);

impl<'de> DeserializeSeed<'de> for NameIs<'_> {
    type Value = bool;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<bool, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl Visitor<'_> for NameIs<'_> {
    type Value = bool;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a name")
    }

    fn visit_str<E>(self, name: &str) -> Result<bool, E> {
        Ok(name == self.0)
    }
}

/// Visits the elements of an array.
struct Elements<'v, 'de>(&'v mut dyn FnMut(JsonView<'de>));

impl<'de> DeserializeSeed<'de> for Elements<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Elements<'_, 'de> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an array")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        while let Some(element) = seq.next_element::<&RawValue>()? {
            (self.0)(JsonView(element));
        }
        Ok(())
    }
}
