//! The workflow beside simpler ones, on the same recordings.

use std::collections::{BTreeMap, BTreeSet};

use super::{has_name, is_exact, line, rates::rate};
use crate::{
    plan::{CLEAR, Part},
    run::Outcome,
    workflow::Workflow,
};

/// Writes what each workflow makes of the recordings that all of them were run on. Nothing where there is only one.
pub fn workflows(text: &mut String, outcomes: &[&Outcome]) {
    let mut by_task: BTreeMap<String, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        by_task.entry(outcome.task.key()).or_default().push(outcome);
    }
    let workflows: BTreeSet<Workflow> = outcomes.iter().map(|outcome| outcome.workflow).collect();
    if workflows.len() < 2 {
        return;
    }
    by_task.retain(|_, runs| runs.len() == workflows.len());
    let of = |workflow: Workflow, part: Part, least: f64| -> Vec<&Outcome> {
        let runs = by_task.values().flatten().copied();
        runs.filter(|run| run.workflow == workflow && run.task.part == part && run.task.size >= least)
            .collect()
    };
    line(text, "\n### Simpler workflows on the same recordings\n");
    line(
        text,
        "| | one effect of three limits or more: named exactly | nothing hidden: a name | a wrong name in either |",
    );
    line(text, "|---|---|---|---|");
    for workflow in workflows {
        let (clear, nulls) = (of(workflow, Part::Singles, CLEAR), of(workflow, Part::Nulls, 0.0));
        let both: Vec<&Outcome> = clear.iter().chain(&nulls).copied().collect();
        let row = [rate(&clear, &is_exact), rate(&nulls, &has_name), rate(&both, &super::has_wrong)];
        line(text, &format!("| {} | {} |", workflow.name(), row.join(" | ")));
    }
}
