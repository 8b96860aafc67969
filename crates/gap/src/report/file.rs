//! Reading of a report from its folder.

use std::{
    fmt, fs, io,
    path::{Path, PathBuf},
};

use reality_sim_core::sequence::{Printable, on_one_line};
use serde::{Deserialize, de::IgnoredAny};

use crate::{
    measurement::quantity::Channel,
    report::data::{Map, Maps, Report, VERSION},
};

/// Largest size of a report's file, bytes. Larger files are something else.
const LARGEST_BYTES: u64 = 64 << 20;
/// Name of the file in a report's folder.
const FILE: &str = "report.json";

/// Error for a report that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", Printable(.path), Line(*.line))]
pub struct ReportError {
    /// Path of the file.
    pub path: PathBuf,
    /// Line of the fault in the file, counted from 1, if it is known.
    pub line: Option<usize>,
    /// Fault of the file.
    pub fault: ReportFault,
}

/// Fault of a report's file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportFault {
    /// The file does not exist.
    #[error("there is no such file")]
    Missing,
    /// The path is a folder, pipe or device.
    #[error("is not a regular file")]
    NotAFile,
    /// The file is larger than any report.
    #[error("is larger than {LARGEST_BYTES} bytes: it cannot be a report")]
    TooLarge,
    /// The operating system cannot read the file.
    #[error("cannot be read ({0}): check the permissions and the disk")]
    Unreadable(#[source] io::Error),
    /// The file is not UTF-8.
    #[error("is not a report (it is no text)")]
    NotText,
    /// The file is not JSON, or not that of a report.
    #[error("is not a report ({})", without_place(.0))]
    Malformed(#[source] serde_json::Error),
    /// The report has another format version than this library's, or none, as those of earlier releases.
    #[error("{}, and this release reads version {VERSION}: analyse the recording again", FormatVersion(*.found))]
    Version {
        /// Format version of the file.
        found: Option<u32>,
    },
    /// The numbers of a map or a time course are inconsistent.
    #[error("the maps of {}: {contradiction}", .channel.name())]
    Contradiction {
        /// Channel of the maps.
        channel: Channel,
        /// Kind of the inconsistency.
        contradiction: Contradiction,
    },
}

/// Inconsistency of the numbers in a channel's maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Contradiction {
    /// The number of values differs from the number of cells.
    #[error("not as many values as cells")]
    Cells,
    /// The extent has no area.
    #[error("an extent without an area")]
    Extent,
    /// The number of values differs from the number of times.
    #[error("not as many values as times")]
    Times,
}

/// Returns the parser's message without its line and column, on one line: it quotes the file.
fn without_place(error: &serde_json::Error) -> String {
    let place = format!(" at line {} column {}", error.line(), error.column());
    on_one_line(&error.to_string().replace(&place, ""))
}

impl Report {
    /// Reads the report from `report.json` in a folder, in the form that its [`serde::Serialize`] writes. Maps of the result
    /// have as many values as cells and an extent with an area; time courses have as many values as times.
    ///
    /// # Errors
    ///
    /// Returns an error that names the file and the fault: [`ReportFault::Version`] for a report of another format version.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let path = folder.join(FILE);
        let fail = |line, fault| ReportError { path: path.clone(), line, fault };
        let text = text(&path).map_err(|fault| fail(None, fault))?;
        let malformed = |error: serde_json::Error| {
            fail((error.line() > 0).then(|| error.line()), ReportFault::Malformed(error))
        };
        let header: Header = serde_json::from_str(&text).map_err(malformed)?;
        if header.is_of_another_version() {
            return Err(fail(None, ReportFault::Version { found: header.version }));
        }
        let report: Self = serde_json::from_str(&text).map_err(malformed)?;
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
        let lengths = [course.held_out.len(), course.before.len(), course.after.len()];
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

/// Reads the file's bytes as text.
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

/// Fields that tell which version of the format a file has.
#[derive(Deserialize)]
struct Header {
    version: Option<u32>,
    /// Present in reports of every version.
    verdict: Option<IgnoredAny>,
}

impl Header {
    /// Whether the file is a report of another version. A file that has neither a version nor a verdict is no report.
    fn is_of_another_version(&self) -> bool {
        self.version != Some(VERSION) && (self.version.is_some() || self.verdict.is_some())
    }
}

/// Format version of a file, in words.
struct FormatVersion(Option<u32>);

impl fmt::Display for FormatVersion {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(version) => write!(formatter, "has format version {version}"),
            None => formatter.write_str("has no format version"),
        }
    }
}

/// Line number behind a file's name, if it is known.
struct Line(Option<usize>);

impl fmt::Display for Line {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(formatter, ":{line}"))
    }
}
