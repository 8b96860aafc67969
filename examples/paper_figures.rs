//! The paper's Table 2 and Fig. 9, and the sweep the defaults come from, on any sequence with ground truth:
//!
//! `cargo run --release --example paper_figures -- SEQUENCE [FRAMES] [SEEDS]`
//!
//! writes `docs/figures/tables.md`, `docs/figures/error.svg` and `docs/figures/time.svg`.

use std::{fmt::Write, fs, path::Path};

use anyhow::Context;
use image::RgbImage;
use plotters::prelude::*;
use reality_sim::{
    ObservationKind, Sequence, TagConfig, Tagger,
    evaluation::{PoseError, percentile},
    tag::recorded,
};

const PARTICLES: [usize; 7] = [50, 100, 200, 400, 800, 1600, 3000];
const MODELS: [(ObservationKind, &str); 3] = [
    (ObservationKind::Gauss, "gauss"),
    (ObservationKind::Distance, "distance"),
    (ObservationKind::Contrast, "contrast"),
];
const OUT: &str = "docs/figures";

/// The pictures of a sequence, decoded once for all runs.
struct Recording {
    sequence: Sequence,
    pictures: Vec<RgbImage>,
}

/// What one run over the recording came to.
struct Run {
    mean_m: f64,
    lost: usize,
    seconds_per_frame: f64,
}

/// Runs that differ in nothing but the seed.
struct Runs(Vec<Run>);

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = arguments.first().map_or("assets/walk", String::as_str);
    let number = |index: usize, default: usize| -> anyhow::Result<usize> {
        arguments
            .get(index)
            .map_or(Ok(default), |text| text.parse().with_context(|| format!("{text}: is no number")))
    };
    let recording = Recording::open(Path::new(folder), number(1, usize::MAX)?)?;
    let seeds = number(2, 3)? as u64;
    fs::create_dir_all(OUT).with_context(|| format!("{OUT}: cannot be made"))?;

    let mut text = format!(
        "Made by `cargo run --release --example paper_figures -- SEQUENCE {} {seeds}` on `{}`: {} pictures, {seeds} seeds.\n",
        recording.pictures.len(),
        recording.sequence.name,
        recording.pictures.len(),
    );
    table_2(&recording, seeds, &mut text)?;
    figure_9(&recording, seeds, &mut text)?;
    sweep(&recording, &mut text)?;
    let file = format!("{OUT}/tables.md");
    fs::write(&file, text).with_context(|| format!("{file}: cannot be written"))
}

impl Recording {
    fn open(folder: &Path, frames: usize) -> anyhow::Result<Self> {
        let mut sequence = Sequence::open(folder)?;
        sequence.frames.truncate(frames);
        sequence.groundtruth.truncate(frames);
        let pictures =
            (0..sequence.frames.len()).map(|index| sequence.load_image(index)).collect::<Result<_, _>>()?;
        Ok(Self { sequence, pictures })
    }

    fn run(&self, config: TagConfig) -> Run {
        let Sequence { setup, field, start, groundtruth, .. } = &self.sequence;
        let mut tagger = Tagger::new(&setup.camera, field, *start, config);
        let (mut errors, mut seconds) = (Vec::new(), Vec::new());
        for (index, picture) in self.pictures.iter().enumerate() {
            let frame = tagger.tag(recorded(&self.sequence, index, picture));
            errors.extend(groundtruth[index].map(|truth| PoseError::new(frame.pose, truth)));
            seconds.push(frame.seconds);
        }
        seconds.sort_by(f64::total_cmp);
        Run {
            mean_m: errors.iter().map(|error| error.distance_m).sum::<f64>() / errors.len().max(1) as f64,
            lost: errors.iter().filter(|error| error.is_lost()).count(),
            seconds_per_frame: percentile(&seconds, 0.5).unwrap_or(0.0),
        }
    }

    fn runs(&self, seeds: u64, config: TagConfig) -> Runs {
        let seeded = |seed| {
            let mut config = config;
            config.filter.seed = seed;
            self.run(config)
        };
        Runs((0..seeds.max(1)).map(seeded).collect())
    }
}

impl Runs {
    fn mean(&self, value: impl Fn(&Run) -> f64) -> f64 {
        self.0.iter().map(value).sum::<f64>() / self.0.len() as f64
    }

    fn mean_cm(&self) -> f64 {
        100.0 * self.mean(|run| run.mean_m)
    }

    /// Smallest and largest mean error of a run, centimetres.
    fn range_cm(&self) -> [f64; 2] {
        let means = || self.0.iter().map(|run| 100.0 * run.mean_m);
        [means().fold(f64::INFINITY, f64::min), means().fold(0.0, f64::max)]
    }

    fn milliseconds(&self) -> f64 {
        1e3 * self.mean(|run| run.seconds_per_frame)
    }

    fn lost(&self) -> f64 {
        self.mean(|run| run.lost as f64)
    }
}

