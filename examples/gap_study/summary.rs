//! Tables of the study.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write,
};

use reality_sim::gap::report::Verdict;

use crate::{
    plan::{CLEAR, Part, SIZES},
    run::{Compared, Outcome},
};

/// Least part of the gap that the true effects can close, relative to the gap that they leave. Below it, a run does not
/// count.
const LEAST_GAP: f64 = 0.02;

/// Returns the tables of `docs/gap.md`.
pub fn text(outcomes: &[Outcome]) -> String {
    let of = |part: Part| -> Vec<&Outcome> {
        outcomes.iter().filter(|outcome| outcome.task.part == part).collect()
    };
    let mut text = format!("{} runs; rates with Wilson's 95 % intervals.\n", outcomes.len());
    targets(&mut text, outcomes);
    nulls(&mut text, &of(Part::Nulls));
    singles(&mut text, &of(Part::Singles));
    confusion(&mut text, &of(Part::Singles));
    pairs(&mut text, &of(Part::Pairs));
    unknowns(&mut text, "An effect taken out of the library", &of(Part::Removed));
    unknowns(&mut text, "Effects that no library has", &of(Part::Foreign));
    full(&mut text, &of(Part::Full));
    let all: Vec<&Outcome> = outcomes.iter().collect();
    sizes(&mut text, &all);
    closing(&mut text, &whole(&all));
    text
}

/// Returns a rate with Wilson's 95 % interval.
fn rate(hits: usize, runs: usize) -> String {
    if runs == 0 {
        return "–".to_owned();
    }
    let (n, p, z) = (runs as f64, hits as f64 / runs as f64, 1.96_f64);
    let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let reach = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let percent = |value: f64| (100.0 * value).clamp(0.0, 100.0);
    format!(
        "{:.0} % ({hits} of {runs}; {:.0}–{:.0} %)",
        percent(p),
        percent(middle - reach),
        percent(middle + reach)
    )
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

/// Whether an effect was named, or is confusable with a named one.
fn in_set(outcome: &Outcome, id: &str) -> bool {
    outcome.named.iter().any(|(named, confusable)| named == id || confusable.iter().any(|other| other == id))
}

/// Writes the targets of the study and the results.
fn targets(text: &mut String, outcomes: &[Outcome]) {
    let of = |parts: &[Part]| -> Vec<&Outcome> {
        outcomes.iter().filter(|run| parts.contains(&run.task.part)).collect()
    };
    let clear: Vec<&Outcome> =
        of(&[Part::Singles]).into_iter().filter(|run| run.task.size >= CLEAR).collect();
    let (nulls, pairs) = (of(&[Part::Nulls]), of(&[Part::Pairs]));
    let outside = of(&[Part::Removed, Part::Foreign]);
    let every: Vec<&Outcome> = outcomes.iter().collect();
    let sizes: Vec<&Compared> = every.iter().flat_map(|run| &run.estimates).collect();
    let closed = closed(&whole(&every));
    let count = |runs: &[&Outcome], is: &dyn Fn(&Outcome) -> bool| {
        (runs.iter().filter(|run| is(run)).count(), runs.len())
    };
    let rows = [
        ("one effect of three limits or more: named exactly", "≥ 90 %", count(&clear, &is_exact)),
        ("the same: in the reported set", "≥ 97 %", count(&clear, &has_all)),
        ("nothing hidden: a name", "≤ 2 %", count(&nulls, &|run| !run.named.is_empty())),
        ("two effects: both named", "≥ 70 %", count(&pairs, &|run| right(run) == 2)),
        ("two effects: at least one", "≥ 95 %", count(&pairs, &|run| right(run) >= 1)),
        ("two effects: a third, wrong one", "≤ 5 %", count(&pairs, &has_wrong)),
        ("outside the library: unknown or inconclusive", "≥ 90 %", count(&outside, &is_unknown)),
        ("outside the library: a wrong name for sure", "≤ 5 %", count(&outside, &is_sure)),
        ("true sizes inside the 95 % interval", "88–99 %", (inside(&sizes), sizes.len())),
        (
            "85 % of the gap closed",
            "all",
            (closed.iter().filter(|part| **part >= 0.85).count(), closed.len()),
        ),
    ];
    line(text, "\n### What was wanted\n\n| | wanted | found |\n|---|---|---|");
    for (what, wanted, (hits, runs)) in rows {
        line(text, &format!("| {what} | {wanted} | {} |", rate(hits, runs)));
    }
}

/// Returns the runs in which the library has all of its effects.
fn whole<'a>(runs: &[&'a Outcome]) -> Vec<&'a Outcome> {
    runs.iter().copied().filter(|run| run.task.without.is_none()).collect()
}

fn has_all(run: &Outcome) -> bool {
    hidden(run).iter().all(|id| in_set(run, id))
}

