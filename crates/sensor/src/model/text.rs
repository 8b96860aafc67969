//! Reading and writing the text of a model.

use std::{
    fmt::Write,
    fs::{self, File},
    io::{self, Read},
    ops::Range,
    path::Path,
};

use reality_sim_core::sequence::FormatError;
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{Model, ModelError, ModelFault, Used};
use crate::{
    effect::{Effect, Parameter},
    effects::effect,
};

/// Largest size of a model file, bytes.
const MAX_BYTES: u64 = 1 << 20;

const HEADER: &str = "# Effects of the simulated camera beside what camera.toml says, as positive values have them; neutral values: no effect.\n";

impl Model {
    /// Reads and validates a model file.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        read(path).and_then(|text| Self::from_toml(path, &text))
    }

    /// Parses the text of a `model.toml`. Errors name `origin`: the file or other source of the text. Omitted values are
    /// neutral; values outside the plausible range are accepted.
    pub fn from_toml(origin: &Path, text: &str) -> Result<Self, ModelError> {
        parse(text).map_err(|error| error.in_file(origin))
    }

    /// Returns the text of a `model.toml` that reads back as the same values.
    pub fn to_toml(&self) -> String {
        print(self)
    }
}

/// Reads the text of a regular file of at most the size of a model.
fn read(path: &Path) -> Result<String, ModelError> {
    let bytes = read_bytes(path).map_err(|fault| ModelError::from(fault).in_file(path))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let line = line_of_offset(error.as_bytes(), error.utf8_error().valid_up_to());
        ModelError::at(line, ModelFault::NotUtf8).in_file(path)
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, ModelFault> {
    if !fs::metadata(path).map_err(read_fault)?.is_file() {
        return Err(ModelFault::NotAFile);
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(read_fault)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(read_fault)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ModelFault::TooLarge { limit_bytes: MAX_BYTES });
    }
    Ok(bytes)
}

fn read_fault(error: io::Error) -> ModelFault {
    if error.kind() == io::ErrorKind::NotFound { ModelFault::Missing } else { ModelFault::Unreadable(error) }
}

/// Parses the text of a model.
fn parse(text: &str) -> Result<Model, ModelError> {
    let at = |span: Range<usize>, fault| ModelError::at(line_of_offset(text.as_bytes(), span.start), fault);
    let document = DeTable::parse(text).map_err(|error| {
        let message = error.message().to_owned();
        at(error.span().unwrap_or_default(), ModelFault::Toml(FormatError::with_message(message, error)))
    })?;
    let mut model = Model::default();
    for (key, value) in document.get_ref() {
        if key.get_ref() != "effect" {
            return Err(at(key.span(), ModelFault::UnknownTable { key: key.get_ref().to_string() }));
        }
        let tables = value.get_ref().as_array().ok_or_else(|| at(value.span(), ModelFault::NotTables))?;
        for table in tables {
            let used = parse_effect(table).map_err(|(span, fault)| at(span, fault))?;
            if model.values(used.effect.id()).is_some() {
                return Err(at(table.span(), ModelFault::Twice { id: used.effect.id() }));
            }
            model.effects.push(used);
        }
    }
    Ok(model)
}

/// Fault with its byte range in the text.
type Faulty = (Range<usize>, ModelFault);

fn parse_effect(table: &Spanned<DeValue<'_>>) -> Result<Used, Faulty> {
    let entries = table.get_ref().as_table().ok_or((table.span(), ModelFault::NotTables))?;
    let id = entries.get("id").ok_or((table.span(), ModelFault::MissingId))?;
    let name = id.get_ref().as_str().ok_or((id.span(), ModelFault::MissingId))?;
    let effect = effect(name).ok_or((id.span(), ModelFault::UnknownEffect { id: name.to_owned() }))?;
    let mut values: Vec<f64> = effect.parameters().iter().map(|parameter| parameter.neutral).collect();
    for (key, value) in entries.iter().filter(|(key, _)| key.get_ref() != "id") {
        let index = effect.parameters().iter().position(|parameter| parameter.name == key.get_ref());
        let index = index.ok_or_else(|| (key.span(), unknown_key(effect, key.get_ref())))?;
        let parameter = effect.parameters()[index].name;
        values[index] = number(effect, parameter, value.get_ref()).map_err(|fault| (value.span(), fault))?;
    }
    Ok(Used { effect, values })
}

fn unknown_key(effect: &dyn Effect, key: &str) -> ModelFault {
    let names: Vec<&str> = effect.parameters().iter().map(|parameter| parameter.name).collect();
    ModelFault::UnknownKey { id: effect.id(), key: key.to_owned(), known: names.join(", ") }
}

fn number(effect: &dyn Effect, key: &'static str, value: &DeValue<'_>) -> Result<f64, ModelFault> {
    let id = effect.id();
    let number: Option<f64> = match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|integer| integer as f64)
        }
        _ => None,
    };
    let number = number.ok_or(ModelFault::NotANumber { id, key })?;
    if number.is_finite() { Ok(number) } else { Err(ModelFault::NotFinite { id, key }) }
}

/// Returns the line, from 1, that contains a byte.
fn line_of_offset(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|byte| **byte == b'\n').count()
}

/// Writes the text of a model, with names and units as comments.
fn print(model: &Model) -> String {
    let mut text = HEADER.to_owned();
    for Used { effect, values } in &model.effects {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n[[effect]]\nid = \"{}\"  # {}\n", effect.id(), effect.name());
        for (parameter, value) in effect.parameters().iter().zip(values) {
            let _ = writeln!(text, "{}", line(parameter, *value));
        }
    }
    text
}

/// Writes one value: `{:?}` is the shortest text that reads back as the same number, with the point or exponent that TOML
/// requires.
fn line(parameter: &Parameter, value: f64) -> String {
    let number = if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") };
    format!("{} = {number}  # {}", parameter.name, parameter.unit)
}
