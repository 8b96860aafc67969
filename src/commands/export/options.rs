//! Options of `export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use reality_sim_formats::{
    colmap::Encodings,
    undistort::{Border, Undistortion},
};

/// Format of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// A COLMAP model with its pictures, in a folder
    Colmap,
    /// A transforms.json of nerfstudio with its pictures, in a folder
    Nerfstudio,
    /// The poses alone, in a TUM file
    Tum,
    /// An MCAP file that Foxglove shows: pictures, calibration, poses, the field's lines
    Mcap,
    /// A Parquet table with one row a picture: pose, covariance, filter state, quality
    Parquet,
}

impl Format {
    /// Returns the name in options and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Colmap => "colmap",
            Self::Nerfstudio => "nerfstudio",
            Self::Tum => "tum",
            Self::Mcap => "mcap",
            Self::Parquet => "parquet",
        }
    }

    /// Returns whether the output is a folder.
    pub fn is_folder(self) -> bool {
        matches!(self, Self::Colmap | Self::Nerfstudio)
    }
}

/// Options of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Database, as `build` makes it, or folder of a sequence
    pub source: PathBuf,
    /// Poses of a sequence, as `tag --out` writes them [default: its ground truth]
    #[arg(long, value_name = "FILE")]
    pub poses: Option<PathBuf>,
    /// Format of the output
    #[arg(long, value_enum)]
    pub format: Format,
    /// Folder or file to write
    #[arg(long, value_name = "PATH")]
    pub out: PathBuf,
    /// Take covariances and filter state from this file of `tag --details` (parquet, of a sequence)
    #[arg(long, value_name = "FILE", conflicts_with = "poses")]
    pub details: Option<PathBuf>,
    /// Do not decode the pictures to measure brightness and sharpness (parquet)
    #[arg(long)]
    pub no_quality: bool,
    /// Write only COLMAP's text files [default: both]
    #[arg(long, conflicts_with = "binary")]
    text: bool,
    /// Write only COLMAP's binary files [default: both]
    #[arg(long)]
    binary: bool,
    /// Write pictures as a camera without distortion would have taken them
    #[arg(long)]
    undistort: bool,
    /// Field of view of undistorted pictures, across their width, degrees [default: what the camera sees, at most 100]
    #[arg(long, value_name = "DEG", requires = "undistort", value_parser = fov_deg)]
    fov_deg: Option<f64>,
    /// What is put where an undistorted picture shows nothing: black, or transparent pixels of a PNG
    #[arg(long, value_enum, requires = "undistort", default_value_t = BorderChoice::Black)]
    border: BorderChoice,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BorderChoice {
    Black,
    Alpha,
}

fn fov_deg(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|degrees| (1.0..=170.0).contains(degrees))
        .ok_or_else(|| "give a number of degrees from 1 to 170".to_owned())
}

impl ExportArgs {
    /// Refuses options that would have no effect.
    pub fn check_usage(&self) -> Result<(), String> {
        let ignored = [
            ("--text", self.text && self.format != Format::Colmap),
            ("--binary", self.binary && self.format != Format::Colmap),
            ("--details", self.details.is_some() && self.format != Format::Parquet),
            ("--no-quality", self.no_quality && self.format != Format::Parquet),
            ("--undistort", self.undistort && !self.format.is_folder()),
        ];
        match ignored.iter().find(|(_, ignored)| *ignored) {
            Some((option, _)) => Err(format!("{option} has no effect with this format: leave it out")),
            None => Ok(()),
        }
    }

    /// Returns the kinds of COLMAP's files that are wanted.
    pub fn encodings(&self) -> Encodings {
        Encodings { text: !self.binary, binary: !self.text }
    }

    /// Returns how pictures are undistorted, if that is wanted.
    pub fn undistortion(&self) -> Option<Undistortion> {
        let border = match self.border {
            BorderChoice::Black => Border::Black,
            BorderChoice::Alpha => Border::Transparent,
        };
        self.undistort.then(|| Undistortion { fov_rad: self.fov_deg.map(f64::to_radians), border })
    }
}
