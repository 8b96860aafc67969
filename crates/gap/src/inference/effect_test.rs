//! Which effects are missing: one after the other is added while the frames that a fit has not seen get more likely.

use nalgebra::DVector;
use rayon::prelude::*;
use reality_sim_sensor::{Covariate, EffectIndex};

use crate::{
    inference::evidence::{Evidence, Gain, HeldOut, two_sided},
    linear_model::column::ColumnIndex,
    linear_model::parameters::FittedParameter,
    linear_model::reduced_equations::Fit,
    recording::LEAST_VIEWS,
};

/// Sizes that matter are no chance below this.
const LARGE_BY_CHANCE: f64 = 0.05;
/// An effect is named where it is this unlikely to be chance, corrected for all effects tested.
pub(crate) const ALPHA: f64 = 0.005;
/// And where its gain on unseen frames is this many standard deviations above zero.
pub(crate) const LEAST_SCORE: f64 = 2.5;
/// And is at least this large: a factor of fifty in likelihood.
const LEAST_GAIN: f64 = 4.0;
/// An effect this unlikely to be chance is looked at beside others.
const CONSPICUOUS: f64 = 0.05;
/// No more of them are.
const MOST_LEADS: usize = 3;
/// Parameters of an effect with no more sizes than this are tried one by one, too.
const TRIED_ALONE: usize = 12;
/// Effects whose gains are this many standard deviations of their difference apart can be told apart.
pub(crate) const TELLS_APART: f64 = 2.5;

/// An effect that gains this part of what the best one does, and leaves nothing for it to add, may be the right one.
const STANDS_FOR: f64 = 0.4;
/// No more than this many are tried in full.
const MOST_ALTERNATIVES: usize = 3;

/// What speaks for an effect.
#[derive(Debug, Clone)]
pub(crate) struct EffectTest {
    pub(crate) effect: EffectIndex,
    /// Corrected for the number of effects tested.
    pub(crate) p_value: f64,
    /// On unseen frames, over the same model without it.
    pub(crate) gain: Gain,
    /// Whether it is large enough to matter.
    pub(crate) material: bool,
    pub(crate) fit: Fit,
}

impl EffectTest {
    pub(crate) fn holds(&self) -> bool {
        let gains = self.gain.value > LEAST_GAIN && self.gain.score() > LEAST_SCORE;
        self.material && self.p_value < ALPHA && gains
    }
}

/// The evidence with names.
pub(crate) struct EffectTests<'a> {
    pub(crate) evidence: Evidence<'a>,
    pub(crate) columns: &'a [FittedParameter],
}

