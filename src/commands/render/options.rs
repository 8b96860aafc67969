//! Options of `render`, and their interpretation.

use std::{fmt, path::PathBuf, str::FromStr};

use anyhow::bail;
use clap::{Args, builder::PossibleValue};

use reality_sim::{
    Archive, CameraPose, Pose2, StampedPose, names::UnknownName, sensor::Renderer, sequence::read_tum,
    synthesis::MethodKind,
};

use crate::commands::{
    choice::{described, one_of},
    output::{check_distinct, check_output_picture},
    output_folder::OutputFolder,
    picture_at::SynthesisArgs,
    wanted_ball::{WantedBall, wanted_ball},
};

/// Options of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Database, as `build` makes it
    pub database: PathBuf,
    /// Pose of the camera: metres, metres, radians, metres, radians, radians [default of the last three: those usual in
    /// the database]
    #[arg(long, value_name = "X,Y,YAW[,HEIGHT,PITCH,ROLL]", value_parser = wanted_pose, allow_hyphen_values = true)]
    pub pose: Option<WantedPose>,
    /// Make the pictures at all poses of this TUM file; --out is then a folder
    #[arg(long, value_name = "FILE", conflicts_with = "pose", required_unless_present = "pose")]
    pub path: Option<PathBuf>,
    /// Method by which the picture is made
    #[arg(long, value_parser = one_of::<PictureMethod>(methods()), default_value_t)]
    pub method: PictureMethod,
    /// Add a ball at this place on the field, as often as wanted: metres, metres, metres, sRGB [default of the last two:
    /// 0.065, FF8000]
    #[arg(long, value_name = "X,Y[,RADIUS_M[,RRGGBB]]", value_parser = wanted_ball, allow_hyphen_values = true)]
    pub ball: Vec<WantedBall>,
    /// Write the picture to this PNG or JPEG file; with --path, the pictures to this folder
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Write to this picture where the pixels came from: a colour for each recorded picture, brighter where it can be
    /// trusted more
    #[arg(long, value_name = "FILE", requires = "pose")]
    pub origins: Option<PathBuf>,
    /// Write to this picture how far each pixel can be trusted: white fully, black not at all
    #[arg(long, value_name = "FILE", requires = "pose")]
    pub trust: Option<PathBuf>,
    /// Write some pictures of the path, side by side, to this file
    #[arg(long, value_name = "FILE", requires = "path")]
    pub strip: Option<PathBuf>,
    /// Make the picture of this camera.toml instead of the camera that took the recorded ones
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// Effects of the camera, a model.toml as `gap` writes it. Recorded pictures are mixed without the lens's falloff and
    /// changes of the exposure. A simulated picture has all effects: at a single pose the camera stands still; along --path
    /// it moves as the poses and their times say
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    #[command(flatten)]
    pub synthesis: SynthesisArgs,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Method by which a picture is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureMethod {
    /// From recorded pictures.
    Recorded(MethodKind),
    /// From the model of the field.
    Simulated,
}

impl Default for PictureMethod {
    fn default() -> Self {
        Self::Recorded(MethodKind::default())
    }
}

impl fmt::Display for PictureMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Recorded(kind) => kind.fmt(formatter),
            Self::Simulated => formatter.pad(Renderer::NAME),
        }
    }
}

impl FromStr for PictureMethod {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        if name == Renderer::NAME { Ok(Self::Simulated) } else { name.parse().map(Self::Recorded) }
    }
}

/// Lists every method with its help.
fn methods() -> impl Iterator<Item = PossibleValue> {
    let recorded = MethodKind::ALL.into_iter().map(|kind| described(kind.name(), kind.description()));
    recorded.chain([described(Renderer::NAME, "The model of the field, drawn without any recorded picture")])
}

/// Pose whose last three numbers may be left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WantedPose {
    planar: Pose2,
    attitude: Option<[f64; 3]>,
}

