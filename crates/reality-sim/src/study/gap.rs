//! Findings about a recording's camera.

use reality_sim_gap::{Analysis, report::Report};
use serde_json::Value;

use super::{About, Findings};

/// Says of a comparison what matters among thousands of recordings.
pub(super) fn findings(about: About, analysis: &Analysis) -> Findings {
    let report: &Report = &analysis.report;
    let mut figures = vec![
        ("frames".to_owned(), Some(report.frames as f64)),
        ("gap_before".to_owned(), Some(report.gap.before)),
        ("gap_after".to_owned(), Some(report.gap.after)),
        ("effects".to_owned(), Some(report.effects.len() as f64)),
        ("unexplained".to_owned(), Some(report.unexplained.len() as f64)),
    ];
    for (channel, gap) in &report.gap.channels {
        let name = |which: &str| format!("gap_{}_{which}", channel.name());
        figures.extend([(name("before"), Some(gap.before)), (name("after"), Some(gap.after))]);
    }
    Findings::new(about, figures, without_maps(report))
}

/// Returns the report as `report.json` has it, without the maps, of which nobody looks at thousands.
fn without_maps(report: &Report) -> Value {
    let mut value = serde_json::to_value(report).unwrap_or_default();
    if let Some(keys) = value.as_object_mut() {
        keys.remove("maps");
    }
    value
}