impl EffectTests<'_> {
    /// Columns of some effects.
    pub(crate) fn columns_of(&self, effects: &[EffectIndex]) -> Vec<ColumnIndex> {
        let all = ColumnIndex::first(self.columns.len());
        all.filter(|column| effects.contains(&self.columns[column.0].effect)).collect()
    }

    /// The effects that have columns.
    pub(crate) fn effects(&self) -> Vec<EffectIndex> {
        let mut effects: Vec<EffectIndex> = self.columns.iter().map(|column| column.effect).collect();
        effects.dedup();
        effects
    }

    /// What speaks for an effect beside others, `tested` effects being tried.
    pub(crate) fn case(
        &self,
        effect: EffectIndex,
        beside: &[EffectIndex],
        tested: usize,
    ) -> Option<EffectTest> {
        let without: Vec<EffectIndex> = beside.iter().copied().filter(|other| *other != effect).collect();
        let with: Vec<EffectIndex> = without.iter().copied().chain([effect]).collect();
        let free = self.columns_of(&with);
        let fit = self.evidence.fit(&free)?;
        let sizes: Vec<ColumnIndex> = self
            .columns_of(&[effect])
            .into_iter()
            .filter(|&column| self.columns[column.0].is_size())
            .collect();
        let [held_out, others] = self.held_out([&with, &without])?;
        let gain = held_out.over(&others);
        let p_value = if self.is_possible(&fit, &sizes) {
            let together = Some(self.evidence.p_value(&fit, &sizes));
            // Patches of the carpet are where other frames have seen them: they foretell as a place's effect does.
            let keeps_place = effect.effect().covariates().contains(&Covariate::FieldPosition);
            let foretold = (!keeps_place).then(|| self.foretold(held_out.surely_over(&others)));
            best_of([together, self.alone(&without, &sizes), foretold])
        } else {
            1.0
        };
        Some(EffectTest {
            effect,
            p_value: (p_value * tested as f64).min(1.0),
            gain,
            material: p_value < ALPHA && self.is_material(effect, &with, &fit, &sizes),
            fit,
        })
    }

    /// What speaks for each of these effects, all tried beside others.
    fn cases(&self, effects: &[EffectIndex], beside: &[EffectIndex]) -> Vec<EffectTest> {
        effects.par_iter().filter_map(|&effect| self.case(effect, beside, effects.len())).collect()
    }

    /// Fits effects, no parameter outside its range: one that would be is held at the range's end, and the others are
    /// fitted with it there.
    pub(crate) fn fit_in_range(&self, effects: &[EffectIndex]) -> Option<Fit> {
        let mut free = self.columns_of(effects);
        let mut held = -&self.evidence.base;
        loop {
            let fit = self.evidence.fit_beside(&free, &held)?;
            let farthest = free.iter().copied().map(|column| (column, self.outside(&fit, column)));
            match farthest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
                Some((column, outside)) if outside != 0.0 => {
                    held[column.0] = fit.delta[column.0] - outside;
                    free.retain(|&other| other != column);
                }
                _ => return Some(fit),
            }
        }
    }

    /// How far beyond its range a fitted column is.
    fn outside(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        let coordinate = self.coordinate(fit, column);
        let inside = self.columns[column.0].coordinate(self.columns[column.0].value(coordinate));
        if (coordinate - inside).abs() > 1e-9 { coordinate - inside } else { 0.0 }
    }

    /// How unlikely what an effect gains on unseen frames, so many standard deviations, is chance. Of many numbers from few
    /// frames, or where another effect is missing, a fit's scatter tells little; what it foretells does.
    fn foretold(&self, score: f64) -> f64 {
        if score > 0.0 { two_sided(score, self.evidence.degrees() as f64) } else { 1.0 }
    }

    /// The least p-value of one of an effect's sizes alone, corrected for their number: few of them may be at work.
    fn alone(&self, beside: &[EffectIndex], sizes: &[ColumnIndex]) -> Option<f64> {
        if !(2..=TRIED_ALONE).contains(&sizes.len()) {
            return None;
        }
        let p_value = |&size: &ColumnIndex| {
            let mut free = self.columns_of(beside);
            free.push(size);
            self.evidence.fit(&free).map_or(1.0, |fit| self.evidence.p_value(&fit, &[size]))
        };
        Some(sizes.len() as f64 * sizes.iter().map(p_value).fold(1.0, f64::min))
    }

    /// What cannot be below none, as a blur, is no effect where it would have to be.
    fn is_possible(&self, fit: &Fit, sizes: &[ColumnIndex]) -> bool {
        let below = |column: &ColumnIndex| {
            let parameter = self.columns[column.0].parameter();
            parameter.range[0] >= parameter.neutral && self.coordinate(fit, *column) <= 0.0
        };
        !sizes.iter().all(below)
    }

    pub(crate) fn coordinate(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        self.evidence.base[column.0] + fit.delta[column.0]
    }

    pub(crate) fn value(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        self.columns[column.0].value(self.coordinate(fit, column))
    }

    /// Whether sizes that would matter are surely not chance, together or one alone: of a field's five, one may be sure and
    /// too small, another large and hardly seen; of noise's two, neither can be told from the other.
    fn is_material(
        &self,
        effect: EffectIndex,
        with: &[EffectIndex],
        fit: &Fit,
        sizes: &[ColumnIndex],
    ) -> bool {
        let matters = |fit: &Fit, column: ColumnIndex| {
            let parameter = self.columns[column.0].parameter();
            (self.value(fit, column) - parameter.neutral).abs() >= parameter.material
        };
        let large: Vec<ColumnIndex> = sizes.iter().copied().filter(|&column| matters(fit, column)).collect();
        if large.is_empty() {
            return false;
        }
        let alone = |&size: &ColumnIndex| {
            let others = sizes.iter().filter(|other| **other != size);
            let mut free = self.columns_of(with);
            others.for_each(|other| free.retain(|column| column != other));
            self.evidence.fit(&free).is_some_and(|fit| {
                let p_value = sizes.len() as f64 * self.evidence.p_value(&fit, &[size]);
                matters(&fit, size) && p_value < LARGE_BY_CHANCE
            })
        };
        changes_over_time(&[effect])
            || self.evidence.p_value(fit, &large) < LARGE_BY_CHANCE
            || (sizes.len() <= TRIED_ALONE && sizes.iter().any(alone))
    }

    /// What to add to what is named: the effect that speaks most for itself, and behind it those that may stand for it, as
    /// the linearised model cannot tell for sure which of them is closest to what is large. Where none does, two that do
    /// together.
    pub(crate) fn next(&self, named: &[EffectIndex]) -> Vec<Vec<EffectIndex>> {
        if self.evidence.views() < LEAST_VIEWS {
            return Vec::new();
        }
        let others: Vec<EffectIndex> =
            self.effects().into_iter().filter(|effect| !named.contains(effect)).collect();
        let tested = self.cases(&others, named);
        let mut cases: Vec<&EffectTest> = tested.iter().filter(|case| case.holds()).collect();
        cases.sort_by(|a, b| b.gain.value.total_cmp(&a.gain.value));
        let Some(best) = cases.first() else {
            return Vec::from_iter(self.two(&tested, &others, named).map(Vec::from));
        };
        let stands_for = |case: &&&EffectTest| {
            case.gain.value > STANDS_FOR * best.gain.value
                && !self.adds(best.effect, case.effect, named, others.len())
        };
        let alternatives = cases[1..].iter().filter(stands_for).take(MOST_ALTERNATIVES);
        std::iter::once(best).chain(alternatives).map(|case| vec![case.effect]).collect()
    }

    /// Two of the others that speak for themselves beside each other, where none does alone: each hides the other where both
    /// are large. One of them has to be conspicuous alone.
    fn two(
        &self,
        alone: &[EffectTest],
        others: &[EffectIndex],
        named: &[EffectIndex],
    ) -> Option<[EffectIndex; 2]> {
        let pairs = others.len() * others.len().saturating_sub(1) / 2;
        let holds = |effect: EffectIndex, beside: EffectIndex| {
            let beside: Vec<EffectIndex> = named.iter().copied().chain([beside]).collect();
            self.case(effect, &beside, pairs).is_some_and(|case| case.holds())
        };
        let mut leads: Vec<&EffectTest> = alone.iter().filter(|case| case.p_value < CONSPICUOUS).collect();
        leads.sort_by(|a, b| a.p_value.total_cmp(&b.p_value));
        let leads = leads.into_iter().take(MOST_LEADS);
        let tries = leads.flat_map(|lead| others.iter().map(move |&other| [lead.effect, other]));
        let found = tries
            .collect::<Vec<[EffectIndex; 2]>>()
            .into_par_iter()
            .filter(|[lead, other]| lead != other && holds(*lead, *other) && holds(*other, *lead))
            .filter_map(|two| {
                let set: Vec<EffectIndex> = named.iter().copied().chain(two).collect();
                Some((self.gain(&set, named)?.value, two))
            });
        found.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, two)| two)
    }

    /// Effects not named that explain clearly more than one named does, in its place: the old one, the new one; those that
    /// gain most come first.
    pub(crate) fn better(
        &self,
        all: &[EffectIndex],
        named: &[EffectIndex],
    ) -> Vec<(EffectIndex, EffectIndex)> {
        let others: Vec<EffectIndex> =
            self.effects().into_iter().filter(|effect| !all.contains(effect)).collect();
        let tries = named.iter().flat_map(|&old| others.iter().map(move |&new| (old, new)));
        let tries: Vec<(EffectIndex, EffectIndex)> = tries.collect();
        let gains = tries.into_par_iter().filter_map(|(old, new)| {
            let without: Vec<EffectIndex> = all.iter().copied().filter(|effect| *effect != old).collect();
            self.case(new, &without, others.len()).filter(EffectTest::holds)?;
            let set: Vec<EffectIndex> = without.iter().copied().chain([new]).collect();
            let gain = self.gain(&set, all)?;
            let replaces = gain.score() > TELLS_APART && !self.adds(old, new, &without, others.len());
            replaces.then_some((gain.value, (old, new)))
        });
        let mut gains: Vec<(f64, (EffectIndex, EffectIndex))> = gains.collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        gains.into_iter().map(|(_, pair)| pair).collect()
    }

    /// Other effects that explain as much as one of those named does, in its place.
    pub(crate) fn rivals(&self, effect: EffectIndex, named: &[EffectIndex]) -> Vec<EffectIndex> {
        let without: Vec<EffectIndex> = named.iter().copied().filter(|other| *other != effect).collect();
        let others: Vec<EffectIndex> =
            self.effects().into_iter().filter(|other| !named.contains(other)).collect();
        let rivals = |other: &EffectIndex| {
            let holds = self.case(*other, &without, others.len()).is_some_and(|case| case.holds());
            let set: Vec<EffectIndex> = without.iter().copied().chain([*other]).collect();
            holds
                && self.gain(named, &set).is_some_and(|gain| gain.score() < TELLS_APART)
                && !self.adds(effect, *other, &without, others.len())
        };
        others.par_iter().copied().filter(rivals).collect()
    }

    /// What one set of effects gains over another, both judged on the same unseen frames.
    fn gain(&self, set: &[EffectIndex], over: &[EffectIndex]) -> Option<Gain> {
        let [set, over] = self.held_out([set, over])?;
        Some(set.over(&over))
    }

    /// What two sets gain on the same unseen frames: short runs of them where one changes over time.
    fn held_out(&self, sets: [&[EffectIndex]; 2]) -> Option<[HeldOut; 2]> {
        let over_time = sets.into_iter().any(changes_over_time);
        let [first, second] = sets.map(|effects| self.columns_of(effects));
        let shared: Vec<ColumnIndex> =
            first.iter().copied().filter(|column| second.contains(column)).collect();
        let held_out = |free: &[ColumnIndex]| self.evidence.held_out(free, &shared, over_time);
        Some([held_out(&first)?, held_out(&second)?])
    }

    /// Whether an effect has something to add to another one: then they are two, not one in two shapes.
    fn adds(&self, effect: EffectIndex, other: EffectIndex, without: &[EffectIndex], tested: usize) -> bool {
        let beside: Vec<EffectIndex> = without.iter().copied().chain([other]).collect();
        self.case(effect, &beside, tested).is_some_and(|case| case.holds())
    }
}

/// The least p-value of several tests, corrected for their number.
fn best_of(tests: [Option<f64>; 3]) -> f64 {
    let made = tests.iter().flatten();
    made.clone().count() as f64 * made.fold(1.0, |least: f64, p_value| least.min(*p_value))
}

/// Whether one of these effects varies over time.
fn changes_over_time(effects: &[EffectIndex]) -> bool {
    effects.iter().any(|effect| effect.effect().about().varies_over_time)
}

/// Where a model is, in the columns' coordinates.
pub(crate) fn base(columns: &[FittedParameter], model: &reality_sim_sensor::Model) -> DVector<f64> {
    DVector::from_iterator(columns.len(), columns.iter().map(|column| column.coordinate_in(model)))
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
