//! Detect, name, add, until nothing more is found.

use std::collections::BTreeMap;

use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::effect_test::{EffectTest, EffectTests},
    inference::measured::{LinearizedRecording, SEARCH},
    inference::model_search::ModelSearch,
    inference::split::HeldOutSplit,
    linear_model::linearization::{MeasureError, check},
    linear_model::parameters::{FittedParameter, columns},
    recording::Recording,
    workflow::coarse_alignment::placing,
    workflow::progress::Progress,
};

/// No more effects than this are added in one go.
const MOST_EFFECTS: usize = 6;

/// How to work.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Chooses the frames that are kept for judging.
    pub seed: u64,
    /// Effects that are not in the library this time.
    pub without: Vec<String>,
}

/// A model with the effects that were found.
pub(crate) struct SelectedModel {
    pub(crate) columns: Vec<FittedParameter>,
    pub(crate) split: HeldOutSplit,
    /// At the final model.
    pub(crate) measured: LinearizedRecording,
    /// The effects that the model had, and of those found, in the order of finding.
    pub(crate) given: Vec<EffectIndex>,
    pub(crate) named: Vec<EffectIndex>,
    /// How unlikely named effects were chance when they were not yet in the model.
    p_values: BTreeMap<EffectIndex, f64>,
    /// A named effect, and another that leaves as little in its place.
    rivals: Vec<(EffectIndex, EffectIndex)>,
}

impl SelectedModel {
    /// All effects of the extended model.
    pub(crate) fn all(&self) -> Vec<EffectIndex> {
        self.given.iter().chain(&self.named).copied().collect()
    }

    pub(crate) fn naming(&self) -> EffectTests<'_> {
        self.measured.naming(&self.columns)
    }

    /// How unlikely an effect is chance: by the model without it, or by that with it.
    pub(crate) fn p_value(&self, case: &EffectTest) -> f64 {
        self.p_values.get(&case.effect).copied().unwrap_or(1.0).min(case.p_value)
    }

    /// Effects not in the model that stand for one that is as well.
    pub(crate) fn rivals(&self, effect: EffectIndex) -> Vec<EffectIndex> {
        self.rivals.iter().filter(|(of, _)| *of == effect).map(|(_, rival)| *rival).collect()
    }
}

/// Runs the loop. `progress` hears of every stage.
pub(crate) fn find(
    recording: &Recording<'_>,
    model: &Model,
    options: &Options,
    progress: &dyn Fn(Progress),
) -> Result<SelectedModel, MeasureError> {
    check(recording, model)?;
    let columns = columns(&options.without);
    let split = HeldOutSplit::new(recording.frames.len(), options.seed);
    let given: Vec<EffectIndex> =
        model.effects.iter().filter_map(|used| EffectIndex::find(used.effect.id())).collect();
    let finder = ModelSearch { recording, columns: &columns, split: &split, given: &given, progress };
    progress(Progress::Measuring);
    let mut measured = LinearizedRecording::new(recording, model.clone(), &columns, &split, SEARCH[0])?;
    let mut named: Vec<EffectIndex> = Vec::new();
    if !given.is_empty() {
        measured = finder.settle(measured, &given)?;
    }
    // Lines that are not where the model has them are looked for elsewhere; all is compared from there.
    let as_given = measured.model.clone();
    if let Some(placed) = placing(recording, &as_given, &columns, &split)? {
        measured = LinearizedRecording::new(recording, placed, &columns, &split, SEARCH[0])?;
    }
    // Sets that were tried: swapping must not go round in circles.
    let mut tried: Vec<Vec<EffectIndex>> = vec![Vec::new()];
    let mut ties = Vec::new();
    let mut p_values = BTreeMap::new();
    while named.len() < MOST_EFFECTS {
        progress(Progress::Testing);
        if let Some((set, settled)) = finder.dropped(&measured, &named)? {
            (named, measured) = (set, settled);
            continue;
        }
        let is_new = |set: &[EffectIndex]| set.len() <= MOST_EFFECTS && !tried.contains(&sorted(set));
        let sets = finder.next_sets(&measured, &named, is_new);
        let swaps = sets.iter().any(|set| set.len() == named.len());
        let mut closest = finder.closest(&measured, sets)?.into_iter();
        let Some((set, settled)) = closest.next() else { break };
        tried.push(sorted(&set));
        // What looked better may not be, now that it has settled.
        if swaps && finder.left(&settled, &measured.system) > finder.left(&measured, &measured.system) {
            continue;
        }
        for (other, _) in closest {
            tried.push(sorted(&other));
            ties.extend(differing(&set, &other));
        }
        let new = set.iter().copied().filter(|effect| !named.contains(effect));
        p_values.extend(new.filter_map(|effect| Some((effect, finder.p_value(&measured, &named, effect)?))));
        (named, measured) = (set, settled);
    }
    if named.is_empty() && measured.model != as_given {
        measured = LinearizedRecording::new(recording, as_given, &columns, &split, SEARCH[1])?;
    }
    let rivals = finder.rivals(&measured, &named, &ties)?;
    Ok(SelectedModel { columns, split, measured, given, named, p_values, rivals })
}

/// A recording measured with a model as it is.
pub(crate) fn as_given(
    recording: &Recording<'_>,
    model: &Model,
    options: &Options,
) -> Result<SelectedModel, MeasureError> {
    check(recording, model)?;
    let columns = columns(&options.without);
    let split = HeldOutSplit::new(recording.frames.len(), options.seed);
    let measured = LinearizedRecording::new(recording, model.clone(), &columns, &split, SEARCH[1])?;
    let (given, named, p_values, rivals) = Default::default();
    Ok(SelectedModel { columns, split, measured, given, named, p_values, rivals })
}

/// The one effect of a set that another set has something else for.
fn differing(set: &[EffectIndex], other: &[EffectIndex]) -> Option<(EffectIndex, EffectIndex)> {
    let of = set.iter().find(|effect| !other.contains(effect))?;
    let instead = other.iter().find(|effect| !set.contains(effect))?;
    Some((*of, *instead))
}

fn sorted(effects: &[EffectIndex]) -> Vec<EffectIndex> {
    let mut sorted = effects.to_vec();
    sorted.sort_unstable();
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_differ_by_one_effect_in_the_place_of_another() {
        let effects: Vec<EffectIndex> = EffectIndex::all().take(3).collect();
        let [one, two, three] = effects[..] else { panic!() };
        assert_eq!(differing(&[one, two], &[one, three]), Some((two, three)));
        assert_eq!(differing(&[one, two], &[two, one]), None);
    }
}
