//! Options of `stream`.

use std::path::PathBuf;

use clap::Args;

use reality_sim::synthesis::MethodKind;

#[cfg(feature = "live")]
use crate::commands::serving::ServingArgs;
use crate::commands::{
    choice::{described, one_of},
    model_file::ModelArgs,
    picture_at::SynthesisArgs,
    wanted_ball::{WantedBall, wanted_ball},
};

/// Options of `stream`.
#[derive(Debug, Args)]
pub struct StreamArgs {
    /// Database, as `build` makes it
    pub database: PathBuf,
    /// Poses of the camera and their times, a TUM file
    #[arg(long, value_name = "FILE")]
    pub path: PathBuf,
    /// Method by which the pictures are made
    #[arg(long, value_parser = one_of::<MethodKind>(MethodKind::ALL.map(|kind| described(kind.name(), kind.description()))), default_value_t)]
    pub method: MethodKind,
    /// Add a ball at this place on the field, as often as wanted: metres, metres, metres, sRGB [default of the last two:
    /// 0.065, FF8000]
    #[arg(long, value_name = "X,Y[,RADIUS_M[,RRGGBB]]", value_parser = wanted_ball, allow_hyphen_values = true)]
    pub ball: Vec<WantedBall>,
    /// Leave out depth, classes and instances of the pixels
    #[arg(long)]
    pub no_labels: bool,
    /// Write the messages to this MCAP file, which `ros2 bag play` plays
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[cfg(feature = "live")]
    #[command(flatten)]
    pub serving: ServingArgs,
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub synthesis: SynthesisArgs,
    /// Print the report as one JSON object
    #[arg(long)]
    pub json: bool,
}

impl StreamArgs {
    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        if self.out.is_none() && !self.is_served() {
            return Err("nobody would get the messages: give --out, or --serve".to_owned());
        }
        self.synthesis.backend.check_usage()
    }

    #[cfg(feature = "live")]
    fn is_served(&self) -> bool {
        self.serving.is_wanted()
    }

    #[cfg(not(feature = "live"))]
    fn is_served(&self) -> bool {
        false
    }
}
