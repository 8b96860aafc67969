//! Options of `gap`.

use std::{ops::Range, path::PathBuf};

use clap::Args;

use super::control::{Control, effect_id};
use crate::commands::{device::BackendArgs, frame_range::FrameRange};

/// Options of `gap`.
#[derive(Debug, Args)]
pub struct GapArgs {
    /// Folder of the sequence, which contains sequence.toml, or a robot's log
    pub sequence: PathBuf,
    /// Field on which a log was recorded: a field.toml, or the name of a preset
    #[arg(long, value_name = "FILE|PRESET")]
    pub field: Option<PathBuf>,
    /// Effects that the simulation already has: a model.toml, as this command writes it
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Folder for report.json, report.html, the extended model.toml and pictures
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Use only frames A to B − 1, counted from 0
    #[arg(long, value_name = "A..B", value_parser = FrameRange::parse)]
    pub frames: Option<FrameRange>,
    /// Seed; modulo 4, it chooses which quarter of the frames is held out
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Poses estimated from the pictures, as `tag --out` writes them, to use instead of the sequence's own
    #[arg(long, value_name = "FILE", conflicts_with = "tag")]
    pub poses: Option<PathBuf>,
    /// Find the poses by the particle filter, even if the sequence has reference poses
    #[arg(long)]
    pub tag: bool,
    /// Leave an effect out of the library, for control runs; may be given more than once
    #[arg(long, value_name = "ID", value_parser = effect_id)]
    pub without: Vec<String>,
    /// Find what has changed since an earlier recording by the same camera: the folder of its sequence
    #[arg(long, value_name = "EARLIER", conflicts_with_all = ["model", "inject", "poses"])]
    pub reference: Option<PathBuf>,
    /// Hide an effect in the pictures or files, as a control, and say whether it was named: ID=SIZE in the unit of model.toml,
    /// or all for a table of every effect
    #[arg(long, value_name = "ID=SIZE", value_parser = Control::parse)]
    pub inject: Option<Control>,
    #[command(flatten)]
    pub backend: BackendArgs,
    /// Also print report.json on standard output
    #[arg(long)]
    pub json: bool,
}

impl GapArgs {
    /// Returns the range of frames that is asked for among this many; none for all of them.
    pub fn frames_among(&self, count: usize) -> Option<Range<usize>> {
        self.frames.map(|range| range.among(count))
    }

    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        self.backend.check_usage()
    }
}
