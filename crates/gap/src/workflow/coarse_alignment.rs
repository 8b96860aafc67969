//! Coarse alignment: searches for a model whose expected lines are near the real ones, by trying the values of one effect
//! after another. It only makes lines measurable and supports no effect: its result is afterwards compared with all effects.

use std::collections::BTreeMap;

use rayon::prelude::*;
use reality_sim_core::preprocess::{Texture, luma};
use reality_sim_sensor::{Chain, EffectIndex, Model};

use crate::{
    inference::split::HeldOutSplit,
    linear_model::initial_values::{starting_values, with_value},
    linear_model::linearization::MeasureError,
    linear_model::parameters::FittedParameter,
    measurement::camera::FrameCamera,
    measurement::line_search::search,
    measurement::lines::expected_lines,
    recording::Recording,
    thresholds::{Thresholds, WorkflowThresholds},
};

const THRESHOLDS: WorkflowThresholds = Thresholds::DEFAULT.workflow;

/// Returns a model whose lines are where the pictures show them. None if the given model needs no alignment or no tried
/// model is better.
pub(crate) fn placing(
    recording: &Recording<'_>,
    model: &Model,
    columns: &[FittedParameter],
    split: &HeldOutSplit,
) -> Result<Option<Model>, MeasureError> {
    let pictures = Pictures::of(recording, split)?;
    let Some(mut best) = pictures.placed(model) else { return Ok(None) };
    let mut better: Option<Model> = None;
    for _ in 0..THRESHOLDS.alignment_rounds {
        let wanting = best.wanting();
        if wanting == 0.0 {
            break;
        }
        let tries = pictures.tries(better.as_ref().unwrap_or(model), columns);
        let placed: Vec<(Placed, Model)> =
            tries.into_par_iter().filter_map(|model| Some((pictures.placed(&model)?, model))).collect();
        // A piece found instead of missed changes the score by two.
        let least = best.score() + 2.0 * THRESHOLDS.alignment_gain * wanting;
        let found = placed.into_iter().max_by(|a, b| a.0.score().total_cmp(&b.0.score()));
        let Some((found, model)) = found.filter(|(found, _)| found.score() >= least) else { break };
        (best, better) = (found, Some(model));
    }
    Ok(better)
}

/// Numbers of line pieces found and expected, for each curve of the field.
#[derive(Debug, Clone, Default)]
struct Placed(BTreeMap<usize, [f64; 2]>);

impl Placed {
    fn sums(&self) -> [f64; 2] {
        self.0.values().fold([0.0; 2], |sum, curve| [sum[0] + curve[0], sum[1] + curve[1]])
    }

    /// Returns the number of pieces found minus the number missed. Poses from which no line is visible therefore score low.
    fn score(&self) -> f64 {
        let [found, expected] = self.sums();
        2.0 * found - expected
    }

    /// Returns the number of missing pieces: of all lines if too few pieces are found, else only of curves that are lost.
    fn wanting(&self) -> f64 {
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
struct Pictures<'a> {
    recording: &'a Recording<'a>,
    /// Time in seconds and luma of each picture.
    pictures: Vec<(f64, Texture)>,
}

impl<'a> Pictures<'a> {
    /// Samples the training frames; held-out frames are not used before the end.
    fn of(recording: &'a Recording<'a>, split: &HeldOutSplit) -> Result<Self, MeasureError> {
        let every = split.fitted().count().div_ceil(THRESHOLDS.alignment_pictures).max(1);
        let picture = |index: usize| {
            let frame = &recording.frames[index];
            Ok((frame.time_s, Texture::pack(&luma(&recording.picture(frame)?.0))))
        };
        let pictures = split.fitted().step_by(every).map(picture).collect::<Result<_, MeasureError>>()?;
        Ok(Self { recording, pictures })
    }

