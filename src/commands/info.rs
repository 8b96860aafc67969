//! `reality-sim info`: summarises the contents of a database, or of a log.

use std::{collections::BTreeMap, fs, path::PathBuf};

use anyhow::bail;
use clap::Args;
use serde::Serialize;

use reality_sim::{
    Archive, SynthesisError,
    coverage_chart::coverage_svg,
    db::{Database, ImageRecord, SCHEMA_VERSION, coverage::Coverage},
    evaluation::percentile,
    sequence::{counted, write_atomically},
};

use reality_sim_formats::Input;

use super::{
    log_info,
    output::{aligned, check_output_file, print, print_json},
};

/// Side of a cell of the carpet, metres.
const CELL_M: f64 = 0.25;

/// Distance below which pictures are near, pixels: both show most of the same.
const NEAR_PX: f64 = 100.0;

/// Options of `info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Database, as `build` makes it, or a robot's log
    #[arg(value_name = "DATABASE|LOG")]
    database: PathBuf,
    /// Draw to this SVG file where and in which directions pictures were taken, and how far the nearest one is
    #[arg(long, value_name = "FILE")]
    coverage: Option<PathBuf>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    database: String,
    schema_version: i64,
    bytes: u64,
    images: usize,
    sequences: Vec<SequenceReport>,
    cameras: Vec<CameraReport>,
    fields: Vec<FieldReport>,
    pose_sources: Vec<PoseSourceReport>,
    /// Coverage of the field, if there are images.
    #[serde(skip_serializing_if = "Option::is_none")]
    coverage: Option<CoverageReport>,
}

#[derive(Serialize)]
struct SequenceReport {
    name: String,
    images: usize,
    first_timestamp_s: f64,
    last_timestamp_s: f64,
}

#[derive(Serialize)]
struct CameraReport {
    model: &'static str,
    width: u32,
    height: u32,
    images: usize,
}

/// Field that most images show, and of which pictures can be made.
#[derive(Serialize)]
struct FieldReport {
    name: String,
    images: usize,
}

#[derive(Serialize)]
struct PoseSourceReport {
    /// Source of the poses: `groundtruth`, `filter` or `file`.
    kind: &'static str,
    /// Settings of the filter, or name of the file.
    description: String,
    images: usize,
}

/// Coverage of the carpet in squares of 25 cm and eight headings.
#[derive(Serialize)]
struct CoverageReport {
    /// Share of the squares in which a picture was taken.
    squares_with_pictures: f64,
    /// Share of squares and headings with a picture nearer than 100 px.
    near: f64,
    /// Median distance from a square's centre to the nearest picture, over squares and headings, root mean square pixels.
    median_distance_px: f64,
    /// 95th percentile of the same distances.
    p95_distance_px: f64,
}

/// Runs the command.
pub fn run(args: &InfoArgs) -> anyhow::Result<()> {
    if Input::at(&args.database) == Some(Input::Log) {
        if args.coverage.is_some() {
            bail!("{}: is a log: --coverage draws databases only", args.database.display());
        }
        return log_info::run(&args.database, args.json);
    }
    if let Some(file) = &args.coverage {
        if file.extension().is_none_or(|ending| ending != "svg") {
            bail!("{}: is not the name of an SVG file: give one that ends in .svg", file.display());
        }
        check_output_file(file, std::slice::from_ref(&args.database))?;
    }
    let database = Database::open(&args.database)?;
    let images = database.images()?;
    let coverage = match Archive::open(&args.database, 0) {
        Ok(archive) => {
            Some((Coverage::new(archive.index(), archive.field(), archive.usual_pose(), CELL_M), archive))
        }
        Err(SynthesisError::Empty { .. } | SynthesisError::BlindCamera { .. }) if args.coverage.is_none() => {
            None
        }
        Err(error) => return Err(error.into()),
    };
    if let (Some(file), Some((coverage, archive))) = (&args.coverage, &coverage) {
        let name = args.database.file_name().unwrap_or_default().to_string_lossy();
        let title = format!("{name}: {}", counted(archive.images().len(), "picture"));
        write_atomically(file, coverage_svg(coverage, archive.field(), &title).as_bytes())?;
    }
    let report = Report::new(args, &database, &images, coverage.as_ref().map(|(coverage, _)| coverage))?;
    if args.json { print_json(&report) } else { print(&report.text()) }
}

