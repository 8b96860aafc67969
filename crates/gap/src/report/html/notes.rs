//! Notes on what was compared and how to read the page.

use super::text::{cell, table};
use crate::{
    report::data::Report,
    report::text::{absorbed, digits, reference_source},
};

const READING: &str = "<h2>How to read this page</h2>\n<ul>\
<li><b>p</b>: how likely chance alone would show as much of an effect. It is corrected for the number of effects that were \
tested, and its scatter is that from view to view: samples of one frame are not independent.</li>\
<li><b>Held-out gain</b>: by how much the logarithm of the likelihood grows on frames that the fit has not seen; ± is one \
standard deviation. Below 0, what some frames suggest fails on others.</li>\
<li><b>Named</b> is an effect where p is below 0.005, the gain is above 4 and more than 2.5 standard deviations above 0, and \
its size is sure to be one that matters.</li>\
<li><b>Would have been found from</b>: the size at which an effect that is there is found in nine recordings of ten like \
this one.</li>\
<li><b>Gap</b>: measured minus simulated, on held-out frames, which no fit has seen; they only confirm that it does not grow \
by what is named. The noise floor is what neighbouring measurements in one picture scatter by, with what errors of the reference \
poses make; less than that may be left by chance. That of the odometry is what neighbouring steps scatter by; metres and radians \
are taken together.</li>\
<li><b>Left out</b>: measurements that neither the model before nor the one after explains, as of other things, and lines that \
neither finds. All others count before and after alike, also those that only one of the two finds.</li>\
<li>Photometry and noise are in percent: 100 times a difference of natural logarithms.</li></ul>\n";

pub(super) fn section(report: &Report) -> String {
    let rows = [
        ("Frames compared", report.frames.to_string()),
        ("Frames held out", format!("{}, chosen with seed {}", report.held_out_frames, report.seed)),
        ("Frames left out", left_out(&report.left_out)),
        ("Reference poses", reference_source(report.poses.source).to_owned()),
        (
            "Scatter of rotations",
            triple(report.poses.rotation_sigma_rad.map(f64::to_degrees), "°", ROTATIONS),
        ),
        (
            "Scatter of positions",
            triple(report.poses.position_sigma_m.map(|sigma| 1e3 * sigma), " mm", POSITIONS),
        ),
        ("What these poses cannot show", absorbed(report.poses.source).to_owned()),
    ];
    let rows: Vec<String> = rows
        .iter()
        .filter(|(_, text)| !text.is_empty())
        .map(|(what, text)| format!("<tr>{}{}</tr>", cell(what), cell(text)))
        .collect();
    format!("<h2>What was compared</h2>\n{}{READING}", table(&["", report.recording.as_str()], &rows))
}

const ROTATIONS: &str = "about the camera's right, down and forward axes";
const POSITIONS: &str = "along the world's x, y and z";

fn left_out(files: &[String]) -> String {
    if files.is_empty() { String::new() } else { format!("{}: {}", files.len(), files.join(", ")) }
}

fn triple(values: [f64; 3], unit: &str, axes: &str) -> String {
    format!("{} {axes}", values.map(|value| format!("{}{unit}", digits(value, 2))).join(", "))
}
