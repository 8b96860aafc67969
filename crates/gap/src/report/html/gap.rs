//! Table of the gap before and after, beside the noise floor.

use super::text::{cell, escape, number, table};
use crate::{
    inference::held_out::has_moved,
    report::data::Gap,
    report::text::{GAP_UNIT, channel_scale, channel_title, closed, digits, percent},
};

/// Width and height of a bar.
const BAR: [f64; 2] = [160.0, 12.0];

pub(super) fn section(gap: &Gap) -> String {
    let rows = gap.channels.iter().map(|(channel, part)| {
        let sizes = [part.before, part.after, part.floor];
        row("", channel_title(*channel), sizes, channel_scale(*channel), &percent(part.left_out))
    });
    let total = row("total", "All channels", [gap.before, gap.after, gap.floor], (1.0, GAP_UNIT), "");
    let rows: Vec<String> = rows.chain([total]).collect();
    format!(
        "<h2>The gap</h2>\n{}<p class=\"quiet\">Root mean squares on frames that no fit has seen. In the bars, grey is \
         the noise floor, orange what is left of the gap, green what was closed. Nominal values within their tolerance, patches of carpet and worn lines lie above \
         the floor as well: only what is listed under Unexplained is more than that.</p>\n",
        table(&["Channel", ">Before", ">After", ">Noise floor", "Unit", ">Closed", ">Left out", ""], &rows)
    )
}

/// Returns a row of the table: sizes before and after and the noise floor, multiplied by a factor and in a unit, and the share
/// of the measurements that is left out.
fn row(class: &str, title: &str, sizes: [f64; 3], (factor, unit): (f64, &str), left_out: &str) -> String {
    let [before, after, floor] = sizes;
    let part = closed(before, after, floor)
        .filter(|_| has_moved(before, after))
        .map_or_else(|| "–".to_owned(), |part| percent(part).replace("−0", "0"));
    let numbers: String = sizes.iter().map(|size| number(&digits(factor * size, 3))).collect();
    format!(
        "<tr class=\"{class}\">{}{numbers}{}{}{}<td>{}</td></tr>",
        cell(title),
        cell(unit),
        number(&part),
        number(left_out),
        bar(before, after, floor)
    )
}

/// Draws a bar of three parts: noise floor, remaining gap, closed gap.
fn bar(before: f64, after: f64, floor: f64) -> String {
    let largest = before.max(after).max(floor);
    if !(before.is_finite() && after.is_finite() && floor.is_finite() && largest > 0.0) {
        return String::new();
    }
    let x = |size: f64| BAR[0] * size.max(0.0) / largest;
    let part = |class: &str, from: f64, to: f64| {
        let (from, width) = (x(from), (x(to) - x(from)).max(0.0));
        format!(
            "<rect class=\"{class}\" x=\"{from:.1}\" y=\"0\" width=\"{width:.1}\" height=\"{}\"/>",
            BAR[1]
        )
    };
    let label = escape("noise floor, what is left of the gap, what was closed");
    format!(
        "<svg width=\"{}\" height=\"{}\" role=\"img\" aria-label=\"{label}\">{}{}{}</svg>",
        BAR[0],
        BAR[1],
        part("bar-floor", 0.0, floor),
        part("bar-left", floor, after),
        part("bar-closed", after, before)
    )
}