    /// Returns variants of the model with other values of one parameter, or of both parameters of an effect that has two.
    fn tries(&self, model: &Model, columns: &[FittedParameter]) -> Vec<Model> {
        let mut movers: BTreeMap<EffectIndex, Vec<&FittedParameter>> = BTreeMap::new();
        for column in columns.iter().filter(|column| column.is_size()) {
            let [low, high] = column.parameter().range.map(|value| self.moved(model, column, value));
            if self.farthest_px(&low, &high).is_none_or(|pixels| pixels > THRESHOLDS.alignment_least_move_px)
            {
                movers.entry(column.effect).or_default().push(column);
            }
        }
        let mut tries = Vec::new();
        for of_effect in movers.values() {
            match of_effect[..] {
                [first, second] => {
                    let rows = values(first).map(|value| self.moved(model, first, value));
                    tries.extend(rows.flat_map(|row| {
                        values(second).map(move |value| self.moved(&row, second, value)).collect::<Vec<_>>()
                    }));
                }
                _ => {
                    for column in of_effect {
                        tries.extend(values(column).map(|value| self.moved(model, column, value)));
                    }
                }
            }
        }
        tries
    }

    fn moved(&self, model: &Model, column: &FittedParameter, value: f64) -> Model {
        let effect = column.effect();
        let values = model
            .values(effect.id())
            .map_or_else(|| starting_values(effect, self.recording), <[f64]>::to_vec);
        with_value(model, effect, &values, column.parameter, value)
    }

    /// Returns the camera chain of a model. None if the lens or the field is impossible: the limit of one parameter's range
    /// may not be compatible with the other parameters.
    fn chain(&self, model: &Model) -> Option<Chain> {
        Chain::new(&self.recording.sequence.setup, &self.recording.sequence.field, model).ok()
    }

    fn placed(&self, model: &Model) -> Option<Placed> {
        let Recording { sequence, trajectory, .. } = self.recording;
        let chain = self.chain(model)?;
        let near_px = THRESHOLDS.alignment_near * f64::from(sequence.setup.camera.width);
        let mut placed = Placed::default();
        for (time_s, texture) in &self.pictures {
            let expected = expected_lines(&FrameCamera::new(&chain, trajectory, *time_s));
            let found = search(texture, &expected, near_px, |found| Some(found.visible.sample.curve));
            let expected = expected.iter().map(|visible| visible.sample.curve);
            let mut count = |curve: usize, kind: usize| placed.0.entry(curve).or_default()[kind] += 1.0;
            found.into_iter().for_each(|curve| count(curve, 0));
            expected.for_each(|curve| count(curve, 1));
        }
        Some(placed)
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
                    let pixels =
                        [one.project(curve.at(fraction).0, 1), other.project(same.at(fraction).0, 1)];
                    if let [Some(one), Some(other)] = pixels {
                        farthest_px = farthest_px.max(one.distance(other));
                    }
                }
            }
        }
        Some(farthest_px)
    }
}

fn values(column: &FittedParameter) -> impl Iterator<Item = f64> {
    let [low, high] = column.parameter().range;
    (0..=THRESHOLDS.alignment_values)
        .map(move |step| low + (high - low) * step as f64 / THRESHOLDS.alignment_values as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(curves: &[[f64; 2]]) -> Placed {
        Placed((0..).zip(curves.iter().copied()).collect())
    }

    #[test]
    fn nothing_is_wanting_where_most_of_every_line_is_found() {
        assert_eq!(placed(&[[30.0, 40.0], [9.0, 20.0], [0.0, 2.0]]).wanting(), 0.0);
    }

    #[test]
    fn a_lost_line_is_wanting_and_so_is_all_that_is_missed_where_little_is_found() {
        assert_eq!(placed(&[[60.0, 70.0], [1.0, 8.0]]).wanting(), 7.0);
        assert_eq!(placed(&[[10.0, 70.0], [6.0, 8.0]]).wanting(), 62.0);
    }

    #[test]
    fn places_from_which_little_is_seen_are_no_good_ones() {
        assert!(placed(&[[40.0, 60.0]]).score() > placed(&[[8.0, 10.0]]).score());
        assert!(placed(&[[5.0, 60.0]]).score() < placed(&[[1.0, 10.0]]).score());
    }
}
