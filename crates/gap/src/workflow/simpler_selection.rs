//! Two simpler selections of effects, which the study of `docs/gap.md` compares the workflow's own with: all parameters free with
//! an information criterion, and cross-validation alone.

use rayon::prelude::*;
use reality_sim_sensor::EffectIndex;

use crate::{
    inference::effect_fit::EffectFits,
    inference::linearized_recording::LinearizedRecording,
    inference::model_search::{ConvergedSet, ModelSearch},
    linear_model::linearization::MeasureError,
    thresholds::Thresholds,
};

impl ModelSearch<'_> {
    /// Fits all effects at once, and drops one after the other as long as that lowers the Bayesian information criterion
    /// `−2 ln L + k ln n` (Schwarz 1978), where an effect has `k` parameters and the recording `n` measurements.
    pub(crate) fn by_information_criterion(
        &self,
        linearized: LinearizedRecording,
    ) -> Result<ConvergedSet, MeasureError> {
        let mut named = linearized.effect_fits(self.columns).effects();
        named.retain(|effect| !self.given.contains(effect));
        let all_free = self.converge(linearized, &self.all(&named))?;
        let count = all_free.system.weights.iter().flatten().filter(|weight| **weight > 0.0).count();
        let per_parameter = (count.max(1) as f64).ln();
        let fits = all_free.effect_fits(self.columns);
        let given = self.given;
        let log_likelihood = |named: &[EffectIndex]| log_likelihood(&fits, &[given, named].concat());
        let mut with_all = log_likelihood(&named);
        loop {
            let criterion_without = |&effect: &EffectIndex| {
                let without: Vec<EffectIndex> =
                    named.iter().copied().filter(|other| *other != effect).collect();
                let lost = 2.0 * (with_all - log_likelihood(&without));
                (lost - per_parameter * fits.columns_of(&[effect]).len() as f64, effect, without)
            };
            let criteria: Vec<_> = named.par_iter().map(criterion_without).collect();
            let least = criteria.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, _, without)) = least.filter(|(criterion, ..)| *criterion < 0.0) else { break };
            with_all = log_likelihood(&without);
            named = without;
        }
        let converged = self.converge(all_free.clone(), &self.all(&named))?;
        Ok((named, converged))
    }

    /// Adds the effect that predicts held-out parts of the training frames best, one after the other, as long as that predicts them
    /// better at all: cross-validation as mrcal recommends it for its lens models, with no test of significance.
    pub(crate) fn by_cross_validation(
        &self,
        mut linearized: LinearizedRecording,
    ) -> Result<ConvergedSet, MeasureError> {
        let mut named: Vec<EffectIndex> = Vec::new();
        while named.len() < Thresholds::DEFAULT.workflow.most_effects {
            let all = self.all(&named);
            let tests = linearized.effect_tests(self.columns);
            let mut others = tests.fits.effects();
            others.retain(|effect| !all.contains(effect));
            let gain = |&effect: &EffectIndex| {
                let with: Vec<EffectIndex> = all.iter().copied().chain([effect]).collect();
                Some((tests.gain(&with, &all)?.value, effect))
            };
            let gains: Vec<(f64, EffectIndex)> = others.par_iter().filter_map(gain).collect();
            let best = gains.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, effect)) = best.filter(|(gain, _)| *gain > 0.0) else { break };
            named.push(effect);
            linearized = self.converge(linearized.clone(), &self.all(&named))?;
        }
        Ok((named, linearized))
    }
}

/// Returns the logarithm of the likelihood with these effects fitted, up to a constant.
fn log_likelihood(fits: &EffectFits<'_>, effects: &[EffectIndex]) -> f64 {
    fits.fit_in_range(effects).map_or(f64::NEG_INFINITY, |fit| fits.evidence.improvement(&fit))
}
