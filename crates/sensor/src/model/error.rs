//! What can be wrong with a model: where, what, and what to do about it, in one line.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};

use reality_sim_core::{camera::InvalidCamera, field::InvalidField, sequence::Printable};

use crate::effects::library;

/// A model that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}{fault}", Place(.path.as_deref(), *.line))]
pub struct ModelError {
    /// The file, where the model comes from one.
    pub path: Option<PathBuf>,
    /// Line in the file, from 1, where the fault has one.
    pub line: Option<usize>,
    /// What is wrong.
    pub fault: ModelFault,
}

/// What is wrong with a model. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFault {
    /// There is no such file.
    #[error("there is no such file: check the name, or put the file there")]
    Missing,
    /// A folder, pipe or device where a file is needed.
    #[error("is not a regular file: put a file there")]
    NotAFile,
    /// More bytes than any sensible model.
    #[error("is larger than {limit_bytes} bytes: it cannot be a model, check what it is")]
    TooLarge {
        /// The limit.
        limit_bytes: u64,
    },
    /// The operating system does not give the bytes.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(io::Error),
    /// Not text.
    #[error("is not UTF-8 text: save the file as UTF-8")]
    NotUtf8,
    /// Not TOML.
    #[error("{message}: correct the line")]
    Toml {
        /// What the parser says.
        message: String,
    },
    /// Something else than effects.
    #[error("the key `{key}` is not known: a model holds tables [[effect]] only")]
    UnknownTable {
        /// As given.
        key: String,
    },
    /// `effect` is not a list of tables.
    #[error("`effect` is not a list of tables: begin each effect with a line [[effect]]")]
    NotTables,
    /// An effect without a name.
    #[error("the key `id` is missing: add the effect's name, one of {}", Ids)]
    MissingId,
    /// An effect that is not in the library.
    #[error("the effect {id:?} is not known: use one of {}", Ids)]
    UnknownEffect {
        /// As given.
        id: String,
    },
    /// An effect that is there twice.
    #[error("the effect {id} is there twice: keep one")]
    Twice {
        /// The effect.
        id: &'static str,
    },
    /// A number that the effect does not have.
    #[error("the key `{key}` is not known: {id} has {known}")]
    UnknownKey {
        /// The effect.
        id: &'static str,
        /// As given.
        key: String,
        /// The effect's keys.
        known: String,
    },
    /// A value that is no number.
    #[error("`{key}` of {id} is not a number: correct it")]
    NotANumber {
        /// The effect.
        id: &'static str,
        /// Its key.
        key: &'static str,
    },
    /// A number that is NaN or infinite.
    #[error("`{key}` of {id} is not a finite number: correct it")]
    NotFinite {
        /// The effect.
        id: &'static str,
        /// Its key.
        key: &'static str,
    },
    /// An effect whose values leave no camera.
    #[error("with {id}, {error}: bring its values nearer to 0")]
    Camera {
        /// The effect.
        id: &'static str,
        /// What is wrong with the camera.
        error: InvalidCamera,
    },
    /// A field that cannot be drawn.
    #[error("{0}: correct the field's dimensions")]
    Field(InvalidField),
    /// A tone curve that is none.
    #[error("the gamma would be {gamma}: bring gamma_change of tone_curve nearer to 0")]
    Gamma {
        /// With the effects.
        gamma: f64,
    },
}

impl ModelError {
    /// A fault at a line (from 1), where it is known.
    pub(super) fn at(line: impl Into<Option<usize>>, fault: ModelFault) -> Self {
        Self { path: None, line: line.into(), fault }
    }

    /// The same error of a model that comes from this file.
    pub fn in_file(self, path: &Path) -> Self {
        Self { path: Some(path.to_path_buf()), ..self }
    }
}

impl From<ModelFault> for ModelError {
    fn from(fault: ModelFault) -> Self {
        Self::at(None, fault)
    }
}

/// "model.toml, line 5: ".
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

/// All ids of the library, with commas.
struct Ids;

impl fmt::Display for Ids {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids: Vec<&str> = library().iter().map(|effect| effect.id()).collect();
        write!(formatter, "{}", ids.join(", "))
    }
}
