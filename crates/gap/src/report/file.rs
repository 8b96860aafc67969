//! A report read again from its folder.

use std::{
    fmt, fs, io,
    path::{Path, PathBuf},
};

use crate::{
    measurement::quantity::Channel,
    report::data::{Map, Maps, Report},
};

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

/// What is wrong with a report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportFault {
    /// There is no such file.
    #[error("there is no such file")]
    Missing,
    /// A folder, pipe or device.
    #[error("is not a regular file")]
    NotAFile,
    /// More bytes than a report has.
    #[error("is larger than {LARGEST_BYTES} bytes: it cannot be a report")]
    TooLarge,
    /// The operating system does not give the bytes.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(#[source] io::Error),
    /// Not UTF-8.
    #[error("is not a report (it is no text)")]
    NotText,
    /// Not JSON, or not what a report holds.
    #[error("is not a report ({})", without_place(.0))]
    Malformed(#[source] serde_json::Error),
    /// A map or a course whose numbers do not fit together.
    #[error("the maps of {}: {contradiction}", .channel.name())]
    Contradiction {
        /// Channel of the maps.
        channel: Channel,
        /// What does not fit.
        contradiction: Contradiction,
    },
}

/// Numbers of a channel's maps that do not fit together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Contradiction {
    /// Not as many values as cells.
    #[error("not as many values as cells")]
    Cells,
    /// An extent without an area.
    #[error("an extent without an area")]
    Extent,
    /// Not as many values as times.
    #[error("not as many values as times")]
    Times,
}

/// The parser's message without the line and the column.
fn without_place(error: &serde_json::Error) -> String {
    let place = format!(" at line {} column {}", error.line(), error.column());
    error.to_string().replace(&place, "")
}

impl Report {
    /// Reads `report.json`, the report as its [`serde::Serialize`] writes it, in a folder. Maps then have as many values as
    /// cells and an extent with an area, courses as many as times. The error names the file and the fault.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let path = folder.join(FILE);
        let fail = |line, fault| ReportError { path: path.clone(), line, fault };
        let text = text(&path).map_err(|fault| fail(None, fault))?;
        let report: Self = serde_json::from_str(&text)
            .map_err(|error| fail((error.line() > 0).then(|| error.line()), ReportFault::Malformed(error)))?;
        report.contradiction().map_or(Ok(()), |fault| Err(fail(None, fault)))?;
        Ok(report)
    }

    fn contradiction(&self) -> Option<ReportFault> {
        self.maps.iter().find_map(|(&channel, maps)| {
            Some(ReportFault::Contradiction { channel, contradiction: maps.contradiction()? })
        })
    }
}

impl Maps {
    fn contradiction(&self) -> Option<Contradiction> {
        let course = &self.time;
        let frames = course.time_s.len();
        let lengths = [course.judged.len(), course.before.len(), course.after.len()];
        match () {
            () if !(self.picture.has_all_cells() && self.field.has_all_cells()) => Some(Contradiction::Cells),
            () if !(self.picture.has_area() && self.field.has_area()) => Some(Contradiction::Extent),
            () if lengths.iter().any(|length| *length != frames) => Some(Contradiction::Times),
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
            String::from_utf8(bytes).map_err(|_| ReportFault::NotText)
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
