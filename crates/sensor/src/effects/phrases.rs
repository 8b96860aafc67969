//! Phrases that several effects use to state their sizes.

use crate::{
    effect::Estimates,
    text::{Uncertain, Unit},
};

/// Words a size without a direction: "edges are blurred with a standard deviation of 1.2 px (± 0.1 px)".
pub(super) fn plain(words: &str, size: Uncertain, unit: Unit) -> String {
    let amount = size.in_unit(unit);
    format!("{words} {}{}", amount.signed(), amount.interval())
}

/// Returns the significant values, or all where none is significant.
pub(super) fn outstanding<T: Copy>(all: &[(T, Uncertain)]) -> Vec<(T, Uncertain)> {
    let found: Vec<(T, Uncertain)> =
        all.iter().copied().filter(|(_, estimate)| estimate.stands_out()).collect();
    if found.is_empty() { all.to_vec() } else { found }
}

/// Compares red and blue with green: "red is 12 % brighter (± 1 %) and blue is 8 % darker (± 1 %) than green".
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
