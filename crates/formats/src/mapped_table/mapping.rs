//! The mapping file.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

use reality_sim_core::sequence::one_line;
use serde::Deserialize;

use super::target::{Target, Unit};
use crate::{
    file::read_text,
    model_error::{ModelError, ModelFault},
};

/// Maximum size of a mapping file, bytes.
const MAX_MAPPING_BYTES: u64 = 1 << 20;

/// Mapping, as the file holds it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mapping {
    pub name: String,
    pub table: PathBuf,
    #[serde(default = "comma")]
    pub delimiter: char,
    pub images: Option<PathBuf>,
    pub camera: PathBuf,
    pub field: String,
    pub columns: HashMap<Target, Entry>,
}

fn comma() -> char {
    ','
}

/// Source of a value: the name of a column, or more.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(super) enum Entry {
    Name(String),
    Converted(Converted),
    Constant(Constant),
}

/// Column with its unit.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Converted {
    pub column: String,
    pub unit: Option<Unit>,
    #[serde(default = "plus")]
    pub sign: f64,
    #[serde(default)]
    pub offset: f64,
}

fn plus() -> f64 {
    1.0
}

/// Value that no column has, in metres, radians or seconds.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Constant {
    pub value: f64,
}

impl Mapping {
    /// Reads and checks the file.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let text = read_text(path, MAX_MAPPING_BYTES)?;
        let mapping: Self = toml::from_str(&text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let line = 1 + text.bytes().take(start).filter(|byte| *byte == b'\n').count();
            ModelError::at(path, line, ModelFault::Syntax { message: one_line(error.message()) })
        })?;
        mapping.check().map_err(|fault| ModelError::of_file(path, fault))?;
        Ok(mapping)
    }

    fn check(&self) -> Result<(), ModelFault> {
        for required in [Target::Timestamp, Target::Image, Target::Pitch, Target::Roll] {
            if !self.columns.contains_key(&required) {
                return Err(ModelFault::MissingValue { key: format!("columns.{}", required.name()) });
            }
        }
        let odometry = [Target::OdometryX, Target::OdometryY, Target::OdometryYaw];
        let reference = [Target::ReferenceX, Target::ReferenceY, Target::ReferenceYaw];
        for group in [odometry, reference] {
            let missing = group.iter().find(|target| !self.columns.contains_key(target));
            if let (Some(missing), true) =
                (missing, group.iter().any(|target| self.columns.contains_key(target)))
            {
                return Err(ModelFault::MissingValue { key: format!("columns.{}", missing.name()) });
            }
        }
        if !self.delimiter.is_ascii() {
            let (key, value) = ("delimiter".to_owned(), format!("{:?}", self.delimiter));
            return Err(ModelFault::BadValue { key, value, rule: "one ASCII character" });
        }
        self.columns.iter().try_for_each(|(target, entry)| entry.check(*target))
    }
}

impl Entry {
    fn check(&self, target: Target) -> Result<(), ModelFault> {
        let key = format!("columns.{}", target.name());
        let bad = |value: String, rule| Err(ModelFault::BadValue { key: key.clone(), value, rule });
        match self {
            Self::Name(_) => Ok(()),
            Self::Constant(constant) if target.quantity().is_none() => {
                bad(constant.value.to_string(), "the name of a column")
            }
            Self::Constant(constant) if !constant.value.is_finite() => {
                bad(constant.value.to_string(), "a finite number")
            }
            Self::Constant(_) => Ok(()),
            Self::Converted(converted) => {
                if converted.sign.abs() != 1.0 || !converted.offset.is_finite() {
                    return bad(converted.sign.to_string(), "of sign 1 or -1, with a finite offset");
                }
                match converted.unit {
                    Some(unit) if Some(unit.quantity()) != target.quantity() => {
                        bad(format!("{unit:?}"), "of a unit that measures what the column holds")
                    }
                    _ => Ok(()),
                }
            }
        }
    }
}
