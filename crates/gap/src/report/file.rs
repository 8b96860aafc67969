//! A report read again from its folder.

use std::{
    fmt, fs, io,
    path::{Path, PathBuf},
};

use crate::report::data::{Map, Maps, Report};

/// A report takes less than this, bytes: larger files are something else.
const LARGEST_BYTES: u64 = 64 << 20;
/// The file in a report's folder.
const FILE: &str = "report.json";

/// A report that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", .path.display(), Line(*.line))]
pub struct ReportError {
    /// The file.
    pub path: PathBuf,
    /// Line in the file, from 1, where the fault has one.
    pub line: Option<usize>,
    /// What is wrong.
    pub fault: ReportFault,
}

/// What is wrong with a report. Every message says what to do.
#[derive(Debug, thiserror::Error)]
pub enum ReportFault {
    /// There is no such file.
    #[error("there is no such file: give a folder that `reality-sim gap` wrote")]
    Missing,
    /// A folder, pipe or device.
    #[error("is not a regular file: give a folder that `reality-sim gap` wrote")]
    NotAFile,
    /// More bytes than a report has.
    #[error(
        "is larger than {LARGEST_BYTES} bytes: it cannot be a report, give a folder that `reality-sim gap` wrote"
    )]
    TooLarge,
    /// The operating system does not give the bytes.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(io::Error),
    /// Not JSON, or not what a report holds.
    #[error("is not a report ({0}): write it again with `reality-sim gap`")]
    Malformed(String),
    /// A map or a course whose numbers do not fit together.
    #[error("{0}: write the report again with `reality-sim gap`")]
    Contradiction(String),
}

impl Report {
    /// Reads `report.json` in a folder that `reality-sim gap` wrote. Maps have as many values as cells and an extent with
    /// an area, courses as many as times. The error names the file, the fault and the remedy.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let path = folder.join(FILE);
        let fail = |line, fault| ReportError { path: path.clone(), line, fault };
        let text = text(&path).map_err(|fault| fail(None, fault))?;
        let report: Self = serde_json::from_str(&text).map_err(|error| {
            let place = format!(" at line {} column {}", error.line(), error.column());
            let message = error.to_string().replace(&place, "");
            fail((error.line() > 0).then(|| error.line()), ReportFault::Malformed(message))
        })?;
        match report.contradiction() {
            Some(contradiction) => Err(fail(None, ReportFault::Contradiction(contradiction))),
            None => Ok(report),
        }
    }

    fn contradiction(&self) -> Option<String> {
        self.maps.iter().find_map(|(channel, maps)| {
            let fault = maps.contradiction()?;
            Some(format!("the maps of {channel}: {fault}"))
        })
    }
}

impl Maps {
    fn contradiction(&self) -> Option<&'static str> {
        let course = &self.time;
        let frames = course.time_s.len();
        let lengths = [course.judged.len(), course.before.len(), course.after.len()];
        match () {
            () if !(self.picture.has_all_cells() && self.field.has_all_cells()) => {
                Some("not as many values as cells")
            }
            () if !(self.picture.has_area() && self.field.has_area()) => Some("an extent without an area"),
            () if lengths.iter().any(|length| *length != frames) => Some("not as many values as times"),
            () => None,
        }
    }
}

impl Map {
    fn has_all_cells(&self) -> bool {
        let cells = self.columns.checked_mul(self.rows);
        [&self.before, &self.after].iter().all(|values| Some(values.len()) == cells)
    }

    fn has_area(&self) -> bool {
        let [left, top, right, bottom] = self.extent;
        left != right && top != bottom
    }
}

/// The bytes of the file as text.
fn text(path: &Path) -> Result<String, ReportFault> {
    let metadata = fs::metadata(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => ReportFault::Missing,
        _ => ReportFault::Unreadable(error),
    })?;
    match () {
        () if !metadata.is_file() => Err(ReportFault::NotAFile),
        () if metadata.len() > LARGEST_BYTES => Err(ReportFault::TooLarge),
        () => {
            let bytes = fs::read(path).map_err(ReportFault::Unreadable)?;
            String::from_utf8(bytes).map_err(|_| ReportFault::Malformed("it is no text".to_owned()))
        }
    }
}

/// The line after a file's name, where there is one.
struct Line(Option<usize>);

impl fmt::Display for Line {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(formatter, ":{line}"))
    }
}
