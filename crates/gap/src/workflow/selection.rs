//! Selection of effects: adds one after another to the model until no further one is supported.

use std::collections::BTreeMap;

use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::linearized_recording::LinearizedRecording,
    inference::model_search::{ConvergedSet, ModelSearch},
    inference::recording_source::FittedRecording,
    inference::selected_model::SelectedModel,
    inference::split::HeldOutSplit,
    linear_model::linearization::{MeasureError, check},
    linear_model::parameters::fitted_parameters,
    progress::Progress,
    recording::Recording,
    simplification::Simplification,
    thresholds::Thresholds,
    workflow::coarse_alignment::coarsely_aligned,
    workflow::fixed_values::search_fixed_values,
};

const SEARCH_FIRST: f64 = Thresholds::DEFAULT.inference.search_first;
const SEARCH_AGAIN: f64 = Thresholds::DEFAULT.inference.search_again;

/// Options of an analysis.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Seed that chooses the frames that are held out.
    pub seed: u64,
    /// Ids of effects that are left out of the library.
    pub without: Vec<String>,
}

/// Selects the effects that a recording supports in addition to those of a model. `progress` is called at every stage.
pub(crate) fn find(
    recording: &Recording<'_>,
    model: &Model,
    options: &Options,
    progress: &dyn Fn(Progress),
) -> Result<SelectedModel, MeasureError> {
    check(recording, model)?;
    let columns = fitted_parameters(&options.without);
    let split = HeldOutSplit::new(recording.frames.len(), options.seed);
    let given = effects_of(model);
    let source = FittedRecording { recording, columns: &columns, split: &split };
    // Only the workflow's own selection asks what else explains as much.
    let settles_ties = matches!(
        recording.simplification,
        None | Some(Simplification::ExactPoses | Simplification::EvenSurfaces)
    );
    let search = ModelSearch {
        source: &source,
        columns: &columns,
        split: &split,
        given: &given,
        progress,
        settles_ties,
    };
    let (as_given, at_start) = start(recording, model, &search)?;
    let added = match recording.simplification {
        Some(Simplification::InformationCriterion) => search.by_information_criterion(at_start)?.into(),
        Some(Simplification::CrossValidation) => search.by_cross_validation(at_start)?.into(),
        _ => one_after_another(&search, at_start)?.confirmed(&search, model)?,
    };
    let Added { named, mut linearized, p_values, ties } = added;
    if named.is_empty() && linearized.model != as_given {
        linearized = LinearizedRecording::new(recording, as_given, &columns, &split, SEARCH_AGAIN)?;
    }
    let confusable = search.confusable(&linearized, &named, &ties)?;
    Ok(SelectedModel { columns, split, linearized, given, named, p_values, confusable })
}

/// Effects that were added to a model.
struct Added {
    named: Vec<EffectIndex>,
    linearized: LinearizedRecording,
    /// P-values with which they were added.
    p_values: BTreeMap<EffectIndex, f64>,
    /// Effects with others that explained as much when they were added.
    ties: Vec<(EffectIndex, EffectIndex)>,
}

impl From<ConvergedSet> for Added {
    fn from((named, linearized): ConvergedSet) -> Self {
        Self { named, linearized, p_values: BTreeMap::new(), ties: Vec::new() }
    }
}

impl Added {
    /// Returns the effects that held-out frames confirm.
    fn confirmed(self, search: &ModelSearch<'_>, before: &Model) -> Result<Self, MeasureError> {
        let (named, linearized) = search.confirmed(before, (self.named, self.linearized))?;
        Ok(Self { named, linearized, ..self })
    }
}

/// Adds effects one after another until no further one is supported.
fn one_after_another(
    search: &ModelSearch<'_>,
    mut linearized: LinearizedRecording,
) -> Result<Added, MeasureError> {
    let mut named: Vec<EffectIndex> = Vec::new();
    // Sets that were tried, so that replacements do not go round in circles.
    let mut tried: Vec<Vec<EffectIndex>> = vec![Vec::new()];
    let mut ties = Vec::new();
    let mut p_values = BTreeMap::new();
    while named.len() < Thresholds::DEFAULT.workflow.most_effects {
        (search.progress)(Progress::Testing);
        let tests = linearized.effect_tests(search.columns);
        if let Some((set, converged)) = search.without_unsupported(&linearized, &tests, &named)? {
            (named, linearized) = (set, converged);
            continue;
        }
        let is_new = |set: &[EffectIndex]| {
            set.len() <= Thresholds::DEFAULT.workflow.most_effects && !tried.contains(&sorted(set))
        };
        let sets = search.next_sets(&tests, &named, is_new);
        let is_replacement = sets.iter().any(|set| set.len() == named.len());
        let mut best = search.best_sets(&linearized, sets)?.into_iter();
        let Some((set, converged)) = best.next() else { break };
        tried.push(sorted(&set));
        // A replacement that is better in the linearised model may be worse once it has converged.
        let misfit = |model: &LinearizedRecording| search.minus_log_likelihood(model, &linearized.system);
        if is_replacement && misfit(&converged) > misfit(&linearized) {
            continue;
        }
        for (other, _) in best {
            tried.push(sorted(&other));
            ties.extend(differing(&set, &other));
        }
        let new = set.iter().copied().filter(|effect| !named.contains(effect));
        p_values.extend(new.filter_map(|effect| Some((effect, search.p_value(&tests, &named, effect)?))));
        (named, linearized) = (set, converged);
    }
    Ok(Added { named, linearized, p_values, ties })
}

/// Returns the model with its given effects fitted, and the recording linearised where the search for further effects starts:
/// at that model or, if lines are far from where it predicts them, at a coarsely aligned one.
fn start(
    recording: &Recording<'_>,
    model: &Model,
    search: &ModelSearch<'_>,
) -> Result<(Model, LinearizedRecording), MeasureError> {
    (search.progress)(Progress::Measuring);
    let linearize =
        |model: Model| LinearizedRecording::new(recording, model, search.columns, search.split, SEARCH_FIRST);
    let mut linearized = linearize(model.clone())?;
    if !search.given.is_empty() {
        linearized = search.converge(linearized, search.given)?;
    }
    let as_given = linearized.model.clone();
    if let Some(aligned) = coarsely_aligned(recording, &as_given, search.columns, search.split)? {
        linearized = linearize(aligned)?;
    }
    search_fixed_values(recording, &linearized, search.split)?;
    Ok((as_given, linearized.again(recording, search.columns, search.split)?))
}

/// Returns the effects of a model that are in the library.
fn effects_of(model: &Model) -> Vec<EffectIndex> {
    model.effects.iter().filter_map(|used| EffectIndex::find(used.effect.id())).collect()
}

/// Measures a recording with a model as it is, without a selection.
pub(crate) fn as_given(
    recording: &Recording<'_>,
    model: &Model,
    options: &Options,
) -> Result<SelectedModel, MeasureError> {
    check(recording, model)?;
    let columns = fitted_parameters(&options.without);
    let split = HeldOutSplit::new(recording.frames.len(), options.seed);
    let linearized = LinearizedRecording::new(recording, model.clone(), &columns, &split, SEARCH_AGAIN)?;
    let (given, named, p_values, confusable) = Default::default();
    Ok(SelectedModel { columns, split, linearized, given, named, p_values, confusable })
}

/// Returns an effect of the first set that the other set lacks, with the one that the other set has instead.
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