/// A model as in the paper: neither search nor refinement.
fn as_in_the_paper(kind: ObservationKind) -> TagConfig {
    let config = TagConfig::new(kind);
    TagConfig { recovery: false, refine: false, ..config }
}

fn table_2(recording: &Recording, seeds: u64, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\n## Table 2: 800 particles\n\n| | mean error | smallest to largest of the seeds | frames lost | time a frame |\n|---|---|---|---|---|"
    )?;
    writeln!(text, "| the paper, Gauss-based, Intel i5 2.5 GHz | 18.1 cm | | | 850 ms |")?;
    writeln!(text, "| the paper, distance-based | 18.5 cm | | | 1,760 ms |")?;
    for (kind, name) in MODELS {
        for (label, config) in [("as in the paper", as_in_the_paper(kind)), ("default", TagConfig::new(kind))]
        {
            let runs = recording.runs(seeds, config);
            let [low, high] = runs.range_cm();
            writeln!(
                text,
                "| `{name}`, {label} | {:.2} cm | {low:.2} to {high:.2} cm | {:.1} | {:.1} ms |",
                runs.mean_cm(),
                runs.lost(),
                runs.milliseconds()
            )?;
        }
    }
    Ok(())
}

fn figure_9(recording: &Recording, seeds: u64, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\n## Fig. 9: error and time against the number of particles\n\nMean error in cm (smallest to largest of the seeds), frames lost, milliseconds a frame; default settings.\n"
    )?;
    writeln!(text, "| particles | gauss | distance | contrast |\n|---|---|---|---|")?;
    let mut curves: Vec<Vec<(f64, Runs)>> = MODELS.iter().map(|_| Vec::new()).collect();
    for particles in PARTICLES {
        write!(text, "| {particles} |")?;
        for (curve, (kind, _)) in curves.iter_mut().zip(MODELS) {
            let mut config = TagConfig::new(kind);
            config.filter.particles = particles;
            let runs = recording.runs(seeds, config);
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
    plot("error.svg", "mean error (cm)", &curves, Runs::mean_cm)?;
    plot("time.svg", "time a frame (ms)", &curves, Runs::milliseconds)
}

fn sweep(recording: &Recording, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\n## Blur and α of `gauss`, as in the paper\n\nMean error in cm with the border mask / without it (frames lost), one seed.\n"
    )?;
    let alphas = [300.0, 1000.0, 3000.0];
    writeln!(
        text,
        "| blur σ | {} |\n|---|---|---|---|",
        alphas.map(|alpha| format!("α = {alpha}")).join(" | ")
    )?;
    for blur_sigma_px in [0.7, 1.0, 1.5, 2.0, 3.0, 4.5] {
        let mut cells = Vec::new();
        for alpha in alphas {
            let cell = [true, false].map(|mask_border| {
                let mut config = as_in_the_paper(ObservationKind::Gauss);
                (config.observation.blur_sigma_px, config.observation.alpha) = (blur_sigma_px, alpha);
                config.observation.mask_border = mask_border;
                let run = recording.run(config);
                format!("{:.1} ({})", 100.0 * run.mean_m, run.lost)
            });
            cells.push(cell.join(" / "));
        }
        writeln!(text, "| {blur_sigma_px} px | {} |", cells.join(" | "))?;
    }
    writeln!(text, "\n## α of `distance`, as in the paper\n\n| α | mean error (frames lost) |\n|---|---|")?;
    for alpha in [30.0, 100.0, 300.0, 1000.0] {
        let mut config = as_in_the_paper(ObservationKind::Distance);
        config.observation.alpha = alpha;
        let run = recording.run(config);
        writeln!(text, "| {alpha} | {:.1} cm ({}) |", 100.0 * run.mean_m, run.lost)?;
    }
    Ok(())
}

/// A curve for each model over the number of particles, both axes logarithmic.
fn plot(
    file: &str,
    label: &str,
    curves: &[Vec<(f64, Runs)>],
    value: impl Fn(&Runs) -> f64,
) -> anyhow::Result<()> {
    let path = format!("{OUT}/{file}");
    let points: Vec<Vec<(f64, f64)>> =
        curves.iter().map(|curve| curve.iter().map(|(x, runs)| (*x, value(runs))).collect()).collect();
    let values = || points.iter().flatten().map(|(_, y)| *y);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let root = SVGBackend::new(&path, (640, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d((45.0..3300.0).log_scale(), (0.8 * low..1.3 * high).log_scale())?;
    chart.configure_mesh().x_desc("particles").y_desc(label).light_line_style(WHITE).draw()?;
    for ((points, (_, name)), color) in
        points.iter().zip(MODELS).zip([RGBColor(214, 96, 77), RGBColor(67, 147, 195), RGBColor(27, 120, 55)])
    {
        chart
            .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart.configure_series_labels().background_style(WHITE).border_style(BLACK).draw()?;
    root.present().with_context(|| format!("{path}: cannot be written"))
}
