//! Options of `calibrate`.

use std::path::PathBuf;

use clap::Args;

use reality_sim::calibration::LensModel;

use crate::commands::choice::one_of;

/// Options of `calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// Folder of the sequence, which contains sequence.toml
    pub sequence: PathBuf,
    /// Model of the lens [default: that of the sequence's camera.toml, or by the field of view]
    #[arg(long, value_parser = one_of::<LensModel>(LensModel::ALL.map(LensModel::name)))]
    pub model: Option<LensModel>,
    /// Rough field of view across the picture's width, degrees: the lens in camera.toml is then not used [default: 150 if there is
    /// no usable camera.toml]
    #[arg(long, value_name = "DEG", value_parser = fov_deg)]
    pub fov_deg: Option<f64>,
    /// Write the camera to this file, a camera.toml
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Write the poses of the pictures that were used to this file, in the TUM format
    #[arg(long, value_name = "FILE")]
    pub poses: Option<PathBuf>,
    /// Draw how uncertain the projection is where in the picture, into this SVG file
    #[arg(long, value_name = "FILE")]
    pub uncertainty: Option<PathBuf>,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

fn fov_deg(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|fov| (5.0..=340.0).contains(fov))
        .ok_or_else(|| "give a number of degrees from 5 to 340".to_owned())
}
