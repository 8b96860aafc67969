//! Phrases that several effects say their sizes with.

use crate::{
    effect::Estimates,
    text::{Uncertain, Unit},
};

/// "edges are blurred with a standard deviation of 1.2 px (± 0.1 px)": for sizes without a direction.
pub(super) fn plain(words: &str, size: Uncertain, unit: Unit) -> String {
    let amount = size.in_unit(unit);
    format!("{words} {}{}", amount.signed(), amount.interval())
}

/// Those that stand out, or all where none does.
pub(super) fn outstanding<T: Copy>(all: &[(T, Uncertain)]) -> Vec<(T, Uncertain)> {
    let found: Vec<(T, Uncertain)> =
        all.iter().copied().filter(|(_, estimate)| estimate.stands_out()).collect();
    if found.is_empty() { all.to_vec() } else { found }
}

/// "red is 12 % brighter (± 1 %) and blue is 8 % darker (± 1 %) than green".
pub(super) fn against_green(
    estimates: &Estimates<'_>,
    [red, blue]: [&str; 2],
    words: [&str; 2],
) -> Option<String> {
    let colors = [("red", estimates.get(red)?), ("blue", estimates.get(blue)?)];
    let text = |(color, change): (&str, Uncertain)| {
        format!("{color} is {}", change.in_unit(Unit::Percent).with_direction(words))
    };
    let texts: Vec<String> = outstanding(&colors).into_iter().map(text).collect();
    Some(format!("{} than green", texts.join(" and ")))
}
