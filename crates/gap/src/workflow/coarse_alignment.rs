//! Where lines are, if they are not where the model has them: there, or where one of its effects would put them. This finds
//! lines and names nothing: what is found is compared with all effects.

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

/// The model that has lines where they are; none where the one that is given has.
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
        // A piece that is found where it was missed counts twice.
        let least = best.score() + 2.0 * THRESHOLDS.alignment_gain * wanting;
        let found = placed.into_iter().max_by(|a, b| a.0.score().total_cmp(&b.0.score()));
        let Some((found, model)) = found.filter(|(found, _)| found.score() >= least) else { break };
        (best, better) = (found, Some(model));
    }
    Ok(better)
}

/// Pieces of line, found and expected, by the field's curves.
#[derive(Debug, Clone, Default)]
struct Placed(BTreeMap<usize, [f64; 2]>);

impl Placed {
    fn sums(&self) -> [f64; 2] {
        self.0.values().fold([0.0; 2], |sum, curve| [sum[0] + curve[0], sum[1] + curve[1]])
    }

    /// Found less missed: places from which no line is seen are no good ones.
    fn score(&self) -> f64 {
        let [found, expected] = self.sums();
        2.0 * found - expected
    }

    /// Pieces that should be found and are not: of all lines where too few are found, else of those that are lost.
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

/// Some pictures of a recording.
struct Pictures<'a> {
    recording: &'a Recording<'a>,
    /// When, and what.
    pictures: Vec<(f64, Texture)>,
}

impl<'a> Pictures<'a> {
    /// Of those that are fitted: no others are looked at before the end.
    fn of(recording: &'a Recording<'a>, split: &HeldOutSplit) -> Result<Self, MeasureError> {
        let every = split.fitted().count().div_ceil(THRESHOLDS.alignment_pictures).max(1);
        let picture = |index: usize| {
            let frame = &recording.frames[index];
            Ok((frame.time_s, Texture::pack(&luma(&recording.picture(frame)?.0))))
        };
        let pictures = split.fitted().step_by(every).map(picture).collect::<Result<_, MeasureError>>()?;
        Ok(Self { recording, pictures })
    }

    /// The model with other values of one parameter, or of both of an effect that has two.
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

    /// None where there is no such lens, or no such field: an end of one range may not go with the rest.
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

    /// How far apart two models have the same point of a line, at most.
    fn farthest_px(&self, model: &Model, other: &Model) -> Option<f64> {
        let chains = [self.chain(model)?, self.chain(other)?];
        let mut farthest_px: f64 = 0.0;
        for (time_s, _) in &self.pictures {
            let view = |chain| FrameCamera::new(chain, &self.recording.trajectory, *time_s);
            let [one, other] = chains.each_ref().map(view);
            // A line's point is that of the same curve, however long the model has it.
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
