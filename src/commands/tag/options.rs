//! Options of `tag`, and their interpretation.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use anyhow::bail;
use clap::Args;

use reality_sim::{
    FieldDimensions, LocalizerConfig, ObservationKind, Pose2, Sequence,
    field::preset_names,
    filter::{Estimator, Resampling},
    pose::FARTHEST_M,
    sequence::{counted, read_field},
    tagging::TagSettings,
};

#[cfg(feature = "live")]
use crate::commands::serving::ServingArgs;
use crate::commands::{
    choice::{described, one_of},
    device::{BackendArgs, Device},
    frame_range::FrameRange,
    model_file::{ModelArgs, ModelFile},
};

/// Distance beyond which a jump of the odometry to its origin counts as a reset, metres.
const RESET_JUMP_M: f64 = 0.1;

/// Options of `tag`.
#[derive(Debug, Args)]
pub struct TagArgs {
    /// Folder of the sequence, which contains sequence.toml, or a robot's log
    pub sequence: PathBuf,
    /// Observation model, which weighs the particles
    #[arg(long, value_parser = one_of::<ObservationKind>(ObservationKind::ALL.map(|entry| described(entry.name(), entry.description()))), default_value_t)]
    observation: ObservationKind,
    /// Number of particles; with --adaptive, the largest number
    #[arg(long, default_value_t = 800, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    particles: u32,
    /// Iterations of weighing and resampling for each picture
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    iterations: u32,
    /// Resampling scheme
    #[arg(long, value_parser = one_of::<Resampling>(Resampling::ALL.map(Resampling::name)), default_value_t)]
    resampling: Resampling,
    /// Estimate of the pose from the particles
    #[arg(long, value_parser = one_of::<Estimator>(Estimator::ALL.map(|entry| described(entry.name(), entry.description()))), default_value_t)]
    estimator: Estimator,
    /// Adapt the number of particles to their spread (KLD-sampling)
    #[arg(long)]
    adaptive: bool,
    /// Use the whole recording for every pose: fit each picture to a fraction of a pixel, then smooth all poses with
    /// odometry and IMU
    #[arg(long)]
    pub smooth: bool,
    /// Seed of the random numbers: the same seed gives the same result
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    pub backend: BackendArgs,
    /// Standard deviation of the picture's Gaussian blur, pixels (gauss and contrast) [default: the model's own]
    #[arg(long, value_name = "PX", value_parser = blur_px)]
    blur: Option<f32>,
    /// The paper's α, above 0 (gauss and distance) [default: the model's own]
    #[arg(long, value_name = "A", value_parser = positive)]
    alpha: Option<f64>,
    /// Do not mask what lies outside the field's border (gauss and distance)
    #[arg(long)]
    no_border_mask: bool,
    /// Predict from the previous picture alone, without odometry, as in the paper
    #[arg(long)]
    no_odometry: bool,
    /// Pose of the first picture: metres, metres, radians [default: the sequence's]
    #[arg(long, value_name = "X,Y,YAW", value_parser = start_pose, allow_hyphen_values = true)]
    start: Option<Pose2>,
    /// Search the whole field for the first pose, even if the sequence gives one
    #[arg(long, conflicts_with = "start")]
    unknown_start: bool,
    /// Do not search the field when the pose is lost
    #[arg(long)]
    no_recovery: bool,
    /// Field to use instead of the sequence's: a field.toml, or the name of a preset
    #[arg(long, value_name = "FILE|PRESET")]
    pub field: Option<PathBuf>,
    /// Camera to use instead of the sequence's: a camera.toml
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    #[command(flatten)]
    pub model: ModelArgs,
    /// Write the poses to this file, in the TUM format; with the ending .mcap, everything that Foxglove shows
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write each picture's pose, standard deviations and filter state to this CSV file, or Parquet file by its ending
    #[arg(long, value_name = "FILE")]
    pub details: Option<PathBuf>,
    /// Write each picture, with lines, border, particles and a map drawn into it, to this folder
    #[arg(long, value_name = "FOLDER")]
    pub overlay: Option<PathBuf>,
    #[cfg(feature = "live")]
    #[command(flatten)]
    pub serving: ServingArgs,
    /// Process only frames A to B − 1, counted from 0; the start pose is then dead-reckoned by odometry
    #[arg(long, value_name = "A..B", value_parser = FrameRange::parse)]
    pub frames: Option<FrameRange>,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

fn start_pose(text: &str) -> Result<Pose2, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x_m, y_m, yaw_rad]) if x_m.is_finite() && y_m.is_finite() && yaw_rad.is_finite() => {
            let start = Pose2::new(x_m, y_m, yaw_rad);
            if x_m.hypot(y_m) <= FARTHEST_M {
                Ok(start)
            } else {
                Err(format!("give a place within {FARTHEST_M:.0} m of the field's centre"))
            }
        }
        _ => Err("give three finite numbers: metres, metres, radians".to_owned()),
    }
}

fn blur_px(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|sigma| (0.0..=50.0).contains(sigma))
        .ok_or_else(|| "give a number of pixels from 0 to 50".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|value: &f64| value.is_finite() && *value > 0.0)
        .ok_or_else(|| "give a number above 0".to_owned())
}

