//! The paper's Table 2 and Fig. 9.

use std::fmt::Write;

use anyhow::Context;
use plotters::prelude::*;
use reality_sim::{LocalizerConfig, ObservationKind};

use crate::{
    OUT,
    recording::{Model, Recording, Runs},
};

const PARTICLES: [usize; 10] = [50, 100, 200, 400, 800, 1600, 3000, 10_000, 30_000, 100_000];

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
        "\n## Table 2: 800 particles\n\nTimes on a machine with other work; only their ratios mean anything.\n\n| | mean error | smallest to largest of the seeds | frames lost | time a frame |\n|---|---|---|---|---|"
    )?;
    writeln!(text, "| the paper, Gauss-based, Intel i5 2.5 GHz | 18.1 cm | | | 850 ms |")?;
    writeln!(text, "| the paper, distance-based | 18.5 cm | | | 1,760 ms |")?;
    for kind in ObservationKind::ALL {
        let paper = as_in_the_paper(kind);
        table_2_row(recording, seeds, &format!("`{kind}`, as in the paper"), paper, Model::Configured, text)?;
        if kind == ObservationKind::Distance {
            let label = "Eq. 1 to the letter, as in the paper";
            table_2_row(recording, seeds, label, paper, Model::NormalSearch, text)?;
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
        "\n## Fig. 9: error and time against the number of particles\n\nMean error in cm (smallest to largest of the seeds), frames lost, milliseconds a frame; default settings. Particles alone: one iteration, no odometry, no search.\n"
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
        SeriesLabelPosition::LowerRight,
    )
}

/// Plots a curve for each model over the number of particles, both axes logarithmic, with the paper's values for its
/// Gauss-based and its distance-based model with 800 particles.
fn plot(
    file: &str,
    label: &str,
    curves: &[Vec<(f64, Runs)>],
    value: impl Fn(&Runs) -> f64,
    paper: [f64; 2],
    legend: SeriesLabelPosition,
) -> anyhow::Result<()> {
    let path = format!("{OUT}/{file}");
    let points: Vec<Vec<(f64, f64)>> =
        curves.iter().map(|curve| curve.iter().map(|(x, runs)| (*x, value(runs))).collect()).collect();
    let values = || points.iter().flatten().map(|(_, y)| *y).chain(paper);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let root = SVGBackend::new(&path, (640, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d((45.0..130_000.0).log_scale(), (0.8 * low..1.3 * high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("particles")
        .y_desc(label)
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .light_line_style(WHITE)
        .draw()?;
    let colors =
        [RGBColor(214, 96, 77), RGBColor(67, 147, 195), RGBColor(27, 120, 55), RGBColor(244, 165, 130)];
    for ((value, kind), color) in paper.into_iter().zip(ObservationKind::ALL).zip(colors) {
        chart
            .draw_series([Cross::new((800.0, value), 5, color.stroke_width(2))])?
            .label(format!("the paper, {kind}"))
            .legend(move |(x, y)| Cross::new((x + 9, y), 5, color.stroke_width(2)));
    }
    for ((points, (_, name)), color) in points.iter().zip(CURVES).zip(colors) {
        chart
            .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart.configure_series_labels().position(legend).background_style(WHITE).border_style(BLACK).draw()?;
    root.present().with_context(|| format!("{path}: cannot be written"))
}

/// Formats ticks of a logarithmic axis: 1, 2 and 5 in every decade, so that none covers another.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form that the plotting library calls")]
fn tick(value: &f64) -> String {
    let decade = 10_f64.powf(value.log10().floor());
    match (value / decade).round() as u32 {
        1 | 2 | 5 if *value >= 1.0 => format!("{value:.0}"),
        1 | 2 | 5 => format!("{value:.2}"),
        _ => String::new(),
    }
}
