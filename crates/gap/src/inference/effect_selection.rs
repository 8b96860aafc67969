//! Choice of effects to add to a model, to replace in it, or to name as confusable, by tests of the linearised model.

use std::cmp::Ordering;

use rayon::prelude::*;
use reality_sim_sensor::EffectIndex;

use crate::{
    inference::effect_test::{EffectTest, EffectTests, is_reflectance},
    recording::LEAST_VIEWS,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

impl EffectTests<'_> {
    /// Returns the sets of effects to try adding, of those for which `is_new`. The first is the supported effect with the largest
    /// gain, and one of brightness against stated values only where there is no other. Its alternatives follow, because a
    /// linearised model cannot tell reliably which of several large effects fits best. If no effect is supported alone, returns
    /// a pair that is supported, if there is one.
    pub(crate) fn next_additions(
        &self,
        named: &[EffectIndex],
        is_new: impl Fn(&[EffectIndex]) -> bool,
    ) -> Vec<Vec<EffectIndex>> {
        if self.fits.evidence.views() < LEAST_VIEWS {
            return Vec::new();
        }
        let others: Vec<EffectIndex> =
            self.fits.effects().into_iter().filter(|effect| !named.contains(effect)).collect();
        let tested = self.tests_of(&others, named);
        let mut supported: Vec<&EffectTest> = tested.iter().filter(|test| test.is_supported()).collect();
        if supported.is_empty() {
            let pair = self.pair_of(&tested, &others, named).filter(|pair| is_new(pair));
            return Vec::from_iter(pair.map(Vec::from));
        }
        // What was tried and did not last leaves its place to others.
        supported.retain(|test| is_new(&[test.effect]));
        // Whatever else changes brightness changes that of surfaces against what is stated, too.
        let order = |test: &EffectTest| (is_reflectance(test.effect), -test.gain.value);
        supported.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(Ordering::Equal));
        let Some(best) = supported.first() else { return Vec::new() };
        // With more sizes a large effect may add to a simpler one that, once both have converged, explains as much.
        let sizes = |test: &EffectTest| self.fits.sizes_of(test.effect).len();
        let stands_for = |test: &&&EffectTest| {
            test.gain.value > THRESHOLDS.least_gain_ratio * best.gain.value
                && (sizes(test) < sizes(best) || !self.adds(best.effect, test.effect, named, others.len()))
        };
        let alternatives = supported[1..].iter().filter(stands_for).take(THRESHOLDS.most_alternatives);
        std::iter::once(best).chain(alternatives).map(|test| vec![test.effect]).collect()
    }

    /// Finds two effects that are supported beside each other although neither is supported alone: two large effects can
    /// hide each other. At least one of them must have a low p-value alone.
    fn pair_of(
        &self,
        alone: &[EffectTest],
        others: &[EffectIndex],
        named: &[EffectIndex],
    ) -> Option<[EffectIndex; 2]> {
        let pairs = others.len() * others.len().saturating_sub(1) / 2;
        let is_supported = |effect: EffectIndex, beside: EffectIndex| {
            let beside: Vec<EffectIndex> = named.iter().copied().chain([beside]).collect();
            self.test(effect, &beside, pairs).is_some_and(|test| test.is_supported())
        };
        let mut leads: Vec<&EffectTest> =
            alone.iter().filter(|test| test.p_value < THRESHOLDS.lead_p_value).collect();
        leads.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        let leads = leads.into_iter().take(THRESHOLDS.most_leads);
        let tries = leads.flat_map(|lead| others.iter().map(move |&other| [lead.effect, other]));
        let found = tries
            .collect::<Vec<[EffectIndex; 2]>>()
            .into_par_iter()
            .filter(|[lead, other]| {
                lead != other && is_supported(*lead, *other) && is_supported(*other, *lead)
            })
            .filter_map(|two| {
                let set: Vec<EffectIndex> = named.iter().copied().chain(two).collect();
                Some((self.gain(&set, named)?.value, two))
            });
        found.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, two)| two)
    }

    /// Returns pairs of a named effect and an effect outside the model that explains clearly more in its place, the largest
    /// gain first.
    pub(crate) fn replacements(
        &self,
        all: &[EffectIndex],
        named: &[EffectIndex],
    ) -> Vec<(EffectIndex, EffectIndex)> {
        let others: Vec<EffectIndex> =
            self.fits.effects().into_iter().filter(|effect| !all.contains(effect)).collect();
        let tries = named.iter().flat_map(|&old| others.iter().map(move |&new| (old, new)));
        let tries: Vec<(EffectIndex, EffectIndex)> = tries.collect();
        let gains = tries.into_par_iter().filter_map(|(old, new)| {
            let without: Vec<EffectIndex> = all.iter().copied().filter(|effect| *effect != old).collect();
            self.test(new, &without, others.len()).filter(EffectTest::is_supported)?;
            let set: Vec<EffectIndex> = without.iter().copied().chain([new]).collect();
            let gain = self.gain(&set, all)?;
            let replaces = gain.score() > THRESHOLDS.distinguishable_score
                && !self.adds(old, new, &without, others.len());
            replaces.then_some((gain.value, (old, new)))
        });
        let mut gains: Vec<(f64, (EffectIndex, EffectIndex))> = gains.collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        gains.into_iter().map(|(_, pair)| pair).collect()
    }

    /// Returns the effects outside the model that explain as much as a named one in its place.
    pub(crate) fn confusable_with(&self, effect: EffectIndex, named: &[EffectIndex]) -> Vec<EffectIndex> {
        let without: Vec<EffectIndex> = named.iter().copied().filter(|other| *other != effect).collect();
        let others: Vec<EffectIndex> =
            self.fits.effects().into_iter().filter(|other| !named.contains(other)).collect();
        let is_confusable = |other: &EffectIndex| {
            let is_supported =
                self.test(*other, &without, others.len()).is_some_and(|test| test.is_supported());
            let set: Vec<EffectIndex> = without.iter().copied().chain([*other]).collect();
            is_supported
                && self.gain(named, &set).is_some_and(|gain| gain.score() < THRESHOLDS.distinguishable_score)
                && !self.adds(effect, *other, &without, others.len())
        };
        others.par_iter().copied().filter(is_confusable).collect()
    }

    /// Whether an effect is supported beside another one. If so, the two are not the same effect in different parameters.
    fn adds(&self, effect: EffectIndex, other: EffectIndex, without: &[EffectIndex], tested: usize) -> bool {
        let beside: Vec<EffectIndex> = without.iter().copied().chain([other]).collect();
        self.test(effect, &beside, tested).is_some_and(|test| test.is_supported())
    }
}
