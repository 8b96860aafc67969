//! Tables of the study.

mod effects;
mod rates;
mod simpler;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
};

use reality_sim::gap::report::{Finding, Verdict};

use self::rates::{of_walks, quantile, rate};
use crate::{
    plan::{CLEAR, Part},
    run::{Compared, Outcome},
    workflow::Workflow,
};

/// Returns the tables of `docs/gap.md`.
pub fn text(all: &[&Outcome]) -> String {
    let outcomes: Vec<&Outcome> =
        all.iter().copied().filter(|outcome| outcome.workflow == Workflow::Gap).collect();
    let outcomes = outcomes.as_slice();
    let of = |part: Part| -> Vec<&Outcome> {
        outcomes.iter().copied().filter(|outcome| outcome.task.part == part).collect()
    };
    let walks: BTreeSet<u64> = outcomes.iter().map(|outcome| outcome.task.seed).collect();
    let code = outcomes.first().map_or("", |outcome| outcome.code.as_str());
    let mut text = format!(
        "{} runs in {} worlds, of the code {code}; rates with Wilson's 95 % intervals, in which the runs of a world count as one.\n",
        outcomes.len(),
        walks.len()
    );
    targets(&mut text, outcomes);
    nulls(&mut text, &of(Part::Nulls));
    effects::singles(&mut text, &of(Part::Singles));
    effects::unmeasured(&mut text, &of(Part::Unmeasured));
    together(&mut text, "Two effects", &of(Part::Pairs));
    together(&mut text, "Three effects", &of(Part::Triples));
    unknowns(&mut text, "An effect taken out of the library", &of(Part::Removed));
    unknowns(&mut text, "Effects that no library has", &of(Part::Foreign));
    effects::sizes(&mut text, outcomes);
    simpler::workflows(&mut text, all);
    costs(&mut text, outcomes);
    worlds(&mut text, outcomes);
    text
}

// Writing into a string cannot fail.
fn line(text: &mut String, line: &str) {
    let _ = writeln!(text, "{line}");
}

fn hidden(outcome: &Outcome) -> BTreeSet<&str> {
    outcome.task.effects.iter().map(String::as_str).collect()
}

fn named(outcome: &Outcome) -> BTreeSet<&str> {
    outcome.named.iter().map(|(id, _)| id.as_str()).collect()
}

/// Whether exactly the hidden effects were named, none of them confusable.
fn is_exact(outcome: &Outcome) -> bool {
    named(outcome) == hidden(outcome) && outcome.named.iter().all(|(_, confusable)| confusable.is_empty())
}

/// Whether all hidden effects were named, or are confusable with named ones.
fn has_all(run: &Outcome) -> bool {
    let is_in_set = |id: &str| {
        run.named.iter().any(|(named, others)| named == id || others.iter().any(|other| other == id))
    };
    hidden(run).into_iter().all(is_in_set)
}

/// Returns the number of correctly named effects.
fn right(run: &Outcome) -> usize {
    hidden(run).intersection(&named(run)).count()
}

fn has_wrong(run: &Outcome) -> bool {
    named(run).difference(&hidden(run)).count() > 0
}

fn has_name(run: &Outcome) -> bool {
    !run.named.is_empty()
}

fn is_unknown(run: &Outcome) -> bool {
    matches!(run.verdict, Some(Verdict::Unknown | Verdict::Inconclusive))
}

fn is_plain_unknown(run: &Outcome) -> bool {
    is_unknown(run) && !has_name(run)
}

fn is_sure(run: &Outcome) -> bool {
    matches!(run.verdict, Some(Verdict::Named))
}

/// Returns the comparisons of sizes, each with its walk.
fn comparisons<'a>(runs: &[&'a Outcome]) -> Vec<(u64, &'a Compared)> {
    runs.iter().flat_map(|run| run.estimates.iter().map(|compared| (run.task.seed, compared))).collect()
}

fn is_inside(compared: &Compared) -> bool {
    (compared.value - compared.truth).abs() <= 1.96 * compared.sigma
}

