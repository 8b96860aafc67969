//! Definitions in ROS 2's message language (`ros2msg`): the message, then its dependencies, each after a line of `=` and one
//! that names it (`MSG: package/Type`).

use std::collections::HashMap;

use super::{
    builtin,
    cdr_types::{CdrField, CdrType, CdrTypes, Number, StructId},
};

/// Parses a definition. Fails with what cannot be understood.
pub fn parse(type_name: &str, text: &str) -> Result<CdrTypes, String> {
    let mut parser =
        Parser { sections: sections(type_name, text), known: HashMap::new(), structs: Vec::new() };
    let root = parser.structure(&short_name(type_name))?;
    Ok(CdrTypes { structs: parser.structs, root })
}

/// Returns the standard definition of a type; `None` if it is not a standard one.
pub fn standard(type_name: &str) -> Option<CdrTypes> {
    parse(type_name, builtin::text(&short_name(type_name))?).ok()
}

/// Returns the standard definition of a type followed by those of all types in it, as logs hold them; `None` if it is not a standard one.
pub fn complete(type_name: &str) -> Option<String> {
    let mut names = vec![short_name(type_name)];
    let mut text = String::new();
    let mut done = 0;
    while let Some(name) = names.get(done).cloned() {
        let own = builtin::text(&name)?;
        if done > 0 {
            text += &format!("\n{}\nMSG: {name}\n", "=".repeat(80));
        }
        text += own;
        let package = name.split('/').next().unwrap_or_default();
        for (kind, _) in own.lines().filter_map(field_of) {
            let element = kind.split(['[', '<']).next().unwrap_or(kind);
            let part =
                if element.contains('/') { short_name(element) } else { format!("{package}/{element}") };
            if builtin::text(&part).is_some() && !names.contains(&part) {
                names.push(part);
            }
        }
        done += 1;
    }
    Some(text)
}

/// Returns `package/Type` of `package/msg/Type` or `package::msg::Type`.
pub fn short_name(name: &str) -> String {
    let parts: Vec<&str> = name.split(['/', ':']).filter(|part| !part.is_empty()).collect();
    match parts.as_slice() {
        [package, .., kind] => format!("{package}/{kind}"),
        _ => name.to_owned(),
    }
}

/// Splits a definition into the lines of each type.
fn sections<'a>(type_name: &str, text: &'a str) -> HashMap<String, Vec<&'a str>> {
    let mut sections: HashMap<String, Vec<&str>> = HashMap::new();
    let mut name = short_name(type_name);
    let mut lines = Vec::new();
    for line in text.lines().map(str::trim) {
        if let Some(next) = line.strip_prefix("MSG:") {
            sections.entry(std::mem::replace(&mut name, short_name(next.trim()))).or_insert(lines);
            lines = Vec::new();
        } else if !(line.len() >= 3 && line.bytes().all(|byte| byte == b'=')) {
            lines.push(line);
        }
    }
    sections.entry(name).or_insert(lines);
    sections
}

struct Parser<'a> {
    sections: HashMap<String, Vec<&'a str>>,
    known: HashMap<String, StructId>,
    structs: Vec<Vec<CdrField>>,
}

