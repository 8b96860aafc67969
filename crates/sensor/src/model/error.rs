//! Faults of a model: each message says in one line where it is, what it is, and how to correct it.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};

use reality_sim_core::{
    camera::InvalidCamera,
    field::InvalidField,
    sequence::{FormatError, Printable},
};

use crate::{effects::library, tone::InvalidTone};

/// Error of a model that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}{fault}", Place(.path.as_deref(), *.line))]
pub struct ModelError {
    /// File of the model, if it comes from one.
    pub path: Option<PathBuf>,
    /// Line in the file, from 1, if the fault belongs to one.
    pub line: Option<usize>,
    /// The fault.
    #[source]
    pub fault: ModelFault,
}

/// Fault of a model. Every message says how to correct it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFault {
    /// The file does not exist.
    #[error("there is no such file: check the name, or put the file there")]
    Missing,
    /// The path is a folder, pipe or device.
    #[error("is not a regular file: put a file there")]
    NotAFile,
    /// The file is larger than any sensible model.
    #[error("is larger than {limit_bytes} bytes: it cannot be a model, check what it is")]
    TooLarge {
        /// Largest size.
        limit_bytes: u64,
    },
    /// The operating system cannot read the file.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(#[source] io::Error),
    /// The file is not text.
    #[error("is not UTF-8 text: save the file as UTF-8")]
    NotUtf8,
    /// The text is not TOML.
    #[error("{0}: correct the line")]
    Toml(#[source] FormatError),
    /// The text has a table other than the effects.
    #[error("the key `{key}` is not known: a model holds tables [[effect]] only")]
    UnknownTable {
        /// Key as given.
        key: String,
    },
    /// `effect` is not a list of tables.
    #[error("`effect` is not a list of tables: begin each effect with a line [[effect]]")]
    NotTables,
    /// An effect has no id.
    #[error("the key `id` is missing: add the effect's name, one of {}", Ids)]
    MissingId,
    /// An effect is not in the library.
    #[error("the effect {id:?} is not known: use one of {}", Ids)]
    UnknownEffect {
        /// Id as given.
        id: String,
    },
    /// An effect is listed twice.
    #[error("the effect {id} is there twice: keep one")]
    Twice {
        /// The effect.
        id: &'static str,
    },
    /// A key is not one of the effect's parameters.
    #[error("the key `{key}` is not known: {id} has {known}")]
    UnknownKey {
        /// The effect.
        id: &'static str,
        /// Key as given.
        key: String,
        /// The effect's keys.
        known: String,
    },
    /// A value is not a number.
    #[error("`{key}` of {id} is not a number: correct it")]
    NotANumber {
        /// The effect.
        id: &'static str,
        /// Key of the parameter.
        key: &'static str,
    },
    /// A number is NaN or infinite.
    #[error("`{key}` of {id} is not a finite number: correct it")]
    NotFinite {
        /// The effect.
        id: &'static str,
        /// Key of the parameter.
        key: &'static str,
    },
    /// The effect's values leave no valid camera.
    #[error("with {id}, {error}: bring its values nearer to 0")]
    Camera {
        /// The effect.
        id: &'static str,
        /// Fault of the camera.
        error: InvalidCamera,
    },
    /// The field is not valid.
    #[error("{0}: correct the field's dimensions")]
    Field(InvalidField),
    /// The effect's values leave no valid tone curve.
    #[error("with {id}, {error}: bring its values nearer to 0")]
    Tone {
        /// The effect.
        id: &'static str,
        /// Fault of the curve.
        error: InvalidTone,
    },
}

impl ModelError {
    /// Returns the error for a fault at a line, from 1, if it is known.
    pub(super) fn at(line: impl Into<Option<usize>>, fault: ModelFault) -> Self {
        Self { path: None, line: line.into(), fault }
    }

    /// Returns the error with the file that the model comes from.
    pub fn in_file(self, path: &Path) -> Self {
        Self { path: Some(path.to_path_buf()), ..self }
    }
}

impl From<ModelFault> for ModelError {
    fn from(fault: ModelFault) -> Self {
        Self::at(None, fault)
    }
}

/// Location of the fault, written as "model.toml, line 5: ".
struct Place<'a>(Option<&'a Path>, Option<usize>);

impl fmt::Display for Place<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(path, line) = self;
        match path {
            Some(path) => write!(formatter, "{}", Printable(path))?,
            None => write!(formatter, "the model")?,
        }
        line.map_or(Ok(()), |line| write!(formatter, ", line {line}"))?;
        write!(formatter, ": ")
    }
}

/// All ids of the library, separated by commas.
struct Ids;

impl fmt::Display for Ids {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids: Vec<&str> = library().iter().map(|effect| effect.id()).collect();
        write!(formatter, "{}", ids.join(", "))
    }
}