/// Writes what was wanted and what was found.
fn targets(text: &mut String, outcomes: &[&Outcome]) {
    let of = |part: Part| -> Vec<&Outcome> {
        outcomes.iter().copied().filter(|outcome| outcome.task.part == part).collect()
    };
    let clear: Vec<&Outcome> =
        of(Part::Singles).into_iter().filter(|outcome| outcome.task.size >= CLEAR).collect();
    let (pairs, triples) = (of(Part::Pairs), of(Part::Triples));
    let (removed, foreign) = (of(Part::Removed), of(Part::Foreign));
    let nulls = of(Part::Nulls);
    let inside: Vec<(u64, bool)> =
        comparisons(outcomes).into_iter().map(|(seed, compared)| (seed, is_inside(compared))).collect();
    let grew = outcomes.iter().filter(|outcome| outcome.grew()).count();
    let rows = [
        ("one effect of three limits or more: named exactly", "≥ 95 %", rate(&clear, &is_exact)),
        ("the same: in the reported set", "≥ 99 %", rate(&clear, &has_all)),
        ("nothing hidden: a name", "≤ 1 %", rate(&nulls, &has_name)),
        ("two effects: both named", "≥ 85 %", rate(&pairs, &|run| right(run) == 2)),
        ("two effects: a wrong one", "≤ 3 %", rate(&pairs, &has_wrong)),
        ("three effects: two of them named", "≥ 85 %", rate(&triples, &|run| right(run) >= 2)),
        ("three effects: a wrong one", "≤ 3 %", rate(&triples, &has_wrong)),
        ("removed from the library: unknown or inconclusive", "≥ 90 %", rate(&removed, &is_unknown)),
        ("removed from the library: a wrong name for sure", "≤ 3 %", rate(&removed, &is_sure)),
        ("foreign: unknown or inconclusive", "≥ 90 %", rate(&foreign, &is_unknown)),
        ("foreign: a wrong name for sure", "≤ 3 %", rate(&foreign, &is_sure)),
        ("without nominal values, at two limits: named", "all", rate(&of(Part::Unmeasured), &has_all)),
        ("true sizes inside the 95 % interval", "90–98 % for every effect", of_walks(&inside)),
        ("verdicts whose gap on unseen frames grew", "0", format!("{grew} of {}", outcomes.len())),
    ];
    line(text, "\n### What was wanted\n\n| | wanted | found |\n|---|---|---|");
    for (what, wanted, found) in rows {
        line(text, &format!("| {what} | {wanted} | {found} |"));
    }
}

fn nulls(text: &mut String, runs: &[&Outcome]) {
    line(text, "\n### Nothing is hidden\n\n| | runs |\n|---|---|");
    line(text, &format!("| a name is given | {} |", rate(runs, &has_name)));
    for (what, said) in [
        ("unknown is said", Some(Verdict::Unknown)),
        ("of some effects nothing can be said (inconclusive)", Some(Verdict::Inconclusive)),
        ("nothing is missing", Some(Verdict::None)),
        ("the recording is refused", None),
    ] {
        line(text, &format!("| {what} | {} |", rate(runs, &|run| run.verdict == said)));
    }
    let wrong = counts(runs.iter().flat_map(|run| named(run)).map(ToOwned::to_owned));
    line(text, &format!("\nNames given: {}.", if wrong.is_empty() { "none".to_owned() } else { wrong }));
    let kinds = counts(runs.iter().flat_map(|run| &run.unexplained).map(kind));
    line(text, &format!("\nUnexplained: {}.", if kinds.is_empty() { "nothing".to_owned() } else { kinds }));
}

/// Returns the kind of a finding, as reports have it.
fn kind(finding: &Finding) -> String {
    let finding = serde_json::to_value(finding).unwrap_or_default();
    finding["kind"].as_str().unwrap_or("other").to_owned()
}

/// Returns how often each text comes, joined.
fn counts(texts: impl Iterator<Item = String>) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    texts.for_each(|text| *counts.entry(text).or_default() += 1);
    let counts: Vec<String> = counts.into_iter().map(|(text, count)| format!("{text} {count}")).collect();
    counts.join(", ")
}

