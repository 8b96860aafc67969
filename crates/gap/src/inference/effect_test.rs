//! Tests of single effects: whether the training frames support one beside others.

use rayon::prelude::*;
use reality_sim_sensor::{Covariate, EffectIndex, Need, Stage};

use crate::{
    inference::cross_validation::{CrossValidation, FoldKind},
    inference::effect_fit::EffectFits,
    inference::gain::{Gain, HeldOutGains},
    inference::hypothesis_test::two_sided,
    linear_model::column::ColumnIndex,
    linear_model::fixed_values::tries,
    linear_model::reduced_equations::Fit,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Test of one effect beside others.
#[derive(Debug, Clone)]
pub(crate) struct EffectTest {
    /// Tested effect.
    pub(crate) effect: EffectIndex,
    /// P-value, corrected for the number of effects tested (Bonferroni).
    pub(crate) p_value: f64,
    /// Gain on held-out frames over the same model without the effect.
    pub(crate) gain: Gain,
    /// Whether the effect is large enough to matter.
    pub(crate) material: bool,
    /// Fit of the effect together with the others.
    pub(crate) fit: Fit,
}

impl EffectTest {
    /// Whether the effect is supported: large enough to matter, statistically significant, and with a clear gain on held-out
    /// frames.
    pub(crate) fn is_supported(&self) -> bool {
        let gains =
            self.gain.value > THRESHOLDS.least_gain && self.gain.score() > THRESHOLDS.least_gain_score;
        self.material && self.p_value < THRESHOLDS.significance && gains
    }
}

/// Tests of effects at the present model.
#[derive(Debug)]
pub(crate) struct EffectTests<'a> {
    pub(crate) fits: EffectFits<'a>,
    folds: CrossValidation,
}

impl<'a> EffectTests<'a> {
    /// Creates the tests at the model of these fits.
    pub(crate) fn new(fits: EffectFits<'a>) -> Self {
        let folds = CrossValidation::new(&fits.evidence);
        Self { fits, folds }
    }

    /// Tests an effect beside others; `tested` is the number of effects tested at the same time. None if the fit is
    /// singular.
    pub(crate) fn test(
        &self,
        effect: EffectIndex,
        beside: &[EffectIndex],
        tested: usize,
    ) -> Option<EffectTest> {
        let without: Vec<EffectIndex> = beside.iter().copied().filter(|other| *other != effect).collect();
        let with: Vec<EffectIndex> = without.iter().copied().chain([effect]).collect();
        let free = self.fits.columns_of(&with);
        let fit = self.fits.evidence.fit(&free)?;
        let sizes = self.fits.sizes_of(effect);
        let [held_out, others] = self.held_out_gains([&with, &without])?;
        let gain = held_out.over(&others);
        let gain = if is_reflectance(effect) { gain.by_priors() } else { gain };
        let p_value = if self.is_possible(&fit, &sizes) {
            let together = Some(self.fits.evidence.p_value(&fit, &sizes));
            // An effect that is fixed to the field is predicted as well by the reflectance of carpet patches, which are
            // fixed too.
            let keeps_place = effect.effect().covariates().contains(&Covariate::FieldPosition);
            let predicted = (!keeps_place).then(|| {
                let by_priors = self.fits.evidence.p_value_by_priors(&fit, &sizes);
                self.predicted_p_value(held_out.score_over(&others)).max(by_priors)
            });
            let best = best_of([together, self.single_size_p_value(&without, &sizes), predicted]);
            let is_confirmed = !acts_on_light(effect) || self.is_seen_on_both_surfaces(&without, &sizes);
            if is_confirmed { best } else { 1.0 }
        } else {
            1.0
        };
        // The fixed parameters are the best of several values.
        let p_value = (p_value * tries(effect.effect()) as f64).min(1.0);
        Some(EffectTest {
            effect,
            p_value: (p_value * tested as f64).min(1.0),
            gain,
            material: p_value < THRESHOLDS.significance && self.is_material(effect, &with, &fit, &sizes),
            fit,
        })
    }

    /// Tests each of these effects beside others.
    pub(crate) fn tests_of(&self, effects: &[EffectIndex], beside: &[EffectIndex]) -> Vec<EffectTest> {
        effects.par_iter().filter_map(|&effect| self.test(effect, beside, effects.len())).collect()
    }

    /// Whether lines and carpet, each without the other, show the sizes of an effect of light. Its shape is neutral: there are
    /// few lines.
    fn is_seen_on_both_surfaces(&self, beside: &[EffectIndex], sizes: &[ColumnIndex]) -> bool {
        let mut free = self.fits.columns_of(beside);
        free.extend(sizes);
        self.fits.evidence.p_value_of_both_surfaces(&free, sizes) < THRESHOLDS.surface_significance
    }

    /// P-value of a gain on held-out frames that is `score` standard deviations above zero. Predictions are more informative
    /// than the scatter of a fit if an effect has too many parameters for so few frames, or if another effect is missing
    /// from the model.
    fn predicted_p_value(&self, score: f64) -> f64 {
        if score > 0.0 { two_sided(score, self.fits.evidence.degrees_of_freedom() as f64) } else { 1.0 }
    }