impl Report {
    fn new(
        args: &InfoArgs,
        database: &Database,
        images: &[ImageRecord],
        coverage: Option<&Coverage>,
    ) -> anyhow::Result<Self> {
        let count =
            |is_one: &dyn Fn(&ImageRecord) -> bool| images.iter().filter(|image| is_one(image)).count();
        let sequences = database.sequences()?;
        let cameras = database.cameras()?;
        let pose_sources = database.pose_sources()?;
        let mut by_pose_source: BTreeMap<i64, usize> = BTreeMap::new();
        database.each_image(|_, details| *by_pose_source.entry(details.pose_source_id).or_default() += 1)?;
        Ok(Self {
            database: args.database.display().to_string(),
            schema_version: SCHEMA_VERSION,
            bytes: fs::metadata(&args.database).map_or(0, |metadata| metadata.len()),
            images: images.len(),
            sequences: sequence_reports(&sequences, images),
            cameras: cameras
                .iter()
                .map(|(id, setup)| CameraReport {
                    model: setup.camera.distortion.colmap_name(),
                    width: setup.camera.width,
                    height: setup.camera.height,
                    images: count(&|image| image.camera_id == *id),
                })
                .collect(),
            fields: database
                .fields()?
                .into_iter()
                .map(|(id, field)| FieldReport {
                    name: field.name,
                    images: count(&|image| image.field_id == id),
                })
                .collect(),
            pose_sources: pose_sources
                .iter()
                .map(|(id, source)| PoseSourceReport {
                    kind: source.kind(),
                    description: source.description().to_owned(),
                    images: by_pose_source.get(id).copied().unwrap_or_default(),
                })
                .collect(),
            coverage: coverage.map(CoverageReport::new),
        })
    }

    fn text(&self) -> String {
        let pictures = |images: usize| counted(images, "picture");
        let mut lines = vec![(
            "database",
            format!(
                "{}, {}, {:.1} MB, version {}",
                self.database,
                pictures(self.images),
                self.bytes as f64 / 1e6,
                self.schema_version
            ),
        )];
        for SequenceReport { name, images, first_timestamp_s, last_timestamp_s } in &self.sequences {
            let seconds = last_timestamp_s - first_timestamp_s;
            lines.push(("sequence", format!("{name}: {} in {seconds:.0} s", pictures(*images))));
        }
        for CameraReport { model, width, height, images } in &self.cameras {
            lines.push(("camera", format!("{model}, {width} × {height}: {}", pictures(*images))));
        }
        let field =
            |FieldReport { name, images }: &FieldReport| ("field", format!("{name}: {}", pictures(*images)));
        lines.extend(self.fields.iter().map(field));
        for PoseSourceReport { kind, description, images } in &self.pose_sources {
            let gap = if description.is_empty() { "" } else { ", " };
            lines.push(("poses", format!("{kind}{gap}{description}: {}", pictures(*images))));
        }
        if let Some(coverage) = &self.coverage {
            let [squares, near] = [coverage.squares_with_pictures, coverage.near].map(|share| 100.0 * share);
            let (median, p95) = (coverage.median_distance_px, coverage.p95_distance_px);
            lines.push((
                "coverage",
                format!("{squares:.0} % of the carpet's squares of 25 cm hold a picture"),
            ));
            lines.push((
                "",
                format!("{near:.0} % of all places and headings have one nearer than {NEAR_PX:.0} px"),
            ));
            lines.push((
                "",
                format!(
                    "the nearest picture is {median:.0} px away in the median, and below {p95:.0} px in 95 %"
                ),
            ));
        }
        aligned(&lines)
    }
}

fn sequence_reports(names: &BTreeMap<i64, String>, images: &[ImageRecord]) -> Vec<SequenceReport> {
    let report = |(id, name): (&i64, &String)| {
        let times: Vec<f64> =
            images.iter().filter(|image| image.sequence_id == *id).map(|image| image.timestamp_s).collect();
        SequenceReport {
            name: name.clone(),
            images: times.len(),
            first_timestamp_s: times.iter().copied().reduce(f64::min).unwrap_or(0.0),
            last_timestamp_s: times.iter().copied().reduce(f64::max).unwrap_or(0.0),
        }
    };
    names.iter().map(report).collect()
}

impl CoverageReport {
    fn new(coverage: &Coverage) -> Self {
        let with_pictures = coverage.cells.iter().filter(|cell| cell.count() > 0).count();
        let mut distances: Vec<f64> = coverage.cells.iter().flat_map(|cell| cell.distance_px).collect();
        distances.sort_by(f64::total_cmp);
        let at = |share: f64| percentile(&distances, share).unwrap_or_default();
        Self {
            squares_with_pictures: with_pictures as f64 / coverage.cells.len() as f64,
            near: coverage.share_within(NEAR_PX),
            median_distance_px: at(0.5),
            p95_distance_px: at(0.95),
        }
    }
}
