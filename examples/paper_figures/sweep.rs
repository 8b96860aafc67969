//! Sweep of the settings of the paper's two models: blur, α and border mask on several recordings.

use std::fmt::Write;

use reality_sim::{LocalizerConfig, ObservationKind, observation::ObservationConfig};

use crate::recording::{Model, Recording, Runs};

const BLURS_PX: [f32; 4] = [0.7, 1.0, 1.5, 3.0];
const GAUSS_ALPHAS: [f64; 3] = [100.0, 300.0, 1000.0];
const DISTANCE_ALPHAS: [f64; 3] = [30.0, 100.0, 300.0];

/// Appends a table for each model.
pub fn write(recordings: &[Recording], seeds: u64, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\nMean error of the pictures that were not lost, cm (lost of all seeds together; lost is 0.5 m or 0.5 rad). All else as `reality-sim tag` has it, recovery included."
    )?;
    heading(recordings, "`gauss`", text)?;
    let gauss = ObservationConfig::new(ObservationKind::Gauss);
    // Without the mask, α matters no more than with it.
    for (mask_border, alphas) in [(true, &GAUSS_ALPHAS[..]), (false, &GAUSS_ALPHAS[1..2])] {
        for blur_sigma_px in BLURS_PX {
            for &alpha in alphas {
                let label = format!("{} px, α {alpha}{}", blur_sigma_px, unmasked(mask_border));
                let config =
                    gauss.with_blur_sigma_px(blur_sigma_px).with_alpha(alpha).with_mask_border(mask_border);
                row(recordings, seeds, &label, config, text)?;
            }
        }
    }
    heading(recordings, "`distance`", text)?;
    let distance = ObservationConfig::new(ObservationKind::Distance);
    for (mask_border, alphas) in [(true, &DISTANCE_ALPHAS[..]), (false, &DISTANCE_ALPHAS[1..2])] {
        for &alpha in alphas {
            let label = format!("α {alpha}{}", unmasked(mask_border));
            let config = distance.with_alpha(alpha).with_mask_border(mask_border);
            row(recordings, seeds, &label, config, text)?;
        }
    }
    Ok(())
}

fn unmasked(mask_border: bool) -> &'static str {
    if mask_border { "" } else { ", no mask" }
}

fn heading(recordings: &[Recording], model: &str, text: &mut String) -> anyhow::Result<()> {
    let names: Vec<&str> = recordings.iter().map(|recording| recording.sequence.name.as_str()).collect();
    writeln!(text, "\n## {model}\n\n| | {} | lost in all |", names.join(" | "))?;
    writeln!(text, "|---|{}---|", "---|".repeat(names.len()))?;
    Ok(())
}

fn row(
    recordings: &[Recording],
    seeds: u64,
    label: &str,
    observation: ObservationConfig,
    text: &mut String,
) -> anyhow::Result<()> {
    let config = LocalizerConfig::new(observation.kind).with_observation(observation);
    let runs: Vec<Runs> = recordings
        .iter()
        .map(|recording| recording.runs(seeds, config, Model::Configured))
        .collect::<anyhow::Result<_>>()?;
    let cells: Vec<String> =
        runs.iter().map(|runs| format!("{:.1} ({})", runs.kept_cm(), runs.lost_in_all())).collect();
    let lost: usize = runs.iter().map(Runs::lost_in_all).sum();
    let line = format!("| {label} | {} | {lost} |", cells.join(" | "));
    eprintln!("{line}");
    writeln!(text, "{line}")?;
    Ok(())
}
