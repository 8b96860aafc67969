//! Errors in a recording. The message says in one line where the fault is, what it is, and what to do about it.

use std::{fmt, io, path::Path, path::PathBuf};

use super::{format_error::FormatError, printable::Printable};
use crate::{camera::InvalidCamera, field::InvalidField, refine::InvalidCovariance};

/// Maximum length of an excerpt of a file in a message, characters.
const EXCERPT_LENGTH: usize = 60;

/// Maximum number of names in a message.
const NAMES: usize = 5;

/// Reason why a file or folder of a recording cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", Printable(.path), LineSuffix(*.line))]
pub struct SequenceError {
    /// Path of the file or folder.
    pub path: PathBuf,
    /// Line in the file, from 1, if the fault has one.
    pub line: Option<usize>,
    /// Fault of the file or folder.
    #[source]
    pub fault: Fault,
}

impl SequenceError {
    /// Makes an error about a whole file.
    pub(super) fn of_file(path: &Path, fault: Fault) -> Self {
        Self { path: path.to_path_buf(), line: None, fault }
    }

    /// Makes an error about a line (from 1), if it is known.
    pub(super) fn at(path: &Path, line: impl Into<Option<usize>>, fault: Fault) -> Self {
        Self { path: path.to_path_buf(), line: line.into(), fault }
    }
}

