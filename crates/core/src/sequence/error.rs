//! What can be wrong with a recording: where it is, what it is, and what to do about it, in one line.

use std::{fmt, io, path::Path, path::PathBuf};

use crate::{camera::InvalidCamera, field::InvalidField};

/// Longer excerpts of a file are cut in a message, characters.
const EXCERPT_LENGTH: usize = 60;

/// A file or folder of a recording that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", Printable(.path), LineSuffix(*.line))]
pub struct SequenceError {
    /// The file or folder.
    pub path: PathBuf,
    /// Line in the file, from 1, where the fault has one.
    pub line: Option<usize>,
    /// What is wrong.
    pub fault: Fault,
}

impl SequenceError {
    /// A fault of a whole file.
    pub(super) fn of_file(path: &Path, fault: Fault) -> Self {
        Self { path: path.to_path_buf(), line: None, fault }
    }

    /// A fault at a line (from 1), where it is known.
    pub(super) fn at(path: &Path, line: impl Into<Option<usize>>, fault: Fault) -> Self {
        Self { path: path.to_path_buf(), line: line.into(), fault }
    }
}

/// What is wrong with a file or folder. Every message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// There is no such folder.
    #[error("there is no such folder: check the path, or record or write a sequence there first")]
    FolderMissing,
    /// A file was given where a folder is needed.
    #[error("is not a folder: give the folder that holds sequence.toml")]
    NotAFolder,
    /// There is no such file.
    #[error("there is no such file: check the name, or put the file there")]
    Missing,
    /// A folder, pipe or device where a file is needed.
    #[error("is not a regular file: put a file there")]
    NotAFile,
    /// More bytes than any sensible file of its kind.
    #[error("is larger than {limit_bytes} bytes: it cannot be a file of a sequence, check what it is")]
    TooLarge {
        /// The limit.
        limit_bytes: u64,
    },
    /// The operating system does not give the bytes.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(io::Error),
    /// The operating system does not take the bytes.
    #[error("cannot be written ({0}): check the permissions and the space on the disk")]
    Unwritable(io::Error),
    /// Not text.
    #[error("is not UTF-8 text: save the file as UTF-8")]
    NotUtf8,
    /// Not TOML, or a value of the wrong type.
    #[error("{message}: correct the line")]
    Toml {
        /// What the parser says.
        message: String,
    },
    /// A key that must be there is not.
    #[error("the key `{key}` is missing: add it")]
    MissingKey {
        /// The key.
        key: String,
    },
    /// A value out of its range.
    #[error("`{key}` is {value}: it must be {rule}")]
    BadValue {
        /// The key or column.
        key: &'static str,
        /// As given.
        value: f64,
        /// What it has to be.
        rule: &'static str,
    },
    /// A camera model that is not known.
    #[error("the camera model {model} is not known: use OPENCV_FISHEYE, OPENCV or PINHOLE")]
    UnknownModel {
        /// As given, quoted.
        model: String,
    },
    /// Too few or too many coefficients for the model.
    #[error("{model} takes {expected} distortion coefficients, not {found}: correct `distortion`")]
    DistortionCount {
        /// The camera model.
        model: &'static str,
        /// What it takes.
        expected: &'static str,
        /// As given.
        found: usize,
    },
    /// A camera that cannot be used.
    #[error("{0}: correct the camera's numbers")]
    Camera(InvalidCamera),
    /// A field that cannot be drawn.
    #[error("{0}: correct the field's dimensions")]
    Field(InvalidField),
    /// A file name that is empty, absolute or leads out of the sequence's folder.
    #[error(
        "{name} is not a path inside the sequence's folder: give it relative to the folder, without `..`"
    )]
    PathLeavesFolder {
        /// As given, quoted.
        name: String,
    },
    /// The table cannot be split into columns.
    #[error("{message}: correct the line")]
    Csv {
        /// What the parser says.
        message: String,
    },
    /// A column that must be there is not.
    #[error("the column `{column}` is missing: add it to the header and to every line")]
    MissingColumn {
        /// The column.
        column: &'static str,
    },
    /// Two columns of one name.
    #[error("the column `{column}` is there twice: remove or rename one")]
    DuplicateColumn {
        /// The column.
        column: &'static str,
    },
    /// Some, but not all, of the odometry's columns.
    #[error("the odometry column `{column}` is missing beside the others: give all three or none")]
    PartialOdometry {
        /// The first that is missing.
        column: &'static str,
    },
    /// A line with too few or too many fields.
    #[error("has {found} fields, not {expected}: correct the line")]
    FieldCount {
        /// As given.
        found: usize,
        /// As the header or the format says.
        expected: usize,
    },
    /// A field that is no number.
    #[error("`{column}` is {text}, not a number: correct it")]
    NotANumber {
        /// The column.
        column: &'static str,
        /// As given, quoted.
        text: String,
    },
    /// A number that is NaN or infinite.
    #[error("`{column}` is not a finite number: correct it, or remove the line")]
    NotFinite {
        /// The column.
        column: &'static str,
    },
    /// A frame that is not later than the one before.
    #[error("timestamp {timestamp_s} s does not follow {previous_s} s: sort the frames and remove doubles")]
    NotIncreasing {
        /// Of the frame before, seconds.
        previous_s: f64,
        /// Of this frame, seconds.
        timestamp_s: f64,
    },
    /// A table without frames.
    #[error("holds no frames: record at least one")]
    NoFrames,
    /// A rotation of length zero.
    #[error("the quaternion qx qy qz qw is zero and so no rotation: correct it, or remove the line")]
    ZeroQuaternion,
    /// Reference poses of another time than the frames.
    #[error(
        "its timestamps do not match the frames ({first_frame_s} s to {last_frame_s} s, the poses {first_pose_s} s to {last_pose_s} s): take both from one clock"
    )]
    TimestampsDoNotMatch {
        /// Of the first frame, seconds.
        first_frame_s: f64,
        /// Of the last frame, seconds.
        last_frame_s: f64,
        /// Of the earliest pose, seconds.
        first_pose_s: f64,
        /// Of the latest pose, seconds.
        last_pose_s: f64,
    },
    /// A frame that the sequence does not have.
    #[error("there is no frame {index}, the sequence has {count}: count from 0")]
    NoSuchFrame {
        /// As asked, from 0.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Neither JPEG nor PNG.
    #[error("is neither a JPEG nor a PNG picture: convert it to one of them")]
    ImageFormat,
    /// A picture that is cut off.
    #[error("the picture is cut off before its end: copy or record it again")]
    ImageTruncated,
    /// A damaged picture.
    #[error("the picture cannot be decoded ({message}): copy or record it again")]
    ImageDamaged {
        /// What the decoder says.
        message: String,
    },
    /// A picture of another camera.
    #[error(
        "the picture has {found_width} x {found_height} pixels and the camera {width} x {height}: correct camera.toml, or use the camera's own pictures"
    )]
    ImageSize {
        /// Of the picture, pixels.
        found_width: u32,
        /// Of the picture, pixels.
        found_height: u32,
        /// Of the camera, pixels.
        width: u32,
        /// Of the camera, pixels.
        height: u32,
    },
    /// A picture that would not fit into a sensible part of the memory.
    #[error("the picture needs more than {limit_bytes} bytes of memory: use a smaller one")]
    ImageTooLarge {
        /// The limit.
        limit_bytes: u64,
    },
    /// A sequence in memory that no file can hold.
    #[error("the sequence cannot be written: {rule}")]
    Inconsistent {
        /// What has to hold.
        rule: &'static str,
    },
}

/// Text from a file, quoted, escaped and cut for a message.
pub(super) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(EXCERPT_LENGTH) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// A message of another library, in one line.
pub(super) fn one_line(message: &str) -> String {
    let printable: String =
        message.chars().map(|letter| if is_unprintable(letter) { ' ' } else { letter }).collect();
    printable.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Control characters, and the two that some programs take for the end of a line.
fn is_unprintable(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}')
}

/// A path for a message: without line breaks.
#[derive(Debug)]
pub struct Printable<'a>(pub &'a Path);

impl fmt::Display for Printable<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.0.to_string_lossy();
        text.chars().try_for_each(|letter| {
            if is_unprintable(letter) {
                write!(formatter, "{}", letter.escape_default())
            } else {
                write!(formatter, "{letter}")
            }
        })
    }
}

/// ", line 5", or nothing.
struct LineSuffix(Option<usize>);

impl fmt::Display for LineSuffix {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(formatter, ", line {line}"))
    }
}
