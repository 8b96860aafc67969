//! The paper's Table 2 and Fig. 9.

use std::{fmt::Write, path::Path};

use plotters::prelude::SeriesLabelPosition;
use reality_sim::{LocalizerConfig, ObservationKind};

use crate::{
    OUT,
    curves::{self, Axes, Named},
    recording::{Model, Recording, Runs},
};

const PARTICLES: [usize; 8] = [50, 100, 200, 400, 800, 1600, 3000, 10_000];
/// Number of particles from which one seed is enough: the seeds hardly differ any more, and ten would take most of an hour.
const ONE_SEED_FROM: usize = 10_000;

/// Curves of Fig. 9: model and name. In the last one the particles do all the work: without odometry, a single iteration
/// leaves them far apart, and there is no search for a lost pose.
const CURVES: [(ObservationKind, &str); 4] = [
    (ObservationKind::Gauss, "gauss"),
    (ObservationKind::Distance, "distance"),
    (ObservationKind::Contrast, "contrast"),
    (ObservationKind::Gauss, PARTICLES_ALONE),
];
const PARTICLES_ALONE: &str = "gauss, particles alone";

/// Returns the settings of a model as in the paper: neither search nor refinement.
fn as_in_the_paper(kind: ObservationKind) -> LocalizerConfig {
    LocalizerConfig::new(kind).with_relocalization(false).with_refinement(false)
}

/// Appends both tables and writes the plots.
pub fn write(recording: &Recording, seeds: u64, text: &mut String) -> anyhow::Result<()> {
    table_2(recording, seeds, text)?;
    figure_9(recording, seeds, text)
}

fn table_2(recording: &Recording, seeds: u64, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\n## Table 2: 800 particles\n\n{seeds} seeds; one for Eq. 1 to the letter, which is slow.\n\n| | mean error | smallest to largest of the seeds | frames lost | time a frame |\n|---|---|---|---|---|"
    )?;
    writeln!(text, "| the paper, Gauss-based, Intel i5 2.5 GHz | 18.1 cm | | | 850 ms |")?;
    writeln!(text, "| the paper, distance-based | 18.5 cm | | | 1,760 ms |")?;
    for kind in ObservationKind::ALL {
        let paper = as_in_the_paper(kind);
        table_2_row(recording, seeds, &format!("`{kind}`, as in the paper"), paper, Model::Configured, text)?;
        if kind == ObservationKind::Distance {
            let label = "Eq. 1 to the letter, as in the paper";
            table_2_row(recording, 1, label, paper, Model::NormalSearch, text)?;
        }
        let default = LocalizerConfig::new(kind);
        table_2_row(recording, seeds, &format!("`{kind}`, default"), default, Model::Configured, text)?;
    }
    Ok(())
}

fn table_2_row(
    recording: &Recording,
    seeds: u64,
    label: &str,
    config: LocalizerConfig,
    model: Model,
    text: &mut String,
) -> anyhow::Result<()> {
    let runs = recording.runs(seeds, config, model)?;
    let [low, high] = runs.range_cm();
    writeln!(
        text,
        "| {label} | {:.2} cm | {low:.2} to {high:.2} cm | {:.1} | {:.1} ms |",
        runs.mean_cm(),
        runs.lost(),
        runs.milliseconds()
    )?;
    Ok(())
}

fn figure_9(recording: &Recording, seeds: u64, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\n## Fig. 9: error and time against the number of particles\n\nMean error in cm (smallest to largest of the seeds), frames lost, milliseconds a frame; default settings, {seeds} seeds, one from {ONE_SEED_FROM} particles on. Particles alone: one iteration, no odometry, no search.\n"
    )?;
    let names = CURVES.map(|(_, name)| name);
    writeln!(text, "| particles | {} |\n|---|---|---|---|---|", names.join(" | "))?;
    let mut curves: Vec<Vec<(f64, Runs)>> = CURVES.iter().map(|_| Vec::new()).collect();
    for particles in PARTICLES {
        write!(text, "| {particles} |")?;
        for (curve, (kind, name)) in curves.iter_mut().zip(CURVES) {
            let mut config = LocalizerConfig::new(kind);
            config.filter.particles = particles;
            if name == PARTICLES_ALONE {
                config.filter.iterations = 1;
                (config.uses_odometry, config.relocalizes) = (false, false);
            }
            let seeds = if particles < ONE_SEED_FROM { seeds } else { 1 };
            let runs = recording.runs(seeds, config, Model::Configured)?;
            let [low, high] = runs.range_cm();
            write!(
                text,
                " {:.2} ({low:.2} to {high:.2}), {:.1} lost, {:.1} ms |",
                runs.mean_cm(),
                runs.lost(),
                runs.milliseconds()
            )?;
            curve.push((particles as f64, runs));
        }
        writeln!(text)?;
    }
    plot(
        "error.svg",
        "mean error (cm)",
        &curves,
        Runs::mean_cm,
        [18.1, 18.5],
        SeriesLabelPosition::UpperRight,
    )?;
    plot(
        "time.svg",
        "time a frame (ms)",
        &curves,
        Runs::milliseconds,
        [850.0, 1760.0],
        SeriesLabelPosition::UpperLeft,
    )
}

/// Plots a curve for each model over the number of particles, with the paper's values for its Gauss-based and its distance-based
/// model with 800 particles.
fn plot(
    file: &str,
    label: &str,
    curves: &[Vec<(f64, Runs)>],
    value: impl Fn(&Runs) -> f64,
    paper: [f64; 2],
    legend: SeriesLabelPosition,
) -> anyhow::Result<()> {
    let points = |curve: &Vec<(f64, Runs)>| curve.iter().map(|(x, runs)| (*x, value(runs))).collect();
    let curves = CURVES.iter().zip(curves).map(|((_, name), curve)| (*name, points(curve)));
    let curves: Vec<Named> = curves.collect();
    let names = ObservationKind::ALL.map(|kind| format!("the paper, {kind}"));
    let crosses: Vec<Named> =
        names.iter().zip(paper).map(|(name, value)| (name.as_str(), vec![(800.0, value)])).collect();
    let axes = Axes { x: "particles", y: label, x_range: 45.0..12_000.0 };
    curves::plot(&Path::new(OUT).join(file), axes, &curves, &crosses, legend)
}
