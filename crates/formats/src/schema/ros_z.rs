//! Definitions of HULKs' `ros-z` (`ros-z-schema-json`): a root and structures by their Rust names, as JSON. Tags and their
//! spelling have changed with its versions; both spellings are read.

use std::collections::HashMap;

use serde_json::{Map, Value};

use super::{
    cdr_types::{CdrField, CdrType, CdrTypes, Number, StructId},
    limits::MAX_DEPTH,
};

/// Parses a definition. Fails with what cannot be understood.
pub fn parse(text: &str) -> Result<CdrTypes, String> {
    let bundle: Value = serde_json::from_str(text).map_err(|_| "its definition is not JSON".to_owned())?;
    let definitions = bundle.get("definitions").and_then(Value::as_object);
    let definitions = definitions.ok_or_else(|| "its definition has no `definitions`".to_owned())?;
    let mut parser = Parser { definitions, known: HashMap::new(), structs: Vec::new() };
    let root = bundle.get("root").and_then(type_name).ok_or_else(|| "its root is no structure".to_owned())?;
    let root = match parser.named(root, 0)? {
        CdrType::Struct(id) => id,
        _ => return Err("its root is no structure".to_owned()),
    };
    Ok(CdrTypes { structs: parser.structs, root })
}

/// Returns the name to which a shape refers.
fn type_name(shape: &Value) -> Option<&str> {
    if let Some(name) = shape.as_str() {
        return Some(name);
    }
    let object = shape.as_object()?;
    let tagged =
        ["type", "type_name", "StructRef", "EnumRef", "Named"].iter().find_map(|key| object.get(*key));
    tagged.and_then(Value::as_str)
}

struct Parser<'a> {
    definitions: &'a Map<String, Value>,
    known: HashMap<&'a str, StructId>,
    structs: Vec<Vec<CdrField>>,
}

impl<'a> Parser<'a> {
    fn named(&mut self, name: &str, depth: usize) -> Result<CdrType, String> {
        if let Some(id) = self.known.get(name) {
            return Ok(CdrType::Struct(*id));
        }
        let Some((name, definition)) = self.definitions.get_key_value(name) else {
            return Err(format!("its definition does not say what {name} is"));
        };
        let fields = definition.get("Struct").unwrap_or(definition).get("fields").and_then(Value::as_array);
        // Enumerations with contents are not read.
        let Some(fields) = fields.filter(|_| depth < MAX_DEPTH) else { return Ok(CdrType::Opaque) };
        let id = StructId(self.structs.len());
        self.known.insert(name, id);
        self.structs.push(Vec::new());
        let mut parsed = Vec::new();
        for field in fields {
            let name = field.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
            let shape = field.get("shape").unwrap_or(&Value::Null);
            parsed.push(CdrField { name, kind: self.kind(shape, depth + 1)? });
        }
        self.structs[id.0] = parsed;
        Ok(CdrType::Struct(id))
    }

    fn kind(&mut self, shape: &'a Value, depth: usize) -> Result<CdrType, String> {
        if depth > MAX_DEPTH {
            return Ok(CdrType::Opaque);
        }
        let (tag, body) = tagged(shape);
        match tag.to_ascii_lowercase().as_str() {
            "string" => Ok(CdrType::Text),
            "primitive" => {
                let name = body.as_str().or_else(|| body.get("name")?.as_str()).unwrap_or_default();
                Number::of_rust(name).map(CdrType::Number).ok_or_else(|| format!("{name} is no number"))
            }
            "struct_ref" | "structref" | "named" | "enum_ref" | "enumref" => {
                type_name(body).map_or(Ok(CdrType::Opaque), |name| self.named(name, depth))
            }
            "optional" => self.inner(body, depth).map(|inner| CdrType::Optional(Box::new(inner))),
            "sequence" | "bounded_sequence" | "boundedsequence" | "array" => {
                let inner = Box::new(self.inner(body, depth)?);
                Ok(match fixed_length(body) {
                    Some(count) => CdrType::Array(inner, count),
                    None => CdrType::Sequence(inner),
                })
            }
            name => Ok(Number::of_rust(name).map_or(CdrType::Opaque, CdrType::Number)),
        }
    }

    fn inner(&mut self, body: &'a Value, depth: usize) -> Result<CdrType, String> {
        let named = ["element", "shape", "inner"].iter().find_map(|key| body.get(*key));
        self.kind(named.unwrap_or(body), depth + 1)
    }
}

/// Returns the tag of a shape and what belongs to it: `"String"`, `{"Sequence": …}` or `{"kind": "sequence", …}`.
fn tagged(shape: &Value) -> (&str, &Value) {
    match shape {
        Value::String(tag) => (tag, &Value::Null),
        Value::Object(object) => match object.get("kind").and_then(Value::as_str) {
            Some(tag) => (tag, shape),
            None => object.iter().next().map_or(("", &Value::Null), |(tag, body)| (tag.as_str(), body)),
        },
        _ => ("", &Value::Null),
    }
}

/// Returns the number of values of an array, if it is fixed.
fn fixed_length(body: &Value) -> Option<usize> {
    let length = body.get("length").or_else(|| body.get("len"))?;
    let value =
        length.as_u64().or_else(|| length.get("Fixed")?.as_u64()).or_else(|| length.get("value")?.as_u64());
    value.and_then(|value| usize::try_from(value).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_say_the_same() {
        let tagged = r#"{"root":"a::Image","definitions":{"a::Image":{"Struct":{"fields":[
            {"name":"width","shape":{"Primitive":"u32"}},{"name":"encoding","shape":"String"},
            {"name":"data","shape":{"Sequence":{"element":{"Primitive":"u8"},"length":"Dynamic"}}},
            {"name":"k","shape":{"Array":{"element":{"Primitive":"f64"},"length":9}}}]}}}}"#;
        let kinds = r#"{"root":{"kind":"struct_ref","type":"a::Image"},"definitions":{"a::Image":{"kind":"struct","fields":[
            {"name":"width","shape":{"kind":"primitive","name":"u32"}},{"name":"encoding","shape":{"kind":"string"}},
            {"name":"data","shape":{"kind":"sequence","length":{"kind":"dynamic"},"element":{"kind":"primitive","name":"u8"}}},
            {"name":"k","shape":{"kind":"sequence","length":{"kind":"fixed","value":9},"element":{"kind":"primitive","name":"f64"}}}]}}}"#;
        assert_eq!(parse(tagged).unwrap(), parse(kinds).unwrap());
        let types = parse(kinds).unwrap();
        assert_eq!(types.fields(types.root)[1].kind, CdrType::Text);
    }
}
