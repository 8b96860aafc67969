//! Search for the set of effects that a recording supports: chooses the sets to try next and fits each of them until the fit
//! converges, with everything measured anew at every fitted model.

use std::cmp::Ordering;

use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::effect_fit::EffectFits,
    inference::effect_test::{EffectTest, EffectTests},
    inference::linearized_recording::LinearizedRecording,
    inference::model_comparison::{indistinguishable_below, minus_log_likelihood},
    inference::recording_source::Linearize,
    inference::split::HeldOutSplit,
    linear_model::column::ColumnIndex,
    linear_model::linearization::MeasureError,
    linear_model::parameters::FittedParameter,
    linear_model::reduced_equations::Fit,
    linear_model::system::LinearSystem,
    progress::Progress,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Search over sets of effects for one recording.
pub(crate) struct ModelSearch<'a> {
    pub(crate) source: &'a dyn Linearize,
    pub(crate) columns: &'a [FittedParameter],
    pub(crate) split: &'a HeldOutSplit,
    /// Effects that the model had from the start.
    pub(crate) given: &'a [EffectIndex],
    pub(crate) progress: &'a dyn Fn(Progress),
    /// Whether effects that explain as much are tried and named beside each other.
    pub(crate) settles_ties: bool,
}

/// Set of named effects whose fit has converged, with the recording linearised at the fitted model.
pub(crate) type ConvergedSet = (Vec<EffectIndex>, LinearizedRecording);

