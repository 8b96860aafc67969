//! Which set of effects to take next, and how a set settles: fitted, and everything measured anew where it puts things.

use std::{cmp::Ordering, collections::BTreeMap};

use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::effect_test::{EffectTests, TELLS_APART},
    inference::measured::{LinearizedRecording, SEARCH},
    inference::split::HeldOutSplit,
    linear_model::column::ColumnIndex,
    linear_model::initial_values::starting_values,
    linear_model::linearization::MeasureError,
    linear_model::parameters::FittedParameter,
    linear_model::reduced_equations::Fit,
    linear_model::system::{FittedResiduals, INDEPENDENT, LinearSystem},
    measurement::quantity::Quantity,
    recording::Recording,
    workflow::progress::Progress,
};

/// Rounds of Gauss and Newton's method after an effect was added.
const SETTLING: usize = 8;
/// A model has settled when a step gains less than this in log-likelihood.
const SETTLED: f64 = 1.0;

/// What a model leaves is off by this part of what it explains.
const INEXACT: f64 = 0.03;
/// Residuals beyond this many standard deviations are no measurements.
const CUT_OFF: f64 = 5.0;
/// Rows of a channel in the pictures that a mean residual stands for.
const PICTURE_ROWS: f64 = 3000.0;
/// Rows of the odometry that it stands for.
const MOTION_ROWS: f64 = 60.0;

/// Models whose settled fits differ by less, in log-likelihood, leave as little as each other. No model is exact, and what
/// it is off by grows with what it explains.
fn apart(explained: f64) -> f64 {
    (0.5 * TELLS_APART * TELLS_APART).max(INEXACT * explained)
}

/// Finds sets of effects for one recording.
pub(crate) struct ModelSearch<'a> {
    pub(crate) recording: &'a Recording<'a>,
    pub(crate) columns: &'a [FittedParameter],
    pub(crate) split: &'a HeldOutSplit,
    /// Effects that the model has had from the start.
    pub(crate) given: &'a [EffectIndex],
    pub(crate) progress: &'a dyn Fn(Progress),
}

