//! Contents of a report as enums and numbers. [`super::text`] puts them into words, [`super::json`] into a file.

use std::collections::BTreeMap;

use reality_sim_core::field::FieldDimensions;
use serde::{Deserialize, Serialize};

use crate::{
    diagnostics::{finding::Finding, object::Object},
    inference::{detection_limit::UnobservableCause, held_out::ChannelGap},
    measurement::quantity::Channel,
    recording::ReferenceSource,
};

/// Version of the format of `report.json`. It changes when a reader of earlier reports would misread newer ones or the reverse.
pub(crate) const VERSION: u32 = 2;

/// Verdict on a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// No effect is missing that these frames would show.
    None,
    /// Effects were found, and nothing significant is left unexplained.
    Named,
    /// An effect was found that these frames cannot distinguish from others.
    Confusable,
    /// A significant residual is left that fits no effect.
    Unknown,
    /// These frames do not suffice for a verdict.
    Inconclusive,
}

/// Number with its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Value of the number.
    pub value: f64,
    /// Standard deviation of the value.
    pub sigma: f64,
    /// Unit of the number, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Whether the value lies at the end of what is plausible: it is then no measurement, and the standard deviation means
    /// nothing.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_range_end: bool,
}

/// Effect of the extended model.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EffectReport {
    /// Id as in `model.toml`.
    pub id: String,
    /// Estimates by the names of the parameters.
    pub parameters: BTreeMap<String, Estimate>,
    /// Correlations of the estimates' errors, −1 to 1, by the names of two parameters: each pair once.
    #[serde(default)]
    pub correlations: BTreeMap<String, BTreeMap<String, f64>>,
    /// Values in the given model, by the names of the parameters; empty for an effect that the given model lacks.
    #[serde(default)]
    pub given: BTreeMap<String, f64>,
    /// P-value of the effect, corrected for the number of effects tested.
    pub p_value: f64,
    /// Gain in log-likelihood on frames that the fit has not seen.
    pub held_out_gain: Estimate,
    /// Ids of effects that explain these frames equally well.
    pub confusable_with: Vec<String>,
    /// Fraction of the distance to the noise floor that this effect alone closes, for the channels in which it closes some.
    pub closes: BTreeMap<Channel, f64>,
}

/// Gap over all channels, in units of the noise floor.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Gap {
    /// Gap with the model as it was given: root mean square over channels of the residuals, in units of each channel's noise
    /// floor.
    pub before: f64,
    /// Gap with the extended model.
    pub after: f64,
    /// Gap that noise alone causes.
    pub floor: f64,
    /// Gap of every channel.
    pub channels: BTreeMap<Channel, ChannelGap>,
}

/// Effect that was not found, with its detection limit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct NotFoundReport {
    /// Id as in `model.toml`.
    pub id: String,
    /// Name of the parameter that the limit refers to.
    pub parameter: String,
    /// Size at which the effect would have been found.
    pub detection_limit: Limit,
    /// P-value of the effect in this recording, corrected for the number of effects tested.
    pub p_value: f64,
    /// Gain in log-likelihood on frames that the fit has not seen.
    pub held_out_gain: Estimate,
}

/// Size with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Value of the size.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
}

/// Effect that cannot be seen in these frames.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Unobservable {
    /// Id as in `model.toml`.
    pub id: String,
    /// Reason why the effect cannot be seen.
    pub cause: UnobservableCause,
}

/// Medians of residuals on a grid, row by row; none (`null`) where nothing was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Map {
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// Extent of the grid as left, top, right and bottom; in pixels for the picture, in metres for the field.
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
    /// Whether each frame is held out.
    pub held_out: Vec<bool>,
    /// Sizes with the model as it was given.
    pub before: Vec<Option<f64>>,
    /// Sizes with the extended model.
    pub after: Vec<Option<f64>>,
}

/// Distribution of a channel's residuals in the picture, on the field and over time, in the channel's unit.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Maps {
    /// Residuals in the picture.
    pub picture: Map,
    /// Residuals on the field, with x along the field and y to the left.
    pub field: Map,
    /// Residuals over time.
    pub time: Course,
}

/// Source and scatter of the reference poses.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct PosesReport {
    /// Source of the poses.
    pub source: ReferenceSource,
    /// Scatter of rotations about the axes to the right, down and forward of the heading, radians.
    pub rotation_sigma_rad: [f64; 3],
    /// Scatter of positions in the world, metres.
    pub position_sigma_m: [f64; 3],
}

/// Everything that was found in a recording.
///
/// Its [`serde::Serialize`] writes `report.json`, with the version of the format and the words beside the numbers, and
/// [`Report::read`] reads that file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Report {
    /// Name of the recording.
    pub recording: String,
    /// Number of frames that were compared.
    pub frames: usize,
    /// Number of held-out frames, which no fit has seen.
    pub held_out_frames: usize,
    /// Picture files of frames that were left out because the picture is broken or missing.
    pub left_out: Vec<String>,
    /// Verdict on the recording.
    pub verdict: Verdict,
    /// Effects that were found, the most certain first.
    pub effects: Vec<EffectReport>,
    /// Effects of the given model, refitted.
    pub in_model: Vec<EffectReport>,
    /// Findings that no effect explains.
    #[serde(deserialize_with = "super::json::findings")]
    pub unexplained: Vec<Finding>,
    /// Things on the carpet, those that stand first. They are ordinary and no part of the verdict.
    pub objects: Vec<Object>,
    /// Gap on held-out frames.
    pub gap: Gap,
    /// Effects that were not found.
    pub not_found: Vec<NotFoundReport>,
    /// Effects that cannot be seen.
    pub unobservable: Vec<Unobservable>,
    /// Source and scatter of the reference poses.
    pub poses: PosesReport,
    /// Distribution of the residuals, by channel.
    pub maps: BTreeMap<Channel, Maps>,
    /// Index in the recording of the frame that the report's pictures show.
    pub shown_frame: usize,
    /// Seed that chose the held-out frames.
    pub seed: u64,
    /// Dimensions of the recorded field.
    pub field: FieldDimensions,
}

impl Report {
    /// Returns the ids of effects that cannot be judged because the recording's files lack what they are compared with. With
    /// the verdict [`Verdict::None`], nothing is missing among the others.
    pub fn not_judged(&self) -> impl Iterator<Item = &str> {
        let missing = self.unobservable.iter().filter(|effect| !effect.cause.is_lack_of_movement());
        missing.map(|effect| effect.id.as_str())
    }
}
