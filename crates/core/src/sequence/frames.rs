//! `frames.csv`: one line per picture.

use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

use csv::{ReaderBuilder, StringRecord, Trim};

use super::{
    error::{Fault, SequenceError, excerpt},
    format_error::FormatError,
    sequence_file::is_inside_folder,
    text::line_of_offset,
};
use crate::pose::{CameraPose, Pose2};

/// Latest time of a table, seconds. Whatever is later is in other units, such as nanoseconds.
const LATEST_S: f64 = 1e11;

/// Largest coordinate of a table, metres. Chosen: whatever is farther is no measurement; millimetres, which `gap` recognises, are
/// within.
const LONGEST_M: f64 = 1e6;

/// Largest angle of a table, radians. Chosen: headings may count turns, and degrees, which `gap` recognises, are within.
const LARGEST_RAD: f64 = 1e6;

const ODOMETRY_COLUMNS: [&str; 3] = ["odometry_x_m", "odometry_y_m", "odometry_yaw_rad"];

/// Record of one picture and of what the robot knew when it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameRecord {
    /// Time at which the picture was taken, seconds.
    pub timestamp_s: f64,
    /// Picture file, relative to the sequence's folder.
    pub image: PathBuf,
    /// Pose by dead reckoning since the start of the recording, in the odometry's own frame, if the robot has odometry.
    pub odometry: Option<Pose2>,
    /// Pitch of the camera from joints and IMU: depression of the optical axis below the horizon, radians.
    pub pitch_rad: f64,
    /// Roll of the camera from joints and IMU, clockwise seen from behind the camera, radians.
    pub roll_rad: f64,
    /// Pose of the camera from a source other than the pictures, such as motion capture, if known.
    pub reference_pose: Option<CameraPose>,
}

/// Parses the text of the file, without reference poses, which are in a file of their own.
pub(super) fn parse_frames(path: &Path, text: &str) -> Result<Vec<FrameRecord>, SequenceError> {
    let mut reader =
        ReaderBuilder::new().has_headers(false).flexible(true).trim(Trim::All).from_reader(text.as_bytes());
    let mut columns: Option<Columns> = None;
    let mut frames: Vec<FrameRecord> = Vec::new();
    let mut record = StringRecord::new();
    loop {
        let offset = reader.position().byte();
        let fail = |fault| SequenceError::at(path, record_line(text, offset), fault);
        let more =
            reader.read_record(&mut record).map_err(|error| fail(Fault::Csv(FormatError::new(error))))?;
        if !more {
            break;
        }
        if record.iter().all(str::is_empty) {
            continue;
        }
        let Some(columns) = &columns else {
            columns = Some(Columns::find(&record).map_err(fail)?);
            continue;
        };
        let frame = columns.frame(&record).map_err(fail)?;
        if let Some(previous) = frames.last().filter(|previous| previous.timestamp_s >= frame.timestamp_s) {
            let (previous_s, timestamp_s) = (previous.timestamp_s, frame.timestamp_s);
            return Err(fail(Fault::NotIncreasing { previous_s, timestamp_s }));
        }
        frames.push(frame);
    }
    if frames.is_empty() {
        return Err(SequenceError::of_file(path, Fault::NoFrames));
    }
    Ok(frames)
}

/// Returns the text of the file.
pub(super) fn print_frames(path: &Path, frames: &[FrameRecord]) -> Result<String, SequenceError> {
    let with_odometry = frames.iter().filter(|frame| frame.odometry.is_some()).count();
    if with_odometry != 0 && with_odometry != frames.len() {
        let rule = "either all frames have odometry or none";
        return Err(SequenceError::of_file(path, Fault::Inconsistent { rule }));
    }
    let mut text = String::from("timestamp_s,image,");
    if with_odometry > 0 {
        text.push_str(&ODOMETRY_COLUMNS.join(","));
        text.push(',');
    }
    text.push_str("pitch_rad,roll_rad\n");
    for frame in frames {
        let image = frame.image.to_str().ok_or_else(|| {
            let rule = "the pictures' names must be UTF-8";
            SequenceError::of_file(path, Fault::Inconsistent { rule })
        })?;
        text.push_str(&print_frame(frame, image));
    }
    Ok(text)
}

fn print_frame(frame: &FrameRecord, image: &str) -> String {
    let mut line = format!("{},{},", frame.timestamp_s, quoted(image));
    // Writing into a string cannot fail.
    if let Some(odometry) = frame.odometry {
        let _ = write!(line, "{},{},{},", odometry.x_m, odometry.y_m, odometry.yaw_rad);
    }
    let _ = writeln!(line, "{},{}", frame.pitch_rad, frame.roll_rad);
    line
}