impl Parser<'_> {
    fn structure(&mut self, name: &str) -> Result<StructId, String> {
        if let Some(id) = self.known.get(name) {
            return Ok(*id);
        }
        let lines = match self.sections.get(name) {
            Some(lines) => lines.clone(),
            None => builtin::text(name)
                .map(|text| text.lines().map(str::trim).collect())
                .ok_or_else(|| format!("its definition does not say what {name} is"))?,
        };
        let id = StructId(self.structs.len());
        self.known.insert(name.to_owned(), id);
        self.structs.push(Vec::new());
        // A type that contains itself has no end; reading gives up where it is nested too deep.
        let package = name.split('/').next().unwrap_or_default();
        let fields = lines.iter().filter_map(|line| field_of(line));
        let mut parsed = Vec::new();
        for (kind, name) in fields {
            parsed.push(CdrField { name: name.to_owned(), kind: self.kind(package, kind)? });
        }
        self.structs[id.0] = parsed;
        Ok(id)
    }

    fn kind(&mut self, package: &str, text: &str) -> Result<CdrType, String> {
        if let Some(element) = text.strip_suffix(']') {
            let (element, count) = element.rsplit_once('[').ok_or_else(|| format!("`{text}` is no type"))?;
            let inner = Box::new(self.kind(package, element)?);
            return match count {
                "" => Ok(CdrType::Sequence(inner)),
                bound if bound.starts_with("<=") => Ok(CdrType::Sequence(inner)),
                count => {
                    let count = count.parse().map_err(|_| format!("`{text}` is no type"))?;
                    Ok(CdrType::Array(inner, count))
                }
            };
        }
        let unbounded = text.split("<=").next().unwrap_or(text);
        match unbounded {
            "string" => return Ok(CdrType::Text),
            "wstring" => return Ok(CdrType::Opaque),
            _ => {}
        }
        if let Some(number) = Number::of_ros(unbounded) {
            return Ok(CdrType::Number(number));
        }
        let name = match unbounded {
            "time" => "builtin_interfaces/Time".to_owned(),
            "duration" => "builtin_interfaces/Duration".to_owned(),
            "Header" => "std_msgs/Header".to_owned(),
            name if name.contains('/') => short_name(name),
            name => format!("{package}/{name}"),
        };
        self.structure(&name).map(CdrType::Struct)
    }
}

/// Returns type and name of the field that a line declares; constants, comments and blank lines declare none.
fn field_of(line: &str) -> Option<(&str, &str)> {
    let line = line.split('#').next().unwrap_or_default().trim();
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let rest = rest.trim_start();
    let name = rest.split(|letter: char| letter.is_whitespace() || letter == '=').next()?;
    let after = rest[name.len()..].trim_start();
    (!after.starts_with('=') && !name.is_empty()).then_some((kind, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_told_from_constants_comments_and_defaults() {
        assert_eq!(field_of("uint8 STATUS_FIX = 2"), None);
        assert_eq!(field_of("uint8 STATUS_FIX=2  # a constant"), None);
        assert_eq!(field_of("# int32 nothing"), None);
        assert_eq!(field_of("float64[<=9] k  # row-major"), Some(("float64[<=9]", "k")));
        assert_eq!(field_of("int32 number 5"), Some(("int32", "number")));
    }

    #[test]
    fn dependencies_are_found_with_and_without_their_package() {
        let text = "Header header\nPart[2] parts\nother/msg/Part part\n================\nMSG: mine/Part\nuint8 a\n\
                    ================\nMSG: other/Part\nfloat64[] b\nstring<=5 c\n";
        let types = parse("mine/msg/Whole", text).unwrap();
        let fields = types.fields(types.root);
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        assert_eq!(names, ["header", "parts", "part"]);
        let CdrType::Struct(other) = fields[2].kind else { panic!("{fields:?}") };
        assert_eq!(types.fields(other)[1].kind, CdrType::Text);
        assert!(parse("mine/msg/Whole", "Missing missing").is_err());
    }

    #[test]
    fn every_standard_definition_is_complete() {
        for name in builtin::names() {
            assert!(standard(name).is_some(), "{name}");
            // A reader that knows no definition but this finds all that are in it.
            let sections = complete(name).map(|text| sections(name, &text).len());
            let types = standard(name).map(|types| types.structs.len());
            assert_eq!(sections, types, "{name}");
        }
        assert!(standard("sensor_msgs/msg/Imu").is_some());
        assert!(standard("sensor_msgs/msg/Unheard").is_none());
    }

    #[test]
    fn a_type_that_contains_itself_is_no_endless_loop() {
        let types = parse("mine/msg/Loop", "Loop inner\n").unwrap();
        let message = vec![0, 1, 0, 0, 0, 0, 0, 0];
        let view = super::super::cdr::CdrView::open(&types, &message).unwrap();
        assert!(view.field("other").is_none());
    }
}