/// Returns the number of correctly named effects.
fn right(run: &Outcome) -> usize {
    hidden(run).intersection(&named(run)).count()
}

fn has_wrong(run: &Outcome) -> bool {
    named(run).difference(&hidden(run)).count() > 0
}

fn is_unknown(run: &Outcome) -> bool {
    matches!(run.verdict, Verdict::Unknown | Verdict::Inconclusive)
}

fn is_sure(run: &Outcome) -> bool {
    matches!(run.verdict, Verdict::Named)
}

fn nulls(text: &mut String, runs: &[&Outcome]) {
    line(text, "\n### Nothing is hidden\n");
    let false_names = runs.iter().filter(|run| !run.named.is_empty()).count();
    let unknown = runs.iter().filter(|run| run.verdict == Verdict::Unknown).count();
    line(text, "| | runs |\n|---|---|");
    line(text, &format!("| a name is given | {} |", rate(false_names, runs.len())));
    line(text, &format!("| unknown is said | {} |", rate(unknown, runs.len())));
    let inconclusive = runs.iter().filter(|run| run.verdict == Verdict::Inconclusive).count();
    line(
        text,
        &format!(
            "| nothing is found, and of some effects nothing can be said (inconclusive) | {} |",
            rate(inconclusive, runs.len())
        ),
    );
    let none = runs.iter().filter(|run| run.verdict == Verdict::None).count();
    line(text, &format!("| nothing is missing | {} |", rate(none, runs.len())));
    let mut wrong: BTreeMap<&str, usize> = BTreeMap::new();
    for id in runs.iter().flat_map(|run| named(run)) {
        *wrong.entry(id).or_default() += 1;
    }
    let wrong: Vec<String> = wrong.into_iter().map(|(id, times)| format!("{id} {times}")).collect();
    line(
        text,
        &format!("\nNames given: {}.", if wrong.is_empty() { "none".to_owned() } else { wrong.join(", ") }),
    );
}

fn singles(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n### One effect\n\n| size, detection limits | named exactly | in the reported set | verdict unknown |\n|---|---|---|---|",
    );
    let mut sizes = SIZES;
    sizes.sort_by(f64::total_cmp);
    for size in sizes {
        let runs: Vec<_> = runs.iter().filter(|run| run.task.size == size).collect();
        let exactly = runs.iter().filter(|run| is_exact(run)).count();
        let in_set = runs.iter().filter(|run| has_all(run)).count();
        let unknown = runs.iter().filter(|run| run.verdict == Verdict::Unknown).count();
        let count = runs.len();
        line(
            text,
            &format!(
                "| {size} | {} | {} | {} |",
                rate(exactly, count),
                rate(in_set, count),
                rate(unknown, count)
            ),
        );
    }
}

fn confusion(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n#### What was named, by what was hidden, at three limits and more\n\nThe gap is the median on unseen frames, in noise floors: before, after, and with the true effect in the model where the library has its very form.\n\n| hidden | named | before | after | true |\n|---|---|---|---|---|",
    );
    let mut rows: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for run in runs.iter().filter(|run| run.task.size >= CLEAR) {
        for id in &run.task.effects {
            rows.entry(id).or_default().push(run);
        }
    }
    for (id, runs) in rows {
        let mut answers: BTreeMap<String, usize> = BTreeMap::new();
        runs.iter().for_each(|run| *answers.entry(answer(run)).or_default() += 1);
        let answers: Vec<String> =
            answers.into_iter().map(|(answer, count)| format!("{answer} {count}")).collect();
        let gap = |of: fn(&Outcome) -> Option<f64>| {
            let mut values: Vec<f64> = runs.iter().filter_map(|run| of(run)).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).map_or("–".to_owned(), |value| format!("{value:.2}"))
        };
        let [before, after, truth] =
            [gap(|run| Some(run.gap[0])), gap(|run| Some(run.gap[1])), gap(|run| run.oracle)];
        line(text, &format!("| {id} | {} | {before} | {after} | {truth} |", answers.join(", ")));
    }
}

/// Returns the named effects; confusable ones are joined by "or".
fn answer(run: &Outcome) -> String {
    let name = |(id, confusable): &(String, Vec<String>)| {
        std::iter::once(id).chain(confusable).cloned().collect::<Vec<String>>().join(" or ")
    };
    let mut names: Vec<String> = run.named.iter().map(name).collect();
    names.sort();
    match (names.is_empty(), run.verdict) {
        (true, verdict) => format!("{verdict:?}").to_lowercase(),
        (false, Verdict::Unknown) => format!("{} and unknown", names.join(" + ")),
        (false, _) => names.join(" + "),
    }
}