fn wanted_pose(text: &str) -> Result<WantedPose, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|number| number.is_finite()));
    match numbers.as_deref() {
        Some(&[x_m, y_m, yaw_rad]) => {
            Ok(WantedPose { planar: Pose2::new(x_m, y_m, yaw_rad), attitude: None })
        }
        Some(&[x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad]) => Ok(WantedPose {
            planar: Pose2::new(x_m, y_m, yaw_rad),
            attitude: Some([height_m, pitch_rad, roll_rad]),
        }),
        _ => {
            Err("give three or six finite numbers: metres, metres, radians, metres, radians, radians"
                .to_owned())
        }
    }
}

impl RenderArgs {
    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        let wants_origins = self.origins.is_some() || self.trust.is_some();
        if self.method == PictureMethod::Simulated && wants_origins {
            return Err(
                "--origins, --trust: a simulated picture is not made from recorded ones: leave them out"
                    .to_owned(),
            );
        }
        if self.method == PictureMethod::Simulated && !self.ball.is_empty() {
            return Err(
                "--ball: balls are added to recorded pictures: choose another --method than simulated"
                    .to_owned(),
            );
        }
        if self.method == PictureMethod::Simulated && self.synthesis.is_clean() {
            return Err("--clean: in a simulated picture stands nobody: leave it out".to_owned());
        }
        self.synthesis.backend.check_usage()
    }

    /// Returns the requested poses with their times; numbers that a pose leaves out are the archive's usual ones. A single
    /// pose has time 0.
    pub fn poses(&self, archive: &Archive) -> anyhow::Result<Vec<StampedPose>> {
        let usual = archive.usual_pose();
        match (&self.pose, &self.path) {
            (Some(WantedPose { planar, attitude }), _) => {
                let [height_m, pitch_rad, roll_rad] =
                    attitude.unwrap_or([usual.height_m, usual.pitch_rad, usual.roll_rad]);
                let pose = CameraPose::new(*planar, height_m, pitch_rad, roll_rad);
                Ok(vec![StampedPose { timestamp_s: 0.0, pose }])
            }
            (None, Some(file)) => {
                let poses = read_tum(file)?;
                if poses.is_empty() {
                    bail!("{}: contains no poses: give a TUM file with one pose a line", file.display());
                }
                Ok(poses)
            }
            // Clap requires one of the two options.
            (None, None) => bail!("give --pose or --path"),
        }
    }

    /// Checks the outputs first: nobody should wait for a thousand pictures and learn then that one cannot be written. Returns
    /// the folder of a path's pictures.
    pub fn check_outputs(&self) -> anyhow::Result<Option<OutputFolder>> {
        let inputs: Vec<PathBuf> =
            [Some(&self.database), self.path.as_ref(), self.camera.as_ref(), self.model.as_ref()]
                .into_iter()
                .flatten()
                .cloned()
                .collect();
        let beside = [&self.origins, &self.trust, &self.strip].into_iter().flatten();
        check_distinct(&std::iter::once(&self.out).chain(beside.clone()).collect::<Vec<_>>())?;
        beside.clone().try_for_each(|output| check_output_picture(output, &inputs))?;
        match self.path {
            Some(_) => {
                let folder = OutputFolder::check(&self.out, &inputs)?;
                if let Some(strip) = self.strip.as_ref().filter(|strip| strip.parent() == Some(&self.out)) {
                    bail!(
                        "{}: lies in the folder of the path's pictures: give another folder",
                        strip.display()
                    );
                }
                Ok(Some(folder))
            }
            None => check_output_picture(&self.out, &inputs).map(|()| None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_three_or_six_finite_numbers() {
        let planar = Pose2::new(-1.0, 0.5, 2.0);
        assert_eq!(wanted_pose("-1, 0.5,2"), Ok(WantedPose { planar, attitude: None }));
        let whole = WantedPose { planar, attitude: Some([0.5, 0.4, 0.1]) };
        assert_eq!(wanted_pose("-1,0.5,2,0.5,0.4,0.1"), Ok(whole));
        for wrong in ["", "1,2", "1,2,3,4", "1,2,NaN", "1,2,3,4,5,inf", "a,b,c"] {
            assert!(wanted_pose(wrong).is_err(), "{wrong}");
        }
    }
}