/// Fault of a file or folder. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The folder does not exist.
    #[error("there is no such folder: check the path, or record or write a sequence there first")]
    FolderMissing,
    /// A file was given where a folder is needed.
    #[error("is not a folder: give the folder that holds sequence.toml")]
    NotAFolder,
    /// The file does not exist.
    #[error("there is no such file: check the name, or put the file there")]
    Missing,
    /// A folder, pipe or device was given where a file is needed.
    #[error("is not a regular file: put a file there")]
    NotAFile,
    /// The file is larger than any sensible file of its kind.
    #[error("is larger than {limit_bytes} bytes: it cannot be a file of a sequence, check what it is")]
    TooLarge {
        /// Maximum size, bytes.
        limit_bytes: u64,
    },
    /// The operating system cannot read the file.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(#[source] io::Error),
    /// The operating system cannot write the file.
    #[error("cannot be written ({0}): check the permissions and the space on the disk")]
    Unwritable(#[source] io::Error),
    /// The file is not UTF-8 text.
    #[error("is not UTF-8 text: save the file as UTF-8")]
    NotUtf8,
    /// The file is not TOML, or a value has the wrong type.
    #[error("{0}: correct the line")]
    Toml(#[source] FormatError),
    /// A required key is missing.
    #[error("the key `{key}` is missing: add it")]
    MissingKey {
        /// Name of the key.
        key: String,
    },
    /// A value is out of its range.
    #[error("`{key}` is {}: it must be {rule}", Number(*.value))]
    BadValue {
        /// Name of the key or column.
        key: &'static str,
        /// Given value.
        value: f64,
        /// Rule that the value has to fulfil.
        rule: &'static str,
    },
    /// A name contains control characters.
    #[error("`{key}` is {name}: a name has no line breaks or other control characters, choose another")]
    BadName {
        /// Name of the key or column.
        key: &'static str,
        /// Given name, quoted.
        name: String,
    },
    /// A day is no date.
    #[error("`recorded_on` is {day}: write a date as 2026-05-31, or leave the key out")]
    BadDay {
        /// Given text, quoted.
        day: String,
    },
    /// The camera model is unknown.
    #[error("the camera model {model} is not known: use OPENCV_FISHEYE, OPENCV or PINHOLE")]
    UnknownModel {
        /// Given name, quoted.
        model: String,
    },
    /// The number of distortion coefficients does not fit the model.
    #[error("{model} takes {expected} distortion coefficients, not {found}: correct `distortion`")]
    DistortionCount {
        /// Camera model.
        model: &'static str,
        /// Coefficients that the model takes.
        expected: &'static str,
        /// Number of coefficients given.
        found: usize,
    },
    /// The camera's parameters cannot be used.
    #[error("{0}: correct the camera's numbers")]
    Camera(#[source] InvalidCamera),
    /// The uncertainty of the calibration is none.
    #[error("`covariance` {0}: write the table [calibration] anew, or remove it")]
    Covariance(#[source] InvalidCovariance),
    /// The field cannot be drawn.
    #[error("{0}: correct the field's dimensions")]
    Field(#[source] InvalidField),
    /// A file name is empty, absolute or leads out of the sequence's folder.
    #[error(
        "{name} is not a path inside the sequence's folder: give it relative to the folder, without `..`"
    )]
    PathLeavesFolder {
        /// Given name, quoted.
        name: String,
    },
    /// The table cannot be split into columns.
    #[error("{0}: correct the line")]
    Csv(#[source] FormatError),
    /// A required column is missing.
    #[error("the column `{column}` is missing: add it to the header and to every line")]
    MissingColumn {
        /// Name of the column.
        column: &'static str,
    },
    /// Two columns have the same name.
    #[error("the column `{column}` is there twice: remove or rename one")]
    DuplicateColumn {
        /// Name of the column.
        column: &'static str,
    },
    /// Some, but not all, of the odometry's columns are there.
    #[error("the odometry column `{column}` is missing beside the others: give all three or none")]
    PartialOdometry {
        /// First missing column.
        column: &'static str,
    },
    /// A line has too few or too many fields.
    #[error("has {found} fields, not {expected}: correct the line")]
    FieldCount {
        /// Number of fields found.
        found: usize,
        /// Number of fields that the header or the format prescribes.
        expected: usize,
    },
    /// A field is not a number.
    #[error("`{column}` is {text}, not a number: correct it")]
    NotANumber {
        /// Name of the column.
        column: &'static str,
        /// Given text, quoted.
        text: String,
    },
    /// A number is NaN or infinite.
    #[error("`{column}` is not a finite number: correct it, or remove the line")]
    NotFinite {
        /// Name of the column.
        column: &'static str,
    },
    /// A frame is not later than the previous one.
    #[error("timestamp {timestamp_s} s does not follow {previous_s} s: sort the frames and remove doubles")]
    NotIncreasing {
        /// Timestamp of the previous frame, seconds.
        previous_s: f64,
        /// Timestamp of this frame, seconds.
        timestamp_s: f64,
    },
    /// The table has no frames.
    #[error("holds no frames: record at least one")]
    NoFrames,
    /// A rotation has length zero.
    #[error("the quaternion qx qy qz qw is zero and so no rotation: correct it, or remove the line")]
    ZeroQuaternion,
    /// The reference poses were taken at other times than the frames.
    #[error(
        "its timestamps do not match the frames ({first_frame_s} s to {last_frame_s} s, the poses {first_pose_s} s to {last_pose_s} s): take both from one clock"
    )]
    TimestampsDoNotMatch {
        /// Timestamp of the first frame, seconds.
        first_frame_s: f64,
        /// Timestamp of the last frame, seconds.
        last_frame_s: f64,
        /// Timestamp of the earliest pose, seconds.
        first_pose_s: f64,
        /// Timestamp of the latest pose, seconds.
        last_pose_s: f64,
    },
    /// The sequence does not have this frame.
    #[error("there is no frame {index}, the sequence has {count}: count from 0")]
    NoSuchFrame {
        /// Requested index, from 0.
        index: usize,
        /// Number of frames.
        count: usize,
    },
    /// Pictures that the table of frames names are not there.
    #[error(
        "{count} of its {frames} pictures are missing (no such file: {}): put them there, or remove their lines from the table of frames",
        Printable(.first)
    )]
    PicturesMissing {
        /// First missing picture, relative to the sequence's folder.
        first: PathBuf,
        /// Number of missing pictures.
        count: usize,
        /// Number of frames.
        frames: usize,
    },
    /// Several pictures are missing or damaged.
    #[error("{} of its {frames} pictures cannot be used ({}), the first because {first}", .names.len(), Names(.names))]
    PicturesUnusable {
        /// Pictures, relative to the sequence's folder.
        names: Vec<PathBuf>,
        /// What is wrong with the first one.
        #[source]
        first: Box<Fault>,
        /// Number of frames.
        frames: usize,
    },
    /// The picture is neither JPEG nor PNG.
    #[error("is neither a JPEG nor a PNG picture: convert it to one of them")]
    ImageFormat,
    /// The picture is truncated.
    #[error("the picture is cut off before its end: copy or record it again")]
    ImageTruncated,
    /// The picture is damaged.
    #[error("the picture cannot be decoded ({0}): copy or record it again")]
    ImageDamaged(#[source] FormatError),
    /// The bytes of a JPEG do not end with its pixels, as where a part was lost or overwritten.
    #[error(
        "the picture is damaged ({unread_bytes} of its bytes belong to no pixel): copy or record it again"
    )]
    ImageNotWhole {
        /// Number of bytes behind the pixels.
        unread_bytes: usize,
    },
    /// The picture's EXIF data say that it is to be turned or mirrored before it is looked at.
    #[error(
        "the picture's EXIF orientation turns or mirrors it: store its pixels the way the camera of camera.toml sees them, without that entry"
    )]
    ImageTurned,
    /// The picture does not have the camera's size.
    #[error(
        "the picture has {found_width} x {found_height} pixels and the camera {width} x {height}: correct camera.toml, or use the camera's own pictures"
    )]
    ImageSize {
        /// Width of the picture, pixels.
        found_width: u32,
        /// Height of the picture, pixels.
        found_height: u32,
        /// Width of the camera, pixels.
        width: u32,
        /// Height of the camera, pixels.
        height: u32,
    },
    /// The picture would take more memory than is sensible.
    #[error("the picture needs more than {limit_bytes} bytes of memory: use a smaller one")]
    ImageTooLarge {
        /// Maximum size, bytes.
        limit_bytes: u64,
    },
    /// The sequence in memory cannot be written as files.
    #[error("the sequence cannot be written: {rule}")]
    Inconsistent {
        /// Rule that the sequence has to fulfil.
        rule: &'static str,
    },
}

/// Quotes, escapes and shortens text from a file for a message.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT_LENGTH) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// First names of a list, and how many more there are.
struct Names<'a>(&'a [PathBuf]);

impl fmt::Display for Names<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.0.iter().take(NAMES).map(|name| Printable(name).to_string()).collect();
        let more = self.0.len() - names.len();
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        write!(formatter, "{}{rest}", names.join(", "))
    }
}

/// Number of a file; with a power of ten if it would fill a line otherwise.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = self;
        if value.abs() < 1e12 { write!(formatter, "{value}") } else { write!(formatter, "{value:e}") }
    }
}

/// Prints ", line 5", or nothing.
struct LineSuffix(Option<usize>);

impl fmt::Display for LineSuffix {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(formatter, ", line {line}"))
    }
}
