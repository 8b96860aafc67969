//! What was found, as it is written.

use std::collections::BTreeMap;

use reality_sim_core::field::FieldDimensions;
use reality_sim_sensor::effect;
use serde::{Deserialize, Serialize};

use crate::{inference::held_out::ChannelGap, report::text};

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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectReport {
    /// As in `model.toml`.
    pub id: String,
    /// In plain words.
    pub name: String,
    /// Its size in plain words: "at the corner 42 % of the light is lost (± 1 %)".
    pub size: String,
    /// By name.
    pub parameters: BTreeMap<String, Estimate>,
    /// How unlikely it is chance, corrected for the number of effects tested.
    pub p_value: f64,
    /// Gain in log-likelihood on frames that the fit has not seen.
    pub held_out_gain: Estimate,
    /// Effects that explain these frames as well.
    pub confusable_with: Vec<String>,
    /// What would tell them apart; empty where there are none.
    pub recording_that_would_decide: Vec<String>,
    /// On what signature the name rests.
    pub because: String,
    /// Part of the distance to the noise floor that the effect alone closes, by channel: those in which it closes some.
    pub closes: BTreeMap<String, f64>,
}

/// Something significant that no effect explains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unexplained {
    /// In which comparison.
    pub channel: String,
    /// In words.
    pub r#where: String,
    /// In the channel's unit.
    pub size: f64,
    /// The channel's.
    pub unit: String,
    /// How unlikely it is chance. None for what is counted and not tested: lines that are not there, things in the way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_value: Option<f64>,
}

/// The whole gap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gap {
    /// With the model as it was given: root mean square over channels of residuals in units of their noise floor.
    pub before: f64,
    /// With the extended model.
    pub after: f64,
    /// What noise alone makes.
    pub floor: f64,
    /// Of the three.
    pub unit: String,
    /// By channel.
    pub channels: BTreeMap<String, ChannelGap>,
}

/// An effect that was not found, with how large it would have to be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NotFoundReport {
    /// As in `model.toml`.
    pub id: String,
    /// In plain words.
    pub name: String,
    /// The parameter that the limit is of.
    pub parameter: String,
    /// It would have been found at this size.
    pub detection_limit: Limit,
    /// How unlikely what was seen of it is chance, corrected for the number of effects tested.
    pub p_value: f64,
    /// Gain in log-likelihood on frames that the fit has not seen.
    pub held_out_gain: Estimate,
}

impl NotFoundReport {
    /// The limit as a person says it: "0.08°", "4.0 ms".
    pub fn limit_in_words(&self) -> String {
        let Limit { value, unit } = &self.detection_limit;
        match effect(&self.id) {
            Some(effect) => effect.limit_in_words(&self.parameter, *value),
            None => format!("{} = {} {unit}", self.parameter, text::digits(*value, 2)),
        }
    }
}

/// A size of a channel's residuals, in its unit, as a person says it: "0.13 px²", "7.4 %".
pub fn size_in_words(channel: &str, size: f64, unit: &str) -> String {
    text::amount(channel, size, unit, 3)
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unobservable {
    /// As in `model.toml`.
    pub id: String,
    /// In plain words.
    pub name: String,
    /// Why.
    pub reason: String,
    /// What to record to see it, or what to add to the recording's files.
    pub recording_that_would_decide: String,
}

/// Medians of residuals on a grid, row by row; not a number (`null`) where nothing was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Map {
    /// Cells along x.
    pub columns: usize,
    /// Cells along y.
    pub rows: usize,
    /// Where the grid lies: left, top, right, bottom; pixels for the picture, metres for the field.
    pub extent: [f64; 4],
    /// With the model as it was given.
    pub before: Vec<Option<f64>>,
    /// With the extended model.
    pub after: Vec<Option<f64>>,
}

/// Sizes of a channel's residuals frame by frame: 1.4826 times the median of their absolute values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// Times, seconds.
    pub time_s: Vec<f64>,
    /// Whether a frame was kept for judging.
    pub judged: Vec<bool>,
    /// With the model as it was given.
    pub before: Vec<Option<f64>>,
    /// With the extended model.
    pub after: Vec<Option<f64>>,
}

/// Where a channel's residuals are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Maps {
    /// The channel's unit.
    pub unit: String,
    /// In the picture.
    pub picture: Map,
    /// On the field, x along the field, y to the left.
    pub field: Map,
    /// Over time.
    pub time: Course,
}

/// The reference poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PosesReport {
    /// `measured` or `tagged`.
    pub source: crate::recording::ReferenceSource,
    /// Scatter of rotations about the axes to the right, down and forward of the heading, radians.
    pub rotation_sigma_rad: [f64; 3],
    /// Scatter of positions in the world, metres.
    pub position_sigma_m: [f64; 3],
    /// What these poses cannot show, in words; empty for measured ones.
    pub absorbed: String,
}

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The recording's name.
    pub recording: String,
    /// Frames that were compared, and those of them that no fit has seen.
    pub frames: usize,
    /// Of them, those that no fit has seen.
    pub judged_frames: usize,
    /// Frames without a whole picture, by their files.
    pub left_out: Vec<String>,
    /// In one word.
    pub verdict: Verdict,
    /// In one sentence.
    pub summary: String,
    /// Those found, the surest first.
    pub effects: Vec<EffectReport>,
    /// Those that the model had before, refitted.
    pub in_model: Vec<EffectReport>,
    /// What no effect explains.
    pub unexplained: Vec<Unexplained>,
    /// On frames that no fit has seen.
    pub gap: Gap,
    /// Effects not found.
    pub not_found: Vec<NotFoundReport>,
    /// Effects that cannot be seen.
    pub unobservable: Vec<Unobservable>,
    /// The reference poses.
    pub poses: PosesReport,
    /// Where residuals are, by channel.
    pub maps: BTreeMap<String, Maps>,
    /// Index of the frame in the pictures of the report, in the recording.
    pub shown_frame: usize,
    /// What chose the judged frames.
    pub seed: u64,
    /// The field that was recorded.
    pub field: FieldDimensions,
}
