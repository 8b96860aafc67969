//! Run of the study: a recording, the workflow, and the outcome.

use std::{collections::BTreeMap, error::Error, time::Instant};

use reality_sim::{
    Sequence,
    gap::{
        Options,
        report::{Finding, Report, Verdict},
    },
    sensor::{Model, effect},
};
use reality_sim_hidden::Hidden;
use serde::{Deserialize, Serialize};

use crate::{
    memory,
    plan::{Chosen, Task},
    studio::{Studio, effects},
    truth::{has_the_librarys_form, main_size, parameters},
    workflow::{self, Workflow},
};

/// Detection limits by effect: name of the parameter and its size.
pub type Limits = BTreeMap<String, (String, f64)>;

/// Outcome of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// Fingerprint of the code that was run.
    pub code: String,
    pub workflow: Workflow,
    pub task: Task,
    pub world: World,
    pub hidden: Vec<Chosen>,
    /// Main sizes of the hidden effects.
    pub hidden_sizes: Vec<f64>,
    /// None if the workflow refused the recording: the message is `refused`.
    pub verdict: Option<Verdict>,
    pub refused: Option<String>,
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
    /// Memory that the workflow took, where the system tells it.
    pub peak_mb: Option<f64>,
    pub limits: Limits,
}

/// World of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct World {
    pub lens: String,
    pub across_deg: f64,
    pub height_m: f64,
    pub rate_hz: f64,
    pub field_m: [f64; 2],
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
    /// Returns what tells this run from others.
    pub fn key(&self) -> (String, Workflow) {
        (self.task.key(), self.workflow)
    }

    pub fn line(&self) -> String {
        let hidden: Vec<String> = self
            .hidden
            .iter()
            .zip(&self.hidden_sizes)
            .map(|(Chosen { id, in_limits, .. }, size)| format!("{id} {size:.3e} = {in_limits:.1} limits"))
            .collect();
        let named: Vec<&str> = self.named.iter().map(|(id, _)| id.as_str()).collect();
        format!(
            "{:?} {} {:?} {hidden:?} -> {:?} {named:?} {:.1} s",
            self.workflow, self.task.seed, self.task.part, self.verdict, self.seconds
        )
    }

    /// Whether the gap on frames that no fit has seen grew by what was named.
    pub fn grew(&self) -> bool {
        !self.named.is_empty() && self.gap[1] > self.gap[0]
    }
}

/// Runs these workflows on a task's recording with these effects hidden.
pub fn run(
    studio: &mut Studio,
    task: &Task,
    hidden: &[Chosen],
    workflows: &[Workflow],
    code: &str,
) -> Result<Vec<Outcome>, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let effects = effects(task, hidden)?;
    let sequence = studio.record(task, &effects, folder.path())?;
    workflows.iter().map(|&workflow| run_one(task, hidden, &effects, &sequence, workflow, code)).collect()
}

fn run_one(
    task: &Task,
    hidden: &[Chosen],
    effects: &[Hidden],
    sequence: &Sequence,
    workflow: Workflow,
    code: &str,
) -> Result<Outcome, Box<dyn Error>> {
    let options = Options { seed: task.seed, without: task.without.iter().cloned().collect() };
    memory::reset();
    let before_mb = memory::now_and_peak_mb();
    let start = Instant::now();
    let report = workflow.examine(sequence, &options);
    let seconds = start.elapsed().as_secs_f64();
    let peak_mb = before_mb.zip(memory::now_and_peak_mb()).map(|([now, _], [_, peak])| peak - now);
    let facts = task.recipe().facts();
    let mut outcome = Outcome {
        code: code.to_owned(),
        workflow,
        task: task.clone(),
        world: World {
            lens: facts.lens.to_owned(),
            across_deg: facts.across_rad.to_degrees(),
            height_m: facts.height_m,
            rate_hz: facts.rate_hz,
            field_m: facts.field_m,
        },
        hidden: hidden.to_vec(),
        hidden_sizes: effects.iter().map(main_size).collect(),
        verdict: None,
        refused: None,
        named: Vec::new(),
        unexplained: Vec::new(),
        estimates: Vec::new(),
        gap: [0.0; 2],
        oracle: None,
        seconds,
        peak_mb,
        limits: Limits::new(),
    };
    match report {
        Ok(report) => {
            outcome.take(&report, effects);
            if workflow == Workflow::Gap {
                outcome.oracle = oracle(sequence, effects, &options)?;
            }
        }
        Err(error) => outcome.refused = Some(error.to_string()),
    }
    Ok(outcome)
}

impl Outcome {
    fn take(&mut self, report: &Report, effects: &[Hidden]) {
        self.verdict = Some(report.verdict);
        let named = report.effects.iter().map(|effect| (effect.id.clone(), effect.confusable_with.clone()));
        self.named = named.collect();
        self.unexplained.clone_from(&report.unexplained);
        self.estimates = effects.iter().flat_map(|hidden| compared(hidden, report)).collect();
        self.gap = [report.gap.before, report.gap.after];
        let limits = report
            .not_found
            .iter()
            .map(|effect| (effect.id.clone(), (effect.parameter.clone(), effect.detection_limit.value)));
        self.limits = limits.collect();
    }
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
    workflow::gap_left(sequence, &model, options).map(Some)
}