impl TagArgs {
    /// Refuses options that would have no effect.
    pub fn check_usage(&self) -> Result<(), String> {
        self.backend.check_usage()?;
        let (contrast, distance) =
            (self.observation == ObservationKind::Contrast, self.observation == ObservationKind::Distance);
        let ignored = [
            ("--alpha", self.alpha.is_some() && contrast),
            ("--no-border-mask", self.no_border_mask && contrast),
            ("--blur", self.blur.is_some() && distance),
        ];
        match ignored.iter().find(|(_, ignored)| *ignored) {
            Some((option, _)) => {
                Err(format!("{option} has no effect with this observation model: leave it out"))
            }
            None => Ok(()),
        }
    }

    /// Returns the device on which particles are weighted.
    pub fn device(&self) -> anyhow::Result<Device> {
        if self.adaptive {
            return self.backend.processor_only("--adaptive");
        }
        self.backend.device()
    }

    /// Returns the settings of the filter.
    pub fn config(&self) -> LocalizerConfig {
        let settings = TagSettings {
            observation: self.observation,
            particles: self.particles as usize,
            iterations: self.iterations,
            resampling: self.resampling,
            estimator: self.estimator,
            adaptive: self.adaptive,
            smooth: self.smooth,
            seed: self.seed,
            blur_px: self.blur,
            alpha: self.alpha,
            border_mask: !self.no_border_mask,
            odometry: !self.no_odometry,
            recovery: !self.no_recovery,
            known_start: !self.unknown_start,
            calibration_errors: self.details.is_some(),
        };
        settings.config()
    }

    /// Opens the sequence and applies the options: another camera or field, a model, fewer frames, another start.
    pub fn open_sequence(&self, folder: &Path, model: Option<&ModelFile>) -> anyhow::Result<Sequence> {
        let mut sequence = Sequence::open_with_camera(folder, self.camera.as_deref())?;
        if let Some(field) = &self.field {
            sequence.field = field_by_name(field)?;
        }
        if let Some(model) = model {
            sequence = model.correct(&sequence)?;
        }
        let range = self.range(&sequence)?;
        sequence.start = match (self.start, self.unknown_start) {
            (Some(start), _) => Some(start),
            (None, true) => None,
            (None, false) => self.start_at(&sequence, range.start),
        };
        sequence.frames = sequence.frames[range].to_vec();
        Ok(sequence)
    }

    fn range(&self, sequence: &Sequence) -> anyhow::Result<Range<usize>> {
        let count = sequence.frames.len();
        let range = self.frames.map_or(0..count, |range| range.among(count));
        if range.is_empty() || range.end > count {
            let folder = sequence.folder.display();
            bail!("{folder}: has {}: give --frames within 0..{count}", counted(count, "frame"));
        }
        Ok(range)
    }

    /// Returns the pose of a frame by dead reckoning from the sequence's start; `None` if start or odometry is missing.
    fn start_at(&self, sequence: &Sequence, frame: usize) -> Option<Pose2> {
        let start = sequence.start?;
        if frame == 0 {
            return Some(start);
        }
        let odometry: Option<Vec<Pose2>> =
            sequence.frames[..=frame].iter().map(|record| record.odometry).collect();
        let odometry = odometry.filter(|_| !self.no_odometry)?;
        let reset = odometry.windows(2).any(|pair| {
            pair[1] == Pose2::default() && pair[0].motion_to(pair[1]).distance_m() > RESET_JUMP_M
        });
        (!reset).then(|| start.moved(odometry[0].motion_to(odometry[frame])))
    }

    /// Lists every file that the command reads.
    pub fn inputs(&self, sequence: &Sequence) -> Vec<PathBuf> {
        let mut inputs = sequence.files.clone();
        inputs.extend(sequence.frames.iter().map(|frame| sequence.folder.join(&frame.image)));
        inputs.extend([&self.camera, &self.field, &self.model.model].into_iter().flatten().cloned());
        inputs
    }
}

/// Returns a preset, or reads a field file.
pub fn field_by_name(name: &Path) -> anyhow::Result<FieldDimensions> {
    if let Some(field) = name.to_str().and_then(FieldDimensions::preset) {
        return Ok(field);
    }
    if !name.exists() {
        let presets: Vec<&str> = preset_names().collect();
        let (name, presets) = (name.display(), presets.join(", "));
        bail!("{name}: is neither a file nor a field preset: give a field.toml, or one of {presets}");
    }
    Ok(read_field(name)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_is_three_finite_numbers() {
        assert_eq!(start_pose("-1.5, 2,0.25"), Ok(Pose2::new(-1.5, 2.0, 0.25)));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,x", "NaN,0,0", "inf,0,0"] {
            assert!(start_pose(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        assert_eq!(blur_px("1.5"), Ok(1.5));
        assert!(["-1", "51", "NaN", "x"].iter().all(|text| blur_px(text).is_err()));
        assert_eq!(positive("1e3"), Ok(1e3));
        assert!(["0", "-1", "inf", "NaN", "x"].iter().all(|text| positive(text).is_err()));
    }
}
