//! Errors in models of others, and in their export. The message says in one line where the fault is, what it is, and what
//! to do about it.

use std::{
    error::Error,
    fmt, io,
    path::{Path, PathBuf},
};

use reality_sim_core::{
    camera::InvalidCamera,
    sequence::{Fault, Printable, SequenceError},
};

/// Maximum length of an excerpt of a file in a message, characters.
const EXCERPT_LENGTH: usize = 60;

/// Reason why a model cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", Printable(.path), LineSuffix(*.line))]
pub struct ModelError {
    /// Path of the file or folder.
    pub path: PathBuf,
    /// Line in the file, from 1, if the fault has one.
    pub line: Option<usize>,
    /// Fault of the file or folder.
    #[source]
    pub fault: Box<ModelFault>,
}

impl ModelError {
    /// Makes an error about a whole file or folder.
    pub fn of_file(path: &Path, fault: ModelFault) -> Self {
        Self { path: path.to_path_buf(), line: None, fault: Box::new(fault) }
    }

    /// Makes an error about a line, from 1.
    pub fn at(path: &Path, line: usize, fault: ModelFault) -> Self {
        Self { path: path.to_path_buf(), line: Some(line), fault: Box::new(fault) }
    }

    /// Makes an error about a table, of which the message says what is wrong and what to do.
    pub(crate) fn of_table(path: &Path, message: impl Into<String>) -> Self {
        Self::of_file(path, ModelFault::Table { message: message.into() })
    }
}

impl From<SequenceError> for ModelError {
    fn from(error: SequenceError) -> Self {
        let SequenceError { path, line, fault } = error;
        Self { path, line, fault: Box::new(ModelFault::Sequence(fault)) }
    }
}

/// Fault of a file or folder. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFault {
    /// Fault of a picture or of a file of a recording.
    #[error(transparent)]
    Sequence(Fault),
    /// A picture cannot be had from where the pictures are.
    #[error("its picture cannot be read: {0}")]
    Picture(#[source] Box<dyn Error + Send + Sync>),
    /// The operating system cannot read the file.
    #[error("cannot be read ({0}): check the path, the permissions and the disk")]
    Unreadable(#[source] io::Error),
    /// The operating system cannot write the file.
    #[error("cannot be written ({0}): check the permissions and the space on the disk")]
    Unwritable(#[source] io::Error),
    /// The file is larger than any sensible file of its kind.
    #[error("is larger than {limit_bytes} bytes: check what it is")]
    TooLarge {
        /// Maximum size, bytes.
        limit_bytes: u64,
    },
    /// The file is not UTF-8 text.
    #[error("is not UTF-8 text: save the file as UTF-8")]
    NotUtf8,
    /// There is no such part of a model.
    #[error("holds no {what}: give the folder or file that holds it")]
    NothingThere {
        /// What is missing.
        what: &'static str,
    },
    /// A binary file ends too early.
    #[error("ends inside {what}, at byte {offset}: copy or write the file again")]
    CutOff {
        /// What was being read.
        what: &'static str,
        /// Offset at which it was to begin, bytes.
        offset: usize,
    },
    /// A binary file claims more than it can hold.
    #[error("claims to hold {count} {what}, more than its size allows: it is damaged, write it again")]
    Count {
        /// What is counted.
        what: &'static str,
        /// Number that the file states.
        count: u64,
    },
    /// A value is missing.
    #[error("`{key}` is missing: add it")]
    MissingValue {
        /// Key or column.
        key: String,
    },
    /// A value has another type, or is out of its range.
    #[error("`{key}` is {value}: it must be {rule}")]
    BadValue {
        /// Key or column.
        key: String,
        /// Given value, quoted and shortened if it is text.
        value: String,
        /// Rule that the value has to fulfil.
        rule: &'static str,
    },
    /// The text is not JSON or TOML, or a value has the wrong type.
    #[error("{message}: correct the file")]
    Syntax {
        /// What the parser says, on one line.
        message: String,
    },
    /// The camera model cannot be represented.
    #[error(
        "the camera model {model} cannot be represented: convert the model's cameras to OPENCV_FISHEYE, OPENCV or PINHOLE"
    )]
    UnknownCameraModel {
        /// Name or number of the model, quoted.
        model: String,
    },
    /// Terms of a camera model that have no counterpart are in use.
    #[error("the camera model {model} uses {terms}, which cannot be represented: fit a model without them")]
    UnsupportedTerms {
        /// Name of the model.
        model: &'static str,
        /// The terms.
        terms: &'static str,
    },
    /// The camera's parameters cannot be used.
    #[error("camera {id}: {error}: correct the camera's numbers")]
    Camera {
        /// Camera in the file.
        id: u32,
        /// What is wrong.
        #[source]
        error: InvalidCamera,
    },
    /// A picture refers to a camera that is not there.
    #[error("the picture {picture} refers to camera {id}, which is not there: write the model again")]
    NoSuchCamera {
        /// Name of the picture, quoted.
        picture: String,
        /// Camera that it names.
        id: u32,
    },
    /// The pictures were taken by different cameras.
    #[error(
        "has pictures of {count} different cameras: a recording has one, export the pictures of each by themselves"
    )]
    SeveralCameras {
        /// Number of cameras.
        count: usize,
    },
    /// Cameras of different models, where the format has one model for all.
    #[error(
        "has cameras of different models: {format} has one model for all, use another format or --undistort"
    )]
    MixedModels {
        /// Name of the format.
        format: &'static str,
    },
    /// A rotation is none.
    #[error("the rotation of {picture} is not one: write the model again")]
    NoRotation {
        /// Name of the picture, quoted.
        picture: String,
    },
    /// Poses that no camera over a field has.
    #[error(
        "{what}: the model must be in metres, with z up and its origin at the field's centre; align it first, with COLMAP by `model_aligner`"
    )]
    NotAligned {
        /// What is impossible.
        what: String,
    },
    /// A picture's name is empty, absolute or leads out of the folder.
    #[error("{name} is not a path inside the pictures' folder: give names relative to it, without `..`")]
    PathLeavesFolder {
        /// Given name, quoted.
        name: String,
    },
    /// A table cannot be read or written.
    #[error("the table {message}")]
    Table {
        /// What is wrong and what to do.
        message: String,
    },
    /// A log or its server fails.
    #[error("{message}")]
    Show {
        /// What is wrong and what to do.
        message: String,
    },
}

/// Quotes, escapes and shortens text from a file for a message.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT_LENGTH) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// Prints ", line 5", or nothing.
struct LineSuffix(Option<usize>);

impl fmt::Display for LineSuffix {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(formatter, ", line {line}"))
    }
}
