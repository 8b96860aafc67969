//! Tables of single effects.

use std::collections::BTreeMap;

use reality_sim::gap::report::Verdict;

use super::{
    answer, comparisons, counts, has_all, is_exact, is_inside, line,
    rates::{of_walks, quantile, rate},
};
use crate::{
    plan::{CLEAR, SIZES},
    run::Outcome,
    truth::unit,
};

/// Least part of the gap that the true effects can close, relative to the gap that they leave. Below it, a run does not
/// count.
const LEAST_GAP: f64 = 0.02;

/// Returns the runs by what is hidden.
fn by_effect<'a>(runs: &[&'a Outcome]) -> BTreeMap<&'a str, Vec<&'a Outcome>> {
    let mut groups: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for run in runs {
        for id in &run.task.effects {
            groups.entry(id).or_default().push(run);
        }
    }
    groups
}

pub fn singles(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n### One effect\n\n| size, detection limits | named exactly | in the reported set | verdict unknown |\n|---|---|---|---|",
    );
    let mut sizes = SIZES;
    sizes.sort_by(f64::total_cmp);
    for size in sizes {
        let runs: Vec<&Outcome> = runs.iter().copied().filter(|run| run.task.size == size).collect();
        let unknown = rate(&runs, &|run| run.verdict == Some(Verdict::Unknown));
        line(
            text,
            &format!("| {size} | {} | {} | {unknown} |", rate(&runs, &is_exact), rate(&runs, &has_all)),
        );
    }
    physical_sizes(text, runs);
    confusion(text, runs);
    closing(text, runs);
}

/// Writes what a detection limit is in physical units.
fn physical_sizes(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n#### Detection limits\n\nThe size at one limit of the recording: a tenth of the recordings below, median, a tenth above.\n\n| effect | below | median | above | unit | exact at 1 | at 3 | at 6 |\n|---|---|---|---|---|---|---|---|",
    );
    for (id, runs) in by_effect(runs) {
        let limit = |run: &&Outcome| {
            let (size, chosen) = (run.hidden_sizes.first()?, run.hidden.first()?);
            (chosen.in_limits > 0.0).then(|| size.abs() / chosen.in_limits)
        };
        let mut limits: Vec<f64> = runs.iter().filter_map(limit).collect();
        let limits = [0.1, 0.5, 0.9]
            .map(|part| quantile(&mut limits, part).map_or("–".to_owned(), |value| format!("{value:.2e}")));
        let mut sizes = SIZES;
        sizes.sort_by(f64::total_cmp);
        let exact = sizes.map(|size| {
            let runs: Vec<&Outcome> = runs.iter().copied().filter(|run| run.task.size == size).collect();
            rate(&runs, &is_exact)
        });
        line(text, &format!("| {id} | {} | {} | {} |", limits.join(" | "), unit(id), exact.join(" | ")));
    }
}

fn confusion(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n#### What was named, by what was hidden, at three limits and more\n\nThe gap is the median on unseen frames, in noise floors: before, after, and with the true effect in the model where the library has its very form.\n\n| hidden | named | before | after | true |\n|---|---|---|---|---|",
    );
    let clear: Vec<&Outcome> = runs.iter().copied().filter(|run| run.task.size >= CLEAR).collect();
    for (id, runs) in by_effect(&clear) {
        let gap = |of: fn(&Outcome) -> Option<f64>| {
            let mut values: Vec<f64> = runs.iter().filter_map(|run| of(run)).collect();
            quantile(&mut values, 0.5).map_or("–".to_owned(), |value| format!("{value:.2}"))
        };
        let gaps = [gap(|run| Some(run.gap[0])), gap(|run| Some(run.gap[1])), gap(|run| run.oracle)];
        let answers = counts(runs.iter().map(|run| answer(run)));
        line(text, &format!("| {id} | {answers} | {} |", gaps.join(" | ")));
    }
}

/// Writes what is named without nominal values.
pub fn unmeasured(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n### Without nominal brightness, noise and sharpness\n\nAt two detection limits of the same recording with them.\n\n| hidden | in the reported set | answers |\n|---|---|---|",
    );
    for (id, runs) in by_effect(runs) {
        let answers = counts(runs.iter().map(|run| answer(run)));
        line(text, &format!("| {id} | {} | {answers} |", rate(&runs, &has_all)));
    }
}

pub fn sizes(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n### Sizes\n\nTrue values inside the 95 % interval, of effects that were named.\n\n| effect | inside |\n|---|---|",
    );
    let mut groups: BTreeMap<String, Vec<(u64, bool)>> = BTreeMap::new();
    for (seed, compared) in comparisons(runs) {
        let name = format!("{} {}", compared.effect, compared.parameter);
        groups.entry(name).or_default().push((seed, is_inside(compared)));
    }
    for (name, hits) in &groups {
        line(text, &format!("| {name} | {} |", of_walks(hits)));
    }
    let all: Vec<(u64, bool)> = groups.into_values().flatten().collect();
    line(text, &format!("| all | {} |", of_walks(&all)));
}

/// Writes how much of the gap was closed: of the distance from the gap before to the gap with the true effects in the model.
fn closing(text: &mut String, runs: &[&Outcome]) {
    let clear = runs.iter().filter(|run| run.task.size >= CLEAR);
    let closed: Vec<(u64, f64)> = clear
        .filter_map(|run| Some((run.task.seed, run.gap, run.oracle?)))
        .filter(|(_, [before, _], oracle)| before - oracle > LEAST_GAP * oracle)
        .map(|(seed, [before, after], oracle)| (seed, (before - after) / (before - oracle)))
        .collect();
    let mut parts: Vec<f64> = closed.iter().map(|(_, part)| *part).collect();
    let percent =
        |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{:.0} %", 100.0 * value));
    let [median, tenth] = [0.5, 0.1].map(|part| percent(quantile(&mut parts, part)));
    let enough: Vec<(u64, bool)> = closed.iter().map(|(seed, part)| (*seed, *part >= 0.85)).collect();
    line(
        text,
        &format!(
            "\nOf the distance from the gap before to that with the true effect in the model, on frames that no fit has seen, median {median} is closed, a tenth below {tenth}; at least 85 % in {}.",
            of_walks(&enough)
        ),
    );
}
