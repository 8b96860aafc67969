//! Options of `dataset`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use reality_sim::{
    dataset::{self, DatasetSettings, Numbers},
    synthesis::MethodKind,
};

use crate::commands::{
    choice::{described, one_of},
    model_file::ModelArgs,
    picture_at::SynthesisArgs,
};

/// Methods whose pictures show exactly what is seen from the pose, so that labels fit.
const METHODS: [MethodKind; 3] = [MethodKind::Auto, MethodKind::Plane, MethodKind::Blend];

/// Options of `dataset`.
#[derive(Debug, Args)]
pub struct DatasetArgs {
    /// Database, as `build` makes it
    pub database: PathBuf,
    /// Number of pictures
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub count: u32,
    /// Seed of poses and things; a picture depends on the seed and its number alone
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Folder for images, masks and annotations.json; a run that was interrupted goes on where it ended
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Method by which the pictures are made
    #[arg(long, default_value_t, value_parser = one_of::<MethodKind>(METHODS.map(|kind| described(kind.name(), kind.description()))))]
    pub method: MethodKind,
    /// Largest distance of the nearest recorded picture, root mean square pixels
    #[arg(long, default_value_t = DatasetSettings::default().within, value_name = "PX", value_parser = distance_px)]
    pub within: f64,
    /// Number of balls in a picture, each number as often
    #[arg(long, value_name = "MIN..MAX", default_value_t = DatasetSettings::default().balls)]
    pub balls: Numbers,
    /// Number of robots in a picture, each number as often
    #[arg(long, value_name = "MIN..MAX", default_value_t = DatasetSettings::default().robots)]
    pub robots: Numbers,
    /// Make pictures of this camera.toml instead of the camera that took the recorded ones
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    #[command(flatten)]
    pub model: ModelArgs,
    /// Format of the pictures
    #[arg(long, value_enum, default_value_t)]
    pub format: PictureFormat,
    /// Write also the distance of every pixel, millimetres, as 16-bit pictures
    #[arg(long)]
    pub depth: bool,
    /// Write also which thing every pixel shows, as 16-bit pictures
    #[arg(long)]
    pub instances: bool,
    /// Write also how far every pixel can be trusted, as 8-bit pictures
    #[arg(long)]
    pub trust: bool,
    #[command(flatten)]
    pub synthesis: SynthesisArgs,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Format of the pictures.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum PictureFormat {
    /// JPEG, of quality 95
    #[default]
    Jpg,
    /// PNG
    Png,
}

impl From<PictureFormat> for dataset::PictureFormat {
    fn from(format: PictureFormat) -> Self {
        match format {
            PictureFormat::Jpg => Self::Jpg,
            PictureFormat::Png => Self::Png,
        }
    }
}

fn distance_px(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "give a number of pixels above 0".to_owned())
}

impl DatasetArgs {
    /// Returns the settings that the options state.
    pub fn settings(&self) -> DatasetSettings {
        DatasetSettings {
            count: self.count,
            seed: self.seed,
            method: self.method,
            within: self.within,
            balls: self.balls,
            robots: self.robots,
            format: self.format.into(),
            depth: self.depth,
            instances: self.instances,
            trust: self.trust,
        }
    }

    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        self.synthesis.backend.check_usage()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_positive() {
        assert_eq!(distance_px("12.5"), Ok(12.5));
        for wrong in ["0", "-1", "inf", "NaN", ""] {
            assert!(distance_px(wrong).is_err(), "{wrong}");
        }
    }
}
