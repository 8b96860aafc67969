//! Coarse alignment: searches for a model whose predicted lines are near those in the pictures, by trying the values of one
//! effect after another. It only makes lines measurable: which effects are supported is tested afterwards.

use std::collections::BTreeMap;

use rayon::prelude::*;
use reality_sim_core::preprocess::{Texture, luma};
use reality_sim_sensor::{Chain, EffectIndex, Model};

use crate::{
    frame_index::FrameIndex,
    inference::split::HeldOutSplit,
    linear_model::initial_values::{starting_values, with_value},
    linear_model::linearization::MeasureError,
    linear_model::parameters::FittedParameter,
    measurement::camera::FrameCamera,
    measurement::curve_index::CurveIndex,
    measurement::line_search::search,
    measurement::lines::{curve_of, expected_lines},
    measurement::quantity::ColorChannel,
    recording::Recording,
    thresholds::{Thresholds, WorkflowThresholds},
};

const THRESHOLDS: WorkflowThresholds = Thresholds::DEFAULT.workflow;

/// Returns a model that predicts lines where the pictures show them. None if the given model needs no alignment, or if no
/// model that is tried is better.
pub(crate) fn coarsely_aligned(
    recording: &Recording<'_>,
    model: &Model,
    columns: &[FittedParameter],
    split: &HeldOutSplit,
) -> Result<Option<Model>, MeasureError> {
    let pictures = PictureSample::new(recording, split)?;
    let Some(mut best) = pictures.line_counts(model) else { return Ok(None) };
    let mut better: Option<Model> = None;
    for _ in 0..THRESHOLDS.alignment_rounds {
        let missing = best.missing();
        if missing == 0.0 {
            break;
        }
        let candidates = pictures.variants(better.as_ref().unwrap_or(model), columns).into_par_iter();
        let counted: Vec<(LineCounts, Model)> =
            candidates.filter_map(|model| Some((pictures.line_counts(&model)?, model))).collect();
        // A piece found instead of missed changes the score by two.
        let least = best.score() + 2.0 * THRESHOLDS.alignment_gain * missing;
        let found = counted.into_iter().max_by(|a, b| a.0.score().total_cmp(&b.0.score()));
        let Some((counts, model)) = found.filter(|(counts, _)| counts.score() >= least) else { break };
        (best, better) = (counts, Some(model));
    }
    Ok(better)
}

/// Numbers of line pieces found and expected, for each curve of the field.
#[derive(Debug, Clone, Default)]
struct LineCounts(BTreeMap<CurveIndex, [f64; 2]>);

impl LineCounts {
    /// Returns the numbers of pieces found and expected of all curves.
    fn sums(&self) -> [f64; 2] {
        self.0.values().fold([0.0; 2], |sum, curve| [sum[0] + curve[0], sum[1] + curve[1]])
    }

    /// Returns the number of pieces found minus the number missed. A model from whose poses hardly a line is
    /// visible therefore scores low.
    fn score(&self) -> f64 {
        let [found, expected] = self.sums();
        2.0 * found - expected
    }

    /// Returns the number of missing pieces: of all lines if too few pieces are found, else only of curves that are lost.
    fn missing(&self) -> f64 {
        let [found, expected] = self.sums();
        if found < THRESHOLDS.alignment_found * expected {
            return expected - found;
        }
        let lost = self.0.values().filter(|[found, expected]| {
            *expected >= THRESHOLDS.lost_pieces && *found < THRESHOLDS.lost_found * expected
        });
        lost.map(|[found, expected]| expected - found).sum()
    }
}

/// Sample of a recording's pictures.
struct PictureSample<'a> {
    recording: &'a Recording<'a>,
    /// Time in seconds and luma of each picture.
    pictures: Vec<(f64, Texture)>,
}

impl<'a> PictureSample<'a> {
    /// Samples the training frames; held-out frames are not used before the end.
    fn new(recording: &'a Recording<'a>, split: &HeldOutSplit) -> Result<Self, MeasureError> {
        let every = split.training().count().div_ceil(THRESHOLDS.alignment_pictures).max(1);
        let picture = |frame: FrameIndex| {
            let frame = &recording.frames[frame];
            Ok((frame.time_s, Texture::pack(&luma(&recording.picture(frame)?.0))))
        };
        let pictures = split.training().step_by(every).map(picture).collect::<Result<_, MeasureError>>()?;
        Ok(Self { recording, pictures })
    }

