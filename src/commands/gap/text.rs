//! Report for a terminal.

use std::{collections::BTreeMap, path::Path};

use reality_sim::gap::report::{
    Report, Unobservable,
    text::{
        absorbed, amount, effect_size, finding_place, limit, object_place, object_share, summary,
        unobservable_reason,
    },
};

use crate::commands::output::aligned;

/// Groups effects that cannot be seen by their reason.
fn by_reason(unobservable: &[Unobservable]) -> BTreeMap<&str, Vec<&str>> {
    let mut reasons: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for effect in unobservable {
        reasons.entry(unobservable_reason(&effect.cause)).or_default().push(&effect.id);
    }
    reasons
}

/// Returns the verdict, the gap, and where to read the rest.
pub fn text(report: &Report, folder: &Path) -> String {
    let mut lines: Vec<(&str, String)> = Vec::new();
    for effect in &report.effects {
        let others: String = effect.confusable_with.iter().map(|id| format!(", or {id}")).collect();
        lines.push(("found", format!("{}{others}: {}", effect.id, effect_size(effect))));
    }
    for effect in &report.in_model {
        lines.push(("in model", format!("{}: {}", effect.id, effect_size(effect))));
    }
    for finding in &report.unexplained {
        lines.push(("unknown", format!("{}: {}", finding.channel().name(), finding_place(finding))));
    }
    for object in &report.objects {
        lines.push(("object", format!("{}: {}", object_place(object), object_share(object))));
    }
    for (channel, gap) in &report.gap.channels {
        let size = |size: f64| amount(*channel, size, channel.unit(), 3);
        let after = if gap.has_moved() { format!(" → {}", size(gap.after)) } else { String::new() };
        lines.push((channel.name(), format!("{}{after} (noise {})", size(gap.before), size(gap.floor))));
    }
    let limits = report.not_found.iter().map(|effect| format!("{} {}", effect.id, limit(effect)));
    let limits: Vec<String> = limits.collect();
    if !limits.is_empty() {
        lines.push(("not found", format!("would have been from: {}", limits.join(", "))));
    }
    for (reason, effects) in by_reason(&report.unobservable) {
        lines.push(("not seen", format!("{}: {reason}", effects.join(", "))));
    }
    let absorbed = absorbed(report.poses.source);
    if !absorbed.is_empty() {
        lines.push(("poses", absorbed.to_owned()));
    }
    for file in &report.left_out {
        lines.push(("left out", format!("{file}: the picture is missing or broken")));
    }
    lines.push(("report", folder.join("report.html").display().to_string()));
    format!("{}\n{}", summary(report), aligned(&lines))
}
