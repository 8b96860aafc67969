//! `camera.toml` and `field.toml` with the corrections that were found, and how sure they are.

use std::{fmt::Write, path::Path};

use reality_sim::{
    Sequence,
    gap::{Analysis, report::EffectReport},
    sensor::{Corrected, Model},
    sequence::read_mounting,
};

use super::GapArgs;

/// Returns names and texts of the corrected files; `folder` is that of the sequence's own files.
pub fn corrected_files(
    args: &GapArgs,
    (sequence, folder): (&Sequence, &Path),
    analysis: &Analysis,
) -> anyhow::Result<[(&'static str, String); 2]> {
    let model = &analysis.model;
    let corrected = model.corrected(&sequence.setup, &sequence.field)?;
    let stated = read_mounting(&Sequence::camera_file(folder)?)?;
    let mounting = stated.then(corrected.mounting().unwrap_or_default());
    let camera = corrected.setup_with_light().to_toml_with(&args.out, mounting)?;
    let field = corrected.field().to_toml(&args.out)?;
    let effects: Vec<&EffectReport> =
        analysis.report.effects.iter().chain(&analysis.report.in_model).collect();
    let of_effects = |is_in_file: fn(&Corrected, &Sequence) -> bool| -> Vec<&EffectReport> {
        let alone = |id: &str| model.effects.iter().filter(|used| used.effect.id() == id).cloned().collect();
        let corrected = |id: &str| Model { effects: alone(id) }.corrected(&sequence.setup, &sequence.field);
        let is_told =
            |effect: &EffectReport| corrected(&effect.id).is_ok_and(|alone| is_in_file(&alone, sequence));
        effects.iter().copied().filter(|effect| is_told(effect)).collect()
    };
    let of_camera = of_effects(|alone, sequence| {
        alone.setup_with_light() != sequence.setup
            || alone.mounting().is_some_and(|it| !it.is_nearly_as_stated())
    });
    let of_field = of_effects(|alone, sequence| *alone.field() != sequence.field);
    Ok([
        ("camera.toml", with_header(&args.sequence, &camera, &of_camera)),
        ("field.toml", with_header(&args.sequence, &field, &of_field)),
    ])
}

/// Adds what the file is, and a table of the covariance of the effects' parameters.
fn with_header(sequence: &Path, text: &str, effects: &[&EffectReport]) -> String {
    let sequence = sequence.display();
    let mut text =
        format!("# As found by `reality-sim gap` in {sequence}; takes the place of the file there.\n{text}");
    let parameters: Vec<(String, f64)> = effects
        .iter()
        .flat_map(|effect| {
            let name = |parameter: &str| format!("{}.{parameter}", effect.id);
            effect.parameters.iter().map(move |(parameter, estimate)| (name(parameter), estimate.sigma))
        })
        .filter(|(_, sigma)| sigma.is_finite())
        .collect();
    if parameters.is_empty() {
        return text;
    }
    // Writing into a string cannot fail.
    let _ = writeln!(
        text,
        "\n# Of the corrections, by the names of model.toml, in its units; between effects it is not known."
    );
    let _ = writeln!(text, "[covariance]");
    let names: Vec<String> = parameters.iter().map(|(name, _)| format!("{name:?}")).collect();
    let _ = writeln!(text, "parameters = [{}]", names.join(", "));
    let sigmas: Vec<String> = parameters.iter().map(|(_, sigma)| format!("{sigma:e}")).collect();
    let _ = writeln!(text, "sigma = [{}]", sigmas.join(", "));
    let _ = writeln!(text, "matrix = [");
    for (row, row_sigma) in &parameters {
        let cells: Vec<String> = parameters
            .iter()
            .map(|(column, sigma)| format!("{:e}", correlation(effects, row, column) * row_sigma * sigma))
            .collect();
        let _ = writeln!(text, "    [{}],", cells.join(", "));
    }
    let _ = writeln!(text, "]");
    text
}

/// Returns the correlation of two parameters, each by its effect's id and its name; 0 between effects.
fn correlation(effects: &[&EffectReport], row: &str, column: &str) -> f64 {
    if row == column {
        return 1.0;
    }
    let (Some((id, first)), Some((other, second))) = (row.split_once('.'), column.split_once('.')) else {
        return 0.0;
    };
    let effect = effects.iter().find(|effect| effect.id == id && id == other);
    let known = effect.and_then(|effect| {
        let between = |a: &str, b: &str| effect.correlations.get(a)?.get(b).copied();
        between(first, second).or_else(|| between(second, first))
    });
    known.unwrap_or_default()
}