fn pairs(text: &mut String, runs: &[&Outcome]) {
    line(text, "\n### Two effects\n\n| | runs |\n|---|---|");
    let part = |is: &dyn Fn(&Outcome) -> bool| rate(runs.iter().filter(|run| is(run)).count(), runs.len());
    line(text, &format!("| both named | {} |", part(&|run| right(run) == 2)));
    line(text, &format!("| at least one | {} |", part(&|run| right(run) >= 1)));
    line(text, &format!("| a third, wrong one | {} |", part(&has_wrong)));
    let missed: Vec<String> = runs
        .iter()
        .filter(|run| named(run) != hidden(run))
        .map(|run| format!("{}: {}", run.task.effects.join(" + "), answer(run)))
        .collect();
    if !missed.is_empty() {
        line(text, &format!("\nNot both and no more: {}.", missed.join("; ")));
    }
}

fn unknowns(text: &mut String, title: &str, runs: &[&Outcome]) {
    line(
        text,
        &format!(
            "\n### {title}\n\n| hidden | unknown or inconclusive | a wrong name for sure | either … or … | nothing said | a name beside unknown |\n|---|---|---|---|---|---|"
        ),
    );
    let mut groups: BTreeMap<&str, Vec<&Outcome>> = BTreeMap::new();
    for run in runs {
        for id in &run.task.effects {
            groups.entry(id).or_default().push(run);
        }
    }
    let row = |name: &str, runs: &[&Outcome]| {
        let silent = |run: &Outcome| matches!(run.verdict, Verdict::None);
        let count =
            |kind: &dyn Fn(&Outcome) -> bool| rate(runs.iter().filter(|run| kind(run)).count(), runs.len());
        let either = |run: &Outcome| matches!(run.verdict, Verdict::Confusable);
        let beside = |run: &Outcome| is_unknown(run) && !run.named.is_empty();
        let cells = [count(&is_unknown), count(&is_sure), count(&either), count(&silent), count(&beside)];
        format!("| {name} | {} |", cells.join(" | "))
    };
    for (id, runs) in &groups {
        line(text, &row(id, runs));
    }
    line(text, &row("all", runs));
}

fn full(text: &mut String, runs: &[&Outcome]) {
    line(text, "\n### At 640×480, 60 frames\n\n| hidden | verdict | named | s |\n|---|---|---|---|");
    for run in runs {
        let hidden: Vec<&str> = hidden(run).into_iter().collect();
        let hidden = if hidden.is_empty() { "nothing".to_owned() } else { hidden.join(", ") };
        let verdict = format!("{:?}", run.verdict).to_lowercase();
        line(text, &format!("| {hidden} | {verdict} | {} | {:.1} |", answer(run), run.seconds));
    }
}

fn sizes(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n### Sizes\n\nTrue values inside the 95 % interval, of effects that were named.\n\n| effect | inside |\n|---|---|",
    );
    let mut groups: BTreeMap<String, Vec<&Compared>> = BTreeMap::new();
    for compared in runs.iter().flat_map(|run| &run.estimates) {
        groups.entry(format!("{} {}", compared.effect, compared.parameter)).or_default().push(compared);
    }
    for (name, all) in &groups {
        line(text, &format!("| {name} | {} |", rate(inside(all), all.len())));
    }
    let all: Vec<&Compared> = groups.into_values().flatten().collect();
    line(text, &format!("| all | {} |", rate(inside(&all), all.len())));
}

fn inside(all: &[&Compared]) -> usize {
    all.iter().filter(|c| (c.value - c.truth).abs() <= 1.96 * c.sigma).count()
}

/// Returns the fractions of the gap closed, sorted: of the distance from the gap before to the gap with the true effects in
/// the model. Runs without the latter are left out.
fn closed(runs: &[&Outcome]) -> Vec<f64> {
    let mut closed: Vec<f64> = runs
        .iter()
        .filter_map(|run| Some((run.gap, run.oracle?)))
        .filter(|([before, _], oracle)| before - oracle > LEAST_GAP * oracle)
        .map(|([before, after], oracle)| (before - after) / (before - oracle))
        .collect();
    closed.sort_by(f64::total_cmp);
    closed
}

fn closing(text: &mut String, runs: &[&Outcome]) {
    line(
        text,
        "\n### The gap\n\nPart of the distance from the gap before to that with the true effects in the model that is closed, on frames that no fit has seen; where the library has the true effects' very form, and their gap is more than 2 %.\n",
    );
    let closed = closed(runs);
    if closed.is_empty() {
        return;
    }
    let at = |part: f64| 100.0 * closed[((closed.len() - 1) as f64 * part) as usize];
    let enough = closed.iter().filter(|part| **part >= 0.85).count();
    line(
        text,
        &format!(
            "median {:.0} %, a tenth below {:.0} %; at least 85 % in {}",
            at(0.5),
            at(0.1),
            rate(enough, closed.len())
        ),
    );
}