    /// Smallest p-value of an effect's sizes tested one at a time, corrected for their number: few of the sizes may differ
    /// from neutral.
    fn single_size_p_value(&self, beside: &[EffectIndex], sizes: &[ColumnIndex]) -> Option<f64> {
        if !(2..=THRESHOLDS.most_sizes_tested_alone).contains(&sizes.len()) {
            return None;
        }
        let p_value = |&size: &ColumnIndex| {
            let mut free = self.fits.columns_of(beside);
            free.push(size);
            self.fits.evidence.fit(&free).map_or(1.0, |fit| self.fits.evidence.p_value(&fit, &[size]))
        };
        Some(sizes.len() as f64 * sizes.iter().map(p_value).fold(1.0, f64::min))
    }

    /// Whether the fitted sizes are physically possible; a blur, for example, cannot be negative.
    fn is_possible(&self, fit: &Fit, sizes: &[ColumnIndex]) -> bool {
        let below = |column: &ColumnIndex| {
            let parameter = self.fits.columns[column.0].parameter();
            parameter.range[0] >= parameter.neutral && self.fits.coordinate(fit, *column) <= 0.0
        };
        !sizes.iter().all(below)
    }

    /// Whether sizes large enough to matter are significant, jointly or one at a time. One of a field's five dimensions may
    /// be significant but too small, and another large but barely observable; the two parameters of the noise may be
    /// indistinguishable.
    fn is_material(
        &self,
        effect: EffectIndex,
        with: &[EffectIndex],
        fit: &Fit,
        sizes: &[ColumnIndex],
    ) -> bool {
        let matters = |fit: &Fit, column: ColumnIndex| {
            let parameter = self.fits.columns[column.0].parameter();
            (self.fits.value(fit, column) - parameter.neutral).abs() >= parameter.material
        };
        let large: Vec<ColumnIndex> = sizes.iter().copied().filter(|&column| matters(fit, column)).collect();
        if large.is_empty() {
            return false;
        }
        let alone = |&size: &ColumnIndex| {
            let others = sizes.iter().filter(|other| **other != size);
            let mut free = self.fits.columns_of(with);
            others.for_each(|other| free.retain(|column| column != other));
            self.fits.evidence.fit(&free).is_some_and(|fit| {
                let p_value = sizes.len() as f64 * self.fits.evidence.p_value(&fit, &[size]);
                matters(&fit, size) && p_value < THRESHOLDS.material_significance
            })
        };
        changes_over_time(&[effect])
            || self.fits.evidence.p_value(fit, &large) < THRESHOLDS.material_significance
            || (sizes.len() <= THRESHOLDS.most_sizes_tested_alone && sizes.iter().any(alone))
    }

    /// Returns the gain of one set of effects over another on the same held-out frames.
    pub(crate) fn gain(&self, set: &[EffectIndex], over: &[EffectIndex]) -> Option<Gain> {
        let [set, over] = self.held_out_gains([set, over])?;
        Some(set.over(&over))
    }

    /// Returns the gains of two sets on the same held-out frames. The folds are short runs if an effect changes over time.
    fn held_out_gains(&self, sets: [&[EffectIndex]; 2]) -> Option<[HeldOutGains; 2]> {
        let over_time = sets.into_iter().any(changes_over_time);
        let kind = if over_time { FoldKind::ShortRuns } else { FoldKind::Stretches };
        let [first, second] = sets.map(|effects| self.fits.columns_of(effects));
        let shared: Vec<ColumnIndex> =
            first.iter().copied().filter(|column| second.contains(column)).collect();
        let held_out = |free: &[ColumnIndex]| self.folds.gains(&self.fits.evidence, free, &shared, kind);
        Some([held_out(&first)?, held_out(&second)?])
    }
}

/// Returns the smallest p-value of several tests, corrected for their number (Bonferroni).
fn best_of(tests: [Option<f64>; 3]) -> f64 {
    let made = tests.iter().flatten();
    made.clone().count() as f64 * made.fold(1.0, |least: f64, p_value| least.min(*p_value))
}

/// Whether an effect changes the light of places or of frames, that of lines and of carpet alike. What changes with the place in
/// the picture is not taken for a carpet's look by the direction of view.
pub(crate) fn acts_on_light(effect: EffectIndex) -> bool {
    let about = effect.effect().about();
    let is_of_place_or_frame = matches!(about.stage, Stage::World | Stage::Exposure);
    is_of_place_or_frame && about.covariates.contains(&Covariate::Intensity)
}

/// Whether an effect is an error of a surface's nominal brightness. Nuisance parameters predict held-out frames as well as the
/// effect does, but far from their priors.
pub(crate) fn is_reflectance(effect: EffectIndex) -> bool {
    let about = effect.effect().about();
    about.stage == Stage::World && about.needs.contains(&Need::NominalReflectance)
}

/// Whether one of these effects varies over time.
fn changes_over_time(effects: &[EffectIndex]) -> bool {
    effects.iter().any(|effect| effect.effect().about().varies_over_time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_of_several_tests_is_corrected_for_their_number() {
        assert_eq!(best_of([Some(0.25), None, None]), 0.25);
        assert_eq!(best_of([Some(0.25), Some(0.125), None]), 0.25);
        assert_eq!(best_of([Some(0.25), Some(0.125), Some(0.5)]), 0.375);
    }
}
