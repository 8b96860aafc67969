//! What was found, as enums and numbers. [`super::text`] makes the words of it, [`super::json`] the file.

use std::collections::BTreeMap;

use reality_sim_core::field::FieldDimensions;
use serde::{Deserialize, Serialize};

use crate::{
    diagnostics::finding::Finding,
    inference::{detection_limit::UnobservableCause, held_out::ChannelGap},
    measurement::quantity::Channel,
    recording::ReferenceSource,
};

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Nothing is missing that these frames would show.
    None,
    /// Effects were named, and nothing significant is left.
    Named,
    /// An effect was found that these frames cannot tell from others.
    Confusable,
    /// Something significant is left that is in no effect's shape.
    Unknown,
    /// These frames cannot tell.
    Inconclusive,
}

/// A number with its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Its unit, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

/// An effect of the extended model.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EffectReport {
    /// Id as in `model.toml`.
    pub id: String,
    /// Estimates by the names of the parameters.
    pub parameters: BTreeMap<String, Estimate>,
    /// Correlations of the estimates' errors, −1 to 1, by the names of two parameters: each pair once.
    #[serde(default)]
    pub correlations: BTreeMap<String, BTreeMap<String, f64>>,
    /// Values that the model had before, by the names of the parameters; empty for an effect that it did not have.
    #[serde(default)]
    pub given: BTreeMap<String, f64>,
    /// How unlikely it is chance, corrected for the number of effects tested.
    pub p_value: f64,
    /// Gain in log-likelihood on frames that the fit has not seen.
    pub held_out_gain: Estimate,
    /// Ids of effects that explain these frames as well.
    pub confusable_with: Vec<String>,
    /// Part of the distance to the noise floor that the effect alone closes, by channel: those in which it closes some.
    pub closes: BTreeMap<Channel, f64>,
}

/// The whole gap, in noise floors.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Gap {
    /// With the model as it was given: root mean square over channels of residuals in units of their noise floor.
    pub before: f64,
    /// With the extended model.
    pub after: f64,
    /// What noise alone makes.
    pub floor: f64,
    /// The gap of every channel.
    pub channels: BTreeMap<Channel, ChannelGap>,
}

/// An effect that was not found, with how large it would have to be.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct NotFoundReport {
    /// Id as in `model.toml`.
    pub id: String,
    /// Name of the parameter that the limit is of.
    pub parameter: String,
    /// Size at which it would have been found.
    pub detection_limit: Limit,
    /// How unlikely what was seen of it is chance, corrected for the number of effects tested.
    pub p_value: f64,
    /// Gain in log-likelihood on frames that the fit has not seen.
    pub held_out_gain: Estimate,
}

/// A size with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// The size.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

/// An effect that cannot be seen in these frames.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Unobservable {
    /// Id as in `model.toml`.
    pub id: String,
    /// Why it cannot be seen.
    pub cause: UnobservableCause,
}

/// Medians of residuals on a grid, row by row; not a number (`null`) where nothing was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Map {
    /// Cells along x.
    pub columns: usize,
    /// Cells along y.
    pub rows: usize,
    /// Extent of the grid: left, top, right, bottom; pixels for the picture, metres for the field.
    pub extent: [f64; 4],
    /// Medians with the model as it was given.
    pub before: Vec<Option<f64>>,
    /// Medians with the extended model.
    pub after: Vec<Option<f64>>,
}

/// Sizes of a channel's residuals frame by frame: 1.4826 times the median of their absolute values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// Times of the frames, seconds.
    pub time_s: Vec<f64>,
    /// Whether a frame was kept for judging.
    pub judged: Vec<bool>,
    /// Sizes with the model as it was given.
    pub before: Vec<Option<f64>>,
    /// Sizes with the extended model.
    pub after: Vec<Option<f64>>,
}

/// Where a channel's residuals are, in the channel's unit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Maps {
    /// In the picture.
    pub picture: Map,
    /// On the field, x along the field, y to the left.
    pub field: Map,
    /// Over time.
    pub time: Course,
}

/// The reference poses.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct PosesReport {
    /// What the poses come from.
    pub source: ReferenceSource,
    /// Scatter of rotations about the axes to the right, down and forward of the heading, radians.
    pub rotation_sigma_rad: [f64; 3],
    /// Scatter of positions in the world, metres.
    pub position_sigma_m: [f64; 3],
}

/// Everything that was found in a recording.
///
/// It is written as `report.json`, the words beside the numbers, by its [`serde::Serialize`], and read again by
/// [`Report::read`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Report {
    /// Name of the recording.
    pub recording: String,
    /// Number of frames that were compared.
    pub frames: usize,
    /// Number of those that no fit has seen.
    pub judged_frames: usize,
    /// Files of the frames without a whole picture.
    pub left_out: Vec<String>,
    /// The answer in one word.
    pub verdict: Verdict,
    /// Effects that were found, the surest first.
    pub effects: Vec<EffectReport>,
    /// Effects that the model had before, refitted.
    pub in_model: Vec<EffectReport>,
    /// What no effect explains.
    #[serde(deserialize_with = "super::json::findings")]
    pub unexplained: Vec<Finding>,
    /// The gap on frames that no fit has seen.
    pub gap: Gap,
    /// Effects that were not found.
    pub not_found: Vec<NotFoundReport>,
    /// Effects that cannot be seen.
    pub unobservable: Vec<Unobservable>,
    /// The reference poses.
    pub poses: PosesReport,
    /// Where residuals are, by channel.
    pub maps: BTreeMap<Channel, Maps>,
    /// Index in the recording of the frame in the pictures of the report.
    pub shown_frame: usize,
    /// Seed that chose the frames kept for judging.
    pub seed: u64,
    /// The field that was recorded.
    pub field: FieldDimensions,
}