/// Returns a name as a field of a table, in quotation marks if it needs them.
fn quoted(name: &str) -> String {
    let needs_quotes = name.contains([',', '"', '\n', '\r']);
    if needs_quotes { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// Returns the line of the record that starts at or after an offset, skipping blank lines and line ends before it.
fn record_line(text: &str, offset: u64) -> usize {
    let bytes = text.as_bytes();
    let start = usize::try_from(offset).map_or(bytes.len(), |offset| offset.min(bytes.len()));
    let blank = bytes[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    line_of_offset(bytes, start + blank)
}

/// Positions of the columns.
struct Columns {
    count: usize,
    timestamp_s: usize,
    image: usize,
    odometry: Option<[usize; 3]>,
    pitch_rad: usize,
    roll_rad: usize,
}

impl Columns {
    fn find(header: &StringRecord) -> Result<Self, Fault> {
        let required = |column| find_column(header, column)?.ok_or(Fault::MissingColumn { column });
        Ok(Self {
            count: header.len(),
            timestamp_s: required("timestamp_s")?,
            image: required("image")?,
            odometry: find_odometry(header)?,
            pitch_rad: required("pitch_rad")?,
            roll_rad: required("roll_rad")?,
        })
    }

    fn frame(&self, record: &StringRecord) -> Result<FrameRecord, Fault> {
        if record.len() != self.count {
            return Err(Fault::FieldCount { found: record.len(), expected: self.count });
        }
        let field = |column: usize| record.get(column).unwrap_or_default();
        let odometry = self.odometry.map(|columns| {
            let [x, y, yaw] = ODOMETRY_COLUMNS;
            Ok(Pose2::new(
                metres(x, field(columns[0]))?,
                metres(y, field(columns[1]))?,
                radians(yaw, field(columns[2]))?,
            ))
        });
        let image = PathBuf::from(field(self.image));
        if !is_inside_folder(&image) {
            return Err(Fault::PathLeavesFolder { name: excerpt(field(self.image)) });
        }
        Ok(FrameRecord {
            timestamp_s: seconds("timestamp_s", field(self.timestamp_s))?,
            image,
            odometry: odometry.transpose()?,
            pitch_rad: radians("pitch_rad", field(self.pitch_rad))?,
            roll_rad: radians("roll_rad", field(self.roll_rad))?,
            reference_pose: None,
        })
    }
}

fn find_column(header: &StringRecord, column: &'static str) -> Result<Option<usize>, Fault> {
    let mut places = header.iter().enumerate().filter(|(_, name)| *name == column).map(|(place, _)| place);
    match (places.next(), places.next()) {
        (_, Some(_)) => Err(Fault::DuplicateColumn { column }),
        (place, None) => Ok(place),
    }
}

fn find_odometry(header: &StringRecord) -> Result<Option<[usize; 3]>, Fault> {
    let mut places = [None; 3];
    for (place, column) in places.iter_mut().zip(ODOMETRY_COLUMNS) {
        *place = find_column(header, column)?;
    }
    match places {
        [Some(x), Some(y), Some(yaw)] => Ok(Some([x, y, yaw])),
        [None, None, None] => Ok(None),
        _ => {
            let missing = places.iter().position(Option::is_none).unwrap_or_default();
            Err(Fault::PartialOdometry { column: ODOMETRY_COLUMNS[missing] })
        }
    }
}

/// Parses a finite number from a field.
pub(super) fn number(column: &'static str, text: &str) -> Result<f64, Fault> {
    let value: f64 = text.parse().map_err(|_| Fault::NotANumber { column, text: excerpt(text) })?;
    if value.is_finite() { Ok(value) } else { Err(Fault::NotFinite { column }) }
}

/// Parses a time from a field, seconds.
pub(super) fn seconds(column: &'static str, text: &str) -> Result<f64, Fault> {
    bounded(column, text, LATEST_S, "in seconds, below 1e11: the year 5138, counted from 1970")
}

/// Parses a length from a field, metres.
pub(super) fn metres(column: &'static str, text: &str) -> Result<f64, Fault> {
    bounded(column, text, LONGEST_M, "in metres, from -1e6 to 1e6")
}

/// Parses an angle from a field, radians.
fn radians(column: &'static str, text: &str) -> Result<f64, Fault> {
    bounded(column, text, LARGEST_RAD, "in radians, from -1e6 to 1e6")
}

fn bounded(column: &'static str, text: &str, limit: f64, rule: &'static str) -> Result<f64, Fault> {
    let value = number(column, text)?;
    if value.abs() <= limit { Ok(value) } else { Err(Fault::BadValue { key: column, value, rule }) }
}