impl ModelSearch<'_> {
    /// The effects of a model in which these are named.
    fn all(&self, named: &[EffectIndex]) -> Vec<EffectIndex> {
        self.given.iter().chain(named).copied().collect()
    }

    /// The model without an effect that no longer holds, settled, where it does not hold beside that, either. Large effects may
    /// seem not to hold once they have settled, as Wald's test loses its power far from none (Hauck and Donner 1977).
    pub(crate) fn dropped(
        &self,
        measured: &LinearizedRecording,
        named: &[EffectIndex],
    ) -> Result<Option<(Vec<EffectIndex>, LinearizedRecording)>, MeasureError> {
        let naming = measured.naming(self.columns);
        let all = self.all(named);
        let tested = naming.effects().len();
        let falls =
            |effect: &&EffectIndex| naming.case(**effect, &all, tested).is_none_or(|case| !case.holds());
        for fallen in named.iter().filter(falls) {
            let others: Vec<EffectIndex> = named.iter().copied().filter(|effect| effect != fallen).collect();
            let without = self.all(&others);
            let settled = self.settle(measured.clone(), &without)?;
            let naming = settled.naming(self.columns);
            if naming.case(*fallen, &without, tested).is_none_or(|case| !case.holds()) {
                return Ok(Some((others, settled)));
            }
        }
        Ok(None)
    }

    /// How unlikely an effect that is not in the model is chance.
    pub(crate) fn p_value(
        &self,
        measured: &LinearizedRecording,
        named: &[EffectIndex],
        effect: EffectIndex,
    ) -> Option<f64> {
        let naming = measured.naming(self.columns);
        let all = self.all(named);
        Some(naming.case(effect, &all, naming.effects().len())?.p_value)
    }

    /// The next sets of effects to try, one of which is to be taken: one replaced by a better one, one more, or
    /// two more. `is_new` are sets that were not tried.
    pub(crate) fn next_sets(
        &self,
        measured: &LinearizedRecording,
        named: &[EffectIndex],
        is_new: impl Fn(&[EffectIndex]) -> bool,
    ) -> Vec<Vec<EffectIndex>> {
        let naming = measured.naming(self.columns);
        let all = self.all(named);
        let swapped = |(old, new): (EffectIndex, EffectIndex)| -> Vec<EffectIndex> {
            named.iter().map(|&effect| if effect == old { new } else { effect }).collect()
        };
        if let Some(swap) = naming.better(&all, named).into_iter().map(swapped).find(|set| is_new(set)) {
            return vec![swap];
        }
        let with =
            |added: &[EffectIndex]| -> Vec<EffectIndex> { named.iter().chain(added).copied().collect() };
        naming.next(&all).iter().map(|added| with(added)).filter(|set| is_new(set)).collect()
    }

    /// Settles each of several sets: first the one to take, then those that leave as little. The set to take is the one
    /// of fewest numbers among those that cannot be told apart, then the one that leaves least.
    pub(crate) fn closest(
        &self,
        measured: &LinearizedRecording,
        sets: Vec<Vec<EffectIndex>>,
    ) -> Result<Vec<(Vec<EffectIndex>, LinearizedRecording)>, MeasureError> {
        let only = sets.len() == 1;
        let mut settled = Vec::with_capacity(sets.len());
        for set in sets {
            let model = self.settle(measured.clone(), &self.all(&set))?;
            let left = if only { 0.0 } else { self.left(&model, &measured.system) };
            settled.push((left, set, model));
        }
        let least = settled.iter().map(|(left, ..)| *left).fold(f64::INFINITY, f64::min);
        let apart = if only { 0.0 } else { apart(self.left(measured, &measured.system) - least) };
        settled.retain(|(left, ..)| *left <= least + apart);
        let sizes = |set: &[EffectIndex]| {
            self.columns.iter().filter(|column| column.is_size() && set.contains(&column.effect)).count()
        };
        settled
            .sort_by(|a, b| (sizes(&a.1), a.0).partial_cmp(&(sizes(&b.1), b.0)).unwrap_or(Ordering::Equal));
        Ok(settled.into_iter().map(|(_, set, measured)| (set, measured)).collect())
    }

    /// Named effects with those that may stand for them: that tied when they were taken, or that the linearised model
    /// cannot tell from them; of these, those that leave as little once they have settled.
    pub(crate) fn rivals(
        &self,
        measured: &LinearizedRecording,
        named: &[EffectIndex],
        ties: &[(EffectIndex, EffectIndex)],
    ) -> Result<Vec<(EffectIndex, EffectIndex)>, MeasureError> {
        let naming = measured.naming(self.columns);
        let all = self.all(named);
        let left = self.left(measured, &measured.system);
        let mut rivals = Vec::new();
        for &effect in named {
            let tied = ties.iter().filter(|(of, other)| *of == effect && !all.contains(other));
            let mut others: Vec<EffectIndex> = tied.map(|(_, other)| *other).collect();
            others.extend(naming.rivals(effect, &all));
            others.sort_unstable();
            others.dedup();
            if others.is_empty() {
                continue;
            }
            let without: Vec<EffectIndex> = all.iter().copied().filter(|&other| other != effect).collect();
            let left_without = self.left(&self.settle(measured.clone(), &without)?, &measured.system);
            for rival in others {
                let set: Vec<EffectIndex> = without.iter().copied().chain([rival]).collect();
                let settled = self.settle(measured.clone(), &set)?;
                if self.left(&settled, &measured.system) < left + apart(left_without - left) {
                    rivals.push((effect, rival));
                }
            }
        }
        Ok(rivals)
    }

    /// What a settled model leaves, minus log-likelihood: residuals in the standard deviations of one system, cut off
    /// where they are no measurement, and what tolerances have to be.
    pub(crate) fn left(&self, measured: &LinearizedRecording, system: &LinearSystem) -> f64 {
        let Some(fit) = measured.naming(self.columns).evidence.as_it_is() else { return f64::INFINITY };
        let strain = 0.5 * fit.delta.norm_squared();
        let mut means: BTreeMap<Quantity, (f64, f64)> = BTreeMap::new();
        for (frame, weights) in self.split.fitted().zip(&measured.system.weights) {
            let rows = &measured.frames[frame];
            let left = FittedResiduals::new(rows, weights, &fit.delta, &system.pose_sigmas);
            for (row, residual) in
                rows.measurements.iter().zip(&left.residuals).filter(|(_, left)| left.is_finite())
            {
                let key = row.quantity;
                if let Some(sigma) = system.sigmas.get(&key) {
                    let mean = means.entry(key).or_default();
                    mean.0 += (residual / sigma).powi(2).min(CUT_OFF * CUT_OFF);
                    mean.1 += 1.0;
                }
            }
        }
        // Other models find other numbers of lines: means count, times as many as there are independent.
        let counted = means.iter().map(|(quantity, (sum, count))| {
            let rows = if quantity.is_odometry() { MOTION_ROWS } else { INDEPENDENT * PICTURE_ROWS };
            0.5 * rows * sum / count.max(1.0)
        });
        counted.sum::<f64>() + strain
    }

    /// Fits the effects together and measures anew where they put things, until nothing moves.
    pub(crate) fn settle(
        &self,
        mut measured: LinearizedRecording,
        effects: &[EffectIndex],
    ) -> Result<LinearizedRecording, MeasureError> {
        for _ in 0..SETTLING {
            (self.progress)(Progress::Fitting);
            let naming = measured.naming(self.columns);
            let Some(fit) = naming.fit_in_range(effects) else { break };
            let still = naming.evidence.improvement(&fit) < SETTLED;
            let model = self.moved(&measured.model, &naming, &fit, effects);
            (self.progress)(Progress::Measuring);
            measured = LinearizedRecording::new(self.recording, model, self.columns, self.split, SEARCH[1])?;
            if still {
                break;
            }
        }
        Ok(measured)
    }

    /// The model with only these effects, at the fitted values.
    fn moved(&self, model: &Model, naming: &EffectTests<'_>, fit: &Fit, effects: &[EffectIndex]) -> Model {
        let mut moved = Model::default();
        for &index in effects {
            let effect = index.effect();
            let mut values = model
                .values(effect.id())
                .map_or_else(|| starting_values(effect, self.recording), <[f64]>::to_vec);
            // What these frames do not tell of a given effect stays as it was given.
            let stays = |column: &ColumnIndex| self.given.contains(&index) && fit.tells_nothing(*column);
            for column in naming.columns_of(&[index]).into_iter().filter(|column| !stays(column)) {
                values[self.columns[column.0].parameter] = naming.value(fit, column);
            }
            moved = moved.with(effect, values);
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_apart_by_more_than_what_they_explain_may_be_off_by() {
        assert_eq!(apart(0.0), 0.5 * TELLS_APART * TELLS_APART);
        assert!(apart(1000.0) > apart(100.0));
        assert!(apart(1000.0) < 100.0, "a tenth of what is explained is no tie");
    }
}