impl ModelSearch<'_> {
    /// Returns all effects of a model: the given ones and these named ones.
    pub(crate) fn all(&self, named: &[EffectIndex]) -> Vec<EffectIndex> {
        self.given.iter().chain(named).copied().collect()
    }

    /// Returns the converged fit without an effect that is no longer supported, provided that the effect is not supported
    /// beside that smaller model either. The second condition matters because Wald's test loses power far from zero (Hauck
    /// and Donner 1977): a large effect may seem unsupported at its fitted size. `tests` belong to `linearized`.
    pub(crate) fn without_unsupported(
        &self,
        linearized: &LinearizedRecording,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
    ) -> Result<Option<ConvergedSet>, MeasureError> {
        let all = self.all(named);
        let tested = tests.fits.effects().len();
        let is_supported = |tests: &EffectTests<'_>, effect: EffectIndex, beside: &[EffectIndex]| {
            tests.test(effect, beside, tested).as_ref().is_some_and(EffectTest::is_supported)
        };
        // A value at the end of its range is no measurement, however much it explains.
        if let Some(&effect) = named.iter().find(|effect| tests.fits.is_at_end_of_range(**effect)) {
            let others: Vec<EffectIndex> = named.iter().copied().filter(|other| *other != effect).collect();
            let converged = self.converge(linearized.clone(), &self.all(&others))?;
            return Ok(Some((others, converged)));
        }
        for &unsupported in named.iter().filter(|effect| !is_supported(tests, **effect, &all)) {
            let others: Vec<EffectIndex> =
                named.iter().copied().filter(|effect| *effect != unsupported).collect();
            let without = self.all(&others);
            let converged = self.converge(linearized.clone(), &without)?;
            if !is_supported(&converged.effect_tests(self.columns), unsupported, &without) {
                return Ok(Some((others, converged)));
            }
        }
        Ok(None)
    }

    /// Returns the p-value of an effect that is not in the model, corrected for all effects of the library.
    pub(crate) fn p_value(
        &self,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
        effect: EffectIndex,
    ) -> Option<f64> {
        Some(tests.test(effect, &self.all(named), tests.fits.effects().len())?.p_value)
    }

    /// Returns the sets of named effects to try next, one of which is to be selected: one effect replaced by a better one,
    /// one effect more, or two more. `is_new` is true for sets that have not been tried yet.
    pub(crate) fn next_sets(
        &self,
        tests: &EffectTests<'_>,
        named: &[EffectIndex],
        is_new: impl Fn(&[EffectIndex]) -> bool,
    ) -> Vec<Vec<EffectIndex>> {
        let all = self.all(named);
        let replaced = |(old, new): (EffectIndex, EffectIndex)| -> Vec<EffectIndex> {
            named.iter().map(|&effect| if effect == old { new } else { effect }).collect()
        };
        let mut replacements = tests.replacements(&all, named).into_iter().map(replaced);
        if let Some(replacement) = replacements.find(|set| is_new(set)) {
            return vec![replacement];
        }
        let with =
            |added: &[EffectIndex]| -> Vec<EffectIndex> { named.iter().chain(added).copied().collect() };
        let most = if self.settles_ties { usize::MAX } else { 1 };
        let additions = tests.next_additions(&all, |added| is_new(&with(added)));
        additions.iter().take(most).map(|added| with(added)).collect()
    }

    /// Fits each of several sets until it converges. Returns the best set first, followed by those that fit equally well.
    /// Among sets whose fits are indistinguishable, or whose effects are missed beside the best fit, the best one has the fewest
    /// sizes and then the best fit.
    pub(crate) fn best_sets(
        &self,
        linearized: &LinearizedRecording,
        sets: Vec<Vec<EffectIndex>>,
    ) -> Result<Vec<ConvergedSet>, MeasureError> {
        let only = sets.len() == 1;
        let mut converged = Vec::with_capacity(sets.len());
        for set in sets {
            let model = self.converge(linearized.clone(), &self.all(&set))?;
            let misfit = if only { 0.0 } else { self.minus_log_likelihood(&model, &linearized.system) };
            converged.push((misfit, set, model));
        }
        let least = converged.iter().map(|(misfit, ..)| *misfit).fold(f64::INFINITY, f64::min);
        let tie = if only {
            0.0
        } else {
            indistinguishable_below(self.minus_log_likelihood(linearized, &linearized.system) - least)
        };
        let sizes = |set: &[EffectIndex]| {
            self.columns.iter().filter(|column| column.is_size() && set.contains(&column.effect)).count()
        };
        let best = converged.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let missed: Vec<Vec<EffectIndex>> = best.map_or_else(Vec::new, |(_, best, model)| {
            let simpler = converged.iter().map(|(_, set, _)| set).filter(|set| sizes(set) < sizes(best));
            simpler.filter(|set| self.is_missed(set, best, model)).cloned().collect()
        });
        converged.retain(|(misfit, set, _)| *misfit <= least + tie || missed.contains(set));
        converged
            .sort_by(|a, b| (sizes(&a.1), a.0).partial_cmp(&(sizes(&b.1), b.0)).unwrap_or(Ordering::Equal));
        Ok(converged.into_iter().map(|(_, set, linearized)| (set, linearized)).collect())
    }

    /// Whether an effect of a set leads beside another one, whose fit has converged: the other one, however well it fits, does not
    /// explain what this one does.
    fn is_missed(
        &self,
        set: &[EffectIndex],
        beside: &[EffectIndex],
        converged: &LinearizedRecording,
    ) -> bool {
        let tests = converged.effect_tests(self.columns);
        let effects = set.iter().filter(|effect| !beside.contains(effect));
        let p_values = effects.filter_map(|&effect| self.p_value(&tests, beside, effect));
        p_values.fold(1.0, f64::min) < THRESHOLDS.lead_p_value
    }

    /// Returns pairs of a named effect and an effect that it is confusable with. Candidates are effects that tied with the
    /// named one when it was selected, and those that the linearised model cannot distinguish from it. A candidate counts if
    /// its converged fit in the named effect's place is as good.
    pub(crate) fn confusable(
        &self,
        linearized: &LinearizedRecording,
        named: &[EffectIndex],
        ties: &[(EffectIndex, EffectIndex)],
    ) -> Result<Vec<(EffectIndex, EffectIndex)>, MeasureError> {
        if !self.settles_ties {
            return Ok(Vec::new());
        }
        let tests = linearized.effect_tests(self.columns);
        let all = self.all(named);
        let misfit =
            |model: &LinearizedRecording| -> f64 { self.minus_log_likelihood(model, &linearized.system) };
        let own = misfit(linearized);
        let mut confusable = Vec::new();
        for &effect in named {
            let tied = ties.iter().filter(|(of, other)| *of == effect && !all.contains(other));
            let mut others: Vec<EffectIndex> = tied.map(|(_, other)| *other).collect();
            others.extend(tests.confusable_with(effect, &all));
            others.sort_unstable();
            others.dedup();
            if others.is_empty() {
                continue;
            }
            let without: Vec<EffectIndex> = all.iter().copied().filter(|&other| other != effect).collect();
            let explained = misfit(&self.converge(linearized.clone(), &without)?) - own;
            for other in others {
                let set: Vec<EffectIndex> = without.iter().copied().chain([other]).collect();
                let converged = self.converge(linearized.clone(), &set)?;
                if misfit(&converged) < own + indistinguishable_below(explained) {
                    confusable.push((effect, other));
                }
            }
        }
        Ok(confusable)
    }

    /// Returns minus the log-likelihood of a model, in the standard deviations of `system`. See [`minus_log_likelihood`].
    pub(crate) fn minus_log_likelihood(
        &self,
        linearized: &LinearizedRecording,
        system: &LinearSystem,
    ) -> f64 {
        minus_log_likelihood(linearized, system, self.columns, self.split)
    }

    /// Fits the effects jointly by Gauss and Newton's method: every step is followed by a measurement at the fitted model,
    /// until a step gains next to nothing.
    pub(crate) fn converge(
        &self,
        mut linearized: LinearizedRecording,
        effects: &[EffectIndex],
    ) -> Result<LinearizedRecording, MeasureError> {
        for _ in 0..THRESHOLDS.most_gauss_newton_steps {
            (self.progress)(Progress::Fitting);
            let fits = linearized.effect_fits(self.columns);
            let Some(fit) = fits.fit_in_range(effects) else { break };
            let has_converged = fits.evidence.improvement(&fit) < THRESHOLDS.converged_gain;
            let model = self.fitted_model(&linearized.model, &fits, &fit, effects);
            (self.progress)(Progress::Measuring);
            linearized = self.source.linearize(model)?;
            if has_converged {
                break;
            }
        }
        Ok(linearized)
    }

    /// Returns the model with only these effects, at the fitted values.
    fn fitted_model(
        &self,
        model: &Model,
        fits: &EffectFits<'_>,
        fit: &Fit,
        effects: &[EffectIndex],
    ) -> Model {
        let mut fitted = Model::default();
        for &index in effects {
            let effect = index.effect();
            let mut values = model
                .values(effect.id())
                .map_or_else(|| self.source.starting_values(effect), <[f64]>::to_vec);
            // Parameters of a given effect that these frames do not constrain keep their given values.
            let stays = |column: &ColumnIndex| self.given.contains(&index) && fit.is_prior_dominated(*column);
            for column in fits.columns_of(&[index]).into_iter().filter(|column| !stays(column)) {
                values[self.columns[column.0].parameter] = fits.value(fit, column);
            }
            fitted = fitted.with(effect, values);
        }
        fitted
    }
}
