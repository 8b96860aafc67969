//! Run of the study: a recording, the workflow, and the outcome.

use std::{collections::BTreeMap, error::Error, path::Path, time::Instant};

use reality_sim::{
    Sequence,
    gap::{
        Options, Recording, RecordingError, ReferenceSource, analyse, gap_of,
        report::{Finding, Report, Verdict},
    },
    sensor::{Model, effect},
};
use reality_sim_hidden::{Hidden, Random, Recipe};
use serde::{Deserialize, Serialize};

use crate::{
    plan::{Chosen, Task},
    truth::{has_the_librarys_form, main_size, parameters},
};

/// Outcome of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    pub task: Task,
    pub hidden: Vec<Chosen>,
    /// Main sizes of the hidden effects.
    pub hidden_sizes: Vec<f64>,
    pub verdict: Verdict,
    /// Named effects, each with those that it is confusable with.
    pub named: Vec<(String, Vec<String>)>,
    pub unexplained: Vec<Finding>,
    /// Comparison of estimates with the true values, for parameters whose true value is known.
    pub estimates: Vec<Compared>,
    /// Gap over all channels, before and after. `oracle` is the gap with the true effects in the model, if the library can
    /// express them.
    pub gap: [f64; 2],
    pub oracle: Option<f64>,
    pub seconds: f64,
    /// Detection limits by effect: name of the parameter and its size.
    pub limits: BTreeMap<String, (String, f64)>,
}

/// Estimate of a parameter beside its true value.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Compared {
    pub effect: String,
    pub parameter: String,
    pub truth: f64,
    pub value: f64,
    pub sigma: f64,
}

impl Outcome {
    pub fn line(&self) -> String {
        let hidden: Vec<String> = self
            .hidden
            .iter()
            .zip(&self.hidden_sizes)
            .map(|(chosen, size)| {
                let Chosen { id, multiple, in_limits } = chosen;
                format!("{id} {size:.3e} = {multiple:.3} × = {in_limits:.1} limits")
            })
            .collect();
        format!(
            "{:?} {} {:?} -> {:?} {:?} {:?} {:.1}s",
            self.task.part, self.task.seed, hidden, self.verdict, self.named, self.unexplained, self.seconds
        )
    }
}

/// Records a task's sequence with these effects hidden; the seed draws their signs and shapes.
pub fn record(
    task: &Task,
    hidden: &[Chosen],
    folder: &Path,
) -> Result<(Sequence, Vec<Hidden>), Box<dyn Error>> {
    let mut random = Random::new(task.seed.wrapping_mul(77));
    let drawn = hidden.iter().map(|chosen| Hidden::of(&chosen.id, chosen.multiple, &mut random));
    let effects: Vec<Hidden> = drawn.collect::<Result<_, _>>()?;
    let mut recipe = Recipe::new(task.seed);
    recipe.frames = task.frames;
    recipe.size = task.picture;
    recipe.effects.clone_from(&effects);
    Ok((recipe.record(folder)?, effects))
}

/// Runs a task with these effects hidden.
pub fn run(task: &Task, hidden: &[Chosen]) -> Result<Outcome, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (sequence, effects) = record(task, hidden, folder.path())?;
    let start = Instant::now();
    let options = Options { seed: task.seed, without: task.without.iter().cloned().collect() };
    let report = examine(&sequence, &Model::default(), &options)?;
    let seconds = start.elapsed().as_secs_f64();
    Ok(Outcome {
        task: task.clone(),
        hidden: hidden.to_vec(),
        hidden_sizes: effects.iter().map(main_size).collect(),
        verdict: report.verdict,
        named: report
            .effects
            .iter()
            .map(|effect| (effect.id.clone(), effect.confusable_with.clone()))
            .collect(),
        unexplained: report.unexplained.clone(),
        estimates: effects.iter().flat_map(|hidden| compared(hidden, &report)).collect(),
        gap: [report.gap.before, report.gap.after],
        oracle: oracle(&sequence, &effects, &options)?,
        seconds,
        limits: report
            .not_found
            .iter()
            .map(|effect| (effect.id.clone(), (effect.parameter.clone(), effect.detection_limit.value)))
            .collect(),
    })
}

fn examine(sequence: &Sequence, model: &Model, options: &Options) -> Result<Report, Box<dyn Error>> {
    Ok(analyse(&open(sequence)?, model, options, &|_| ())?.report)
}

/// Opens a recording with all of its frames and their true poses.
fn open(sequence: &Sequence) -> Result<Recording<'_>, RecordingError> {
    let poses: Vec<_> = sequence.reference_poses().collect();
    Recording::new(sequence, &poses, ReferenceSource::Measured, None)
}

fn compared(hidden: &Hidden, report: &Report) -> Vec<Compared> {
    let Some(found) = report.effects.iter().find(|effect| effect.id == hidden.id()) else {
        return Vec::new();
    };
    let one = |(name, truth): (&'static str, f64)| {
        let estimate = found.parameters.get(name)?;
        Some(Compared {
            effect: found.id.clone(),
            parameter: name.to_owned(),
            truth,
            value: estimate.value,
            sigma: estimate.sigma,
        })
    };
    parameters(hidden).into_iter().filter_map(one).collect()
}

/// Returns the gap with the true effects in the model. None unless the library has all of them in exactly the form in which
/// they are hidden.
fn oracle(sequence: &Sequence, effects: &[Hidden], options: &Options) -> Result<Option<f64>, Box<dyn Error>> {
    let mut model = Model::default();
    for hidden in effects {
        let Some(known) = effect(hidden.id()).filter(|_| has_the_librarys_form(hidden)) else {
            return Ok(None);
        };
        let truth = parameters(hidden);
        let value = |name: &str| truth.iter().find(|(of, _)| *of == name).map_or(0.0, |(_, value)| *value);
        let values: Vec<f64> = known.parameters().iter().map(|parameter| value(parameter.name)).collect();
        model = model.with(known, values);
    }
    if effects.is_empty() {
        return Ok(None);
    }
    Ok(Some(gap_of(&open(sequence)?, &model, options)?.before))
}