/// Returns the named effects; confusable ones are joined by "or".
fn answer(run: &Outcome) -> String {
    let name = |(id, confusable): &(String, Vec<String>)| {
        std::iter::once(id).chain(confusable).cloned().collect::<Vec<String>>().join(" or ")
    };
    let mut names: Vec<String> = run.named.iter().map(name).collect();
    names.sort();
    let verdict = run.verdict.map_or("refused".to_owned(), |verdict| format!("{verdict:?}").to_lowercase());
    match (names.is_empty(), run.verdict) {
        (true, _) => verdict,
        (false, Some(Verdict::Unknown)) => format!("{} and unknown", names.join(" + ")),
        (false, _) => names.join(" + "),
    }
}

fn together(text: &mut String, title: &str, runs: &[&Outcome]) {
    line(text, &format!("\n### {title}\n\n| | runs |\n|---|---|"));
    line(text, &format!("| all named | {} |", rate(runs, &|run| right(run) == run.task.effects.len())));
    line(
        text,
        &format!(
            "| all but one at least | {} |",
            rate(runs, &|run| right(run) + 1 >= run.task.effects.len())
        ),
    );
    line(text, &format!("| a wrong one | {} |", rate(runs, &has_wrong)));
    let missed: Vec<String> = runs
        .iter()
        .filter(|run| named(run) != hidden(run))
        .map(|run| format!("{}: {}", run.task.effects.join(" + "), answer(run)))
        .collect();
    if !missed.is_empty() {
        line(text, &format!("\nNot all and no more: {}.", missed.join("; ")));
    }
}

fn unknowns(text: &mut String, title: &str, runs: &[&Outcome]) {
    line(
        text,
        &format!(
            "\n### {title}\n\n| hidden | unknown or inconclusive, no name | a name beside unknown | a wrong name for sure | either … or … | nothing said |\n|---|---|---|---|---|---|"
        ),
    );
    let mut groups: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for run in runs {
        for id in &run.task.effects {
            groups.entry(id).or_default().push(run);
        }
    }
    let row = |name: &str, runs: &[&Outcome]| {
        let cells = [
            rate(runs, &is_plain_unknown),
            rate(runs, &|run| is_unknown(run) && has_name(run)),
            rate(runs, &is_sure),
            rate(runs, &|run| run.verdict == Some(Verdict::Confusable)),
            rate(runs, &|run| run.verdict == Some(Verdict::None)),
        ];
        format!("| {name} | {} |", cells.join(" | "))
    };
    for (id, runs) in &groups {
        line(text, &row(id, runs));
    }
    line(text, &row("all", runs));
}

/// Writes time and memory.
fn costs(text: &mut String, runs: &[&Outcome]) {
    line(text, "\n### Time and memory\n\n| | median | nine of ten below | largest |\n|---|---|---|---|");
    let mut row = |name: &str, mut values: Vec<f64>| {
        let cells = [0.5, 0.9, 1.0]
            .map(|part| quantile(&mut values, part).map_or("–".to_owned(), |value| format!("{value:.1}")));
        line(text, &format!("| {name} | {} |", cells.join(" | ")));
    };
    row("time, s", runs.iter().map(|run| run.seconds).collect());
    row("memory of a run, MB", runs.iter().filter_map(|run| run.peak_mb).collect());
}

/// Writes which worlds were drawn.
fn worlds(text: &mut String, runs: &[&Outcome]) {
    let worlds: BTreeMap<u64, &Outcome> = runs.iter().map(|run| (run.task.seed, *run)).collect();
    let lenses = counts(worlds.values().map(|run| run.world.lens.clone()));
    line(
        text,
        &format!("\n### Worlds\n\nLenses: {lenses}.\n\n| | least | median | largest |\n|---|---|---|---|"),
    );
    let mut row = |name: &str, of: &dyn Fn(&Outcome) -> f64| {
        let mut values: Vec<f64> =
            worlds.values().map(|run| of(run)).filter(|value| value.is_finite()).collect();
        let cells = [0.0, 0.5, 1.0]
            .map(|part| quantile(&mut values, part).map_or("–".to_owned(), |value| format!("{value:.2}")));
        line(text, &format!("| {name} | {} |", cells.join(" | ")));
    };
    row("seen across the picture, degrees", &|run| run.world.across_deg);
    row("height of the camera, m", &|run| run.world.height_m);
    row("pictures per second", &|run| run.world.rate_hz);
    row("length of the field, m", &|run| run.world.field_m[0]);
}