    /// Returns variants of the model with other values of one parameter, or of both parameters of an effect that has two.
    fn variants(&self, model: &Model, columns: &[FittedParameter]) -> Vec<Model> {
        let mut by_effect: BTreeMap<EffectIndex, Vec<&FittedParameter>> = BTreeMap::new();
        for column in columns.iter().filter(|column| column.is_size()) {
            let [low, high] = column.parameter().range.map(|value| self.with_parameter(model, column, value));
            if self.farthest_px(&low, &high).is_none_or(|pixels| pixels > THRESHOLDS.alignment_least_move_px)
            {
                by_effect.entry(column.effect).or_default().push(column);
            }
        }
        let mut variants = Vec::new();
        for of_effect in by_effect.values() {
            match of_effect[..] {
                [first, second] => {
                    let rows = values(first).map(|value| self.with_parameter(model, first, value));
                    variants.extend(rows.flat_map(|row| {
                        values(second)
                            .map(move |value| self.with_parameter(&row, second, value))
                            .collect::<Vec<_>>()
                    }));
                }
                _ => {
                    for column in of_effect {
                        variants
                            .extend(values(column).map(|value| self.with_parameter(model, column, value)));
                    }
                }
            }
        }
        variants
    }

    /// Returns a model with another value of one parameter.
    fn with_parameter(&self, model: &Model, column: &FittedParameter, value: f64) -> Model {
        let effect = column.effect();
        let values = model
            .values(effect.id())
            .map_or_else(|| starting_values(effect, self.recording), <[f64]>::to_vec);
        with_value(model, column, &values, value)
    }

    /// Returns the camera chain of a model. None if the lens or the field is impossible: the limit of one parameter's range
    /// may not be compatible with the other parameters.
    fn chain(&self, model: &Model) -> Option<Chain> {
        Chain::new(&self.recording.sequence.setup, &self.recording.sequence.field, model).ok()
    }

    /// Counts the pieces of line that a model predicts and those that are found near them. None where [`Self::chain`] is.
    fn line_counts(&self, model: &Model) -> Option<LineCounts> {
        let Recording { sequence, trajectory, .. } = self.recording;
        let chain = self.chain(model)?;
        let near_px = THRESHOLDS.alignment_near * f64::from(sequence.setup.camera.width);
        let mut counts = LineCounts::default();
        for (time_s, texture) in &self.pictures {
            let expected = expected_lines(&FrameCamera::new(&chain, trajectory, *time_s));
            let found = search(texture, &expected, near_px, |found| Some(curve_of(&found.visible)));
            let expected = expected.iter().map(curve_of);
            let mut count = |curve: CurveIndex, kind: usize| counts.0.entry(curve).or_default()[kind] += 1.0;
            found.into_iter().for_each(|curve| count(curve, 0));
            expected.for_each(|curve| count(curve, 1));
        }
        Some(counts)
    }

    /// Returns the largest distance, in pixels, between the projections of the same line point by two models.
    fn farthest_px(&self, model: &Model, other: &Model) -> Option<f64> {
        let chains = [self.chain(model)?, self.chain(other)?];
        let mut farthest_px: f64 = 0.0;
        for (time_s, _) in &self.pictures {
            let view = |chain| FrameCamera::new(chain, &self.recording.trajectory, *time_s);
            let [one, other] = chains.each_ref().map(view);
            // Points correspond by their fraction of the curve, whatever its length in each model. Ends, middle and quarters
            // are enough: over a curve, displacements by one parameter change smoothly.
            for (curve, same) in one.curves.iter().zip(&other.curves) {
                for fraction in [0.0, 0.25, 0.5, 0.75, 1.0] {
                    let pixels = [(&one, curve), (&other, same)]
                        .map(|(camera, curve)| camera.project(curve.at(fraction).0, ColorChannel::Green));
                    if let [Some(one), Some(other)] = pixels {
                        farthest_px = farthest_px.max(one.distance(other));
                    }
                }
            }
        }
        Some(farthest_px)
    }
}

/// Returns the values of a parameter that are tried, evenly spaced over its range.
fn values(column: &FittedParameter) -> impl Iterator<Item = f64> {
    let [low, high] = column.parameter().range;
    (0..=THRESHOLDS.alignment_values)
        .map(move |step| low + (high - low) * step as f64 / THRESHOLDS.alignment_values as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(curves: &[[f64; 2]]) -> LineCounts {
        LineCounts((0..).map(CurveIndex).zip(curves.iter().copied()).collect())
    }

    #[test]
    fn nothing_is_missing_where_most_of_every_line_is_found() {
        assert_eq!(counts(&[[30.0, 40.0], [9.0, 20.0], [0.0, 2.0]]).missing(), 0.0);
    }

    #[test]
    fn pieces_of_a_lost_line_are_missing_and_all_pieces_not_found_where_few_are_found() {
        assert_eq!(counts(&[[60.0, 70.0], [1.0, 8.0]]).missing(), 7.0);
        assert_eq!(counts(&[[10.0, 70.0], [6.0, 8.0]]).missing(), 62.0);
    }

    #[test]
    fn a_model_from_which_few_lines_are_in_view_scores_low() {
        assert!(counts(&[[40.0, 60.0]]).score() > counts(&[[8.0, 10.0]]).score());
        assert!(counts(&[[5.0, 60.0]]).score() < counts(&[[1.0, 10.0]]).score());
    }
}
