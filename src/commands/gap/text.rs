//! The report in a terminal.

use std::path::Path;

use reality_sim::gap::report::Report;

use crate::commands::output::aligned;

/// The verdict, the gap, and where the rest is to be read.
pub fn text(report: &Report, folder: &Path) -> String {
    let mut lines = Vec::new();
    for effect in &report.effects {
        let rivals = if effect.confusable_with.is_empty() {
            String::new()
        } else {
            format!(", or {}", effect.confusable_with.join(" or "))
        };
        lines.push(("found", format!("{}{rivals}: {}", effect.id, effect.size)));
    }
    for unexplained in &report.unexplained {
        lines.push(("unknown", format!("{}: {}", unexplained.channel, unexplained.r#where)));
    }
    for (channel, gap) in &report.gap.channels {
        let moved =
            if gap.after < 0.98 * gap.before { format!(" → {:.3}", gap.after) } else { String::new() };
        lines.push((
            channel.as_str(),
            format!("{:.3}{moved} {} (noise {:.3})", gap.before, gap.unit, gap.floor),
        ));
    }
    let limits: Vec<String> = report
        .not_found
        .iter()
        .map(|effect| {
            format!("{} {:.2e} {}", effect.id, effect.detection_limit.value, effect.detection_limit.unit)
        })
        .collect();
    if !limits.is_empty() {
        lines.push(("not found", format!("would be from: {}", limits.join(", "))));
    }
    for effect in &report.unobservable {
        lines.push(("not seen", format!("{}: {}", effect.id, effect.reason)));
    }
    for file in &report.left_out {
        lines.push(("left out", format!("{file}: the picture is missing or broken")));
    }
    lines.push(("report", folder.join("report.html").display().to_string()));
    let wide: Vec<(&str, String)> = lines;
    format!("{}\n{}", report.summary, aligned(&wide))
}
