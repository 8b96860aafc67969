//! `reality-sim evaluate`: compares pictures at poses that are not in the database with those taken there.

use std::{collections::BTreeMap, fmt::Write, path::PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use image::RgbImage;
use serde::Serialize;

use reality_sim::{
    Archive, CameraPose, Sequence,
    montage::grid,
    probing::{MethodReport, Outcome, ProbeResult, compare_methods, names},
    sensor::{Renderer, SceneColors},
    sequence::{counted, save_image, write_atomically},
};

use super::{
    model_file::{ModelArgs, ModelFile, Use, open_corrected},
    output::{check_distinct, check_output_file, frame_progress, print, print_json},
    output_folder::OutputFolder,
    picture_at::SynthesisArgs,
};

/// Options of `evaluate`.
#[derive(Debug, Args)]
pub struct EvaluateArgs {
    /// Database, as `build` makes it
    database: PathBuf,
    /// Folder of a sequence with ground truth whose pictures are not in the database
    probes: PathBuf,
    #[command(flatten)]
    synthesis: SynthesisArgs,
    #[command(flatten)]
    model: ModelArgs,
    /// Write the results of every probe to this CSV file
    #[arg(long, value_name = "FILE")]
    details: Option<PathBuf>,
    /// Write, for every probe, the true picture beside those of all methods to this folder
    #[arg(long, value_name = "FOLDER")]
    pictures: Option<PathBuf>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    database: String,
    probes: usize,
    /// Number of probes at exactly the pose of a recorded image, whose results are meaningless.
    probes_in_database: usize,
    /// Number of images of the field that pictures are made from.
    images: usize,
    /// Whether what stood there while the images were recorded was left out.
    clean: bool,
    /// Results by method.
    methods: BTreeMap<&'static str, MethodReport>,
    /// What of the model was used.
    #[serde(skip_serializing_if = "Option::is_none")]
    corrections: Option<String>,
}

impl EvaluateArgs {
    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        self.synthesis.backend.check_usage()
    }
}

/// Runs the command.
pub fn run(args: &EvaluateArgs) -> anyhow::Result<()> {
    let model = args.model.read()?;
    let archive = args.synthesis.archive(&args.database, model.as_ref())?;
    // Where the database was built without the model, the true poses have to stay as they were there, too.
    let is_corrected = archive.corrected_by().is_some();
    let probes = open_corrected(&args.probes, model.as_ref().filter(|_| is_corrected))?;
    if !probes.has_reference_poses() {
        bail!(
            "{}: has no ground truth: give a sequence with the true poses of its pictures",
            args.probes.display()
        );
    }
    check_poses(args, &probes)?;
    let pictures = check_outputs(args, &probes)?;
    probes.check_pictures()?;
    let synthesizer = args.synthesis.synthesizer(archive.clone(), probes.setup.camera.clone())?;
    let renderer = renderer(&archive, &probes, model.as_ref())?;
    let with_truth = probes.reference_poses().enumerate().filter_map(|(frame, pose)| Some((frame, pose?)));
    let with_truth: Vec<(usize, CameraPose)> = with_truth.collect();
    let progress = frame_progress(with_truth.len())?;
    let mut results = Vec::new();
    let compared = with_truth.iter().try_for_each(|&(frame, pose)| -> anyhow::Result<()> {
        let broken = |error| probes.check_every_picture().err().unwrap_or(error);
        let truth = probes.load_image(frame).map_err(broken)?;
        let probe = compare_methods(&synthesizer, &renderer, frame, pose, truth)?;
        if let Some(folder) = &pictures {
            save_image(&folder.file(format!("{frame:06}.png"))?, &side_by_side(&probe))?;
        }
        results.push(ProbeResult { truth: RgbImage::default(), ..without_pictures(probe) });
        progress.inc(1);
        Ok(())
    });
    progress.finish_and_clear();
    if let Some(file) = &args.details {
        write_atomically(file, details_csv(&results).as_bytes())?;
        let (done, of) = (results.len(), with_truth.len());
        compared.with_context(|| format!("{}: holds {done} of {}", file.display(), counted(of, "probe")))?;
    } else {
        compared?;
    }
    let mut report = Report::new(args, &archive, &results);
    let purpose = Use::Pictures { is_corrected };
    report.corrections = model.map(|model| model.words(archive.setup(), archive.field(), purpose));
    if args.json { print_json(&report) } else { print(&report.text()) }
}

/// Makes the renderer of the simulated pictures: of the camera that took the probes, with the effects that the archive's
/// camera does not contain yet.
fn renderer(archive: &Archive, probes: &Sequence, model: Option<&ModelFile>) -> anyhow::Result<Renderer> {
    let (setup, field) = (&probes.setup, archive.field());
    let colors = SceneColors::new(setup, field);
    Ok(match model {
        Some(model) => Renderer::with_model(setup, field, colors, &archive.missing_of(&model.model))
            .map_err(|error| error.in_file(model.path()))?,
        None => Renderer::new(setup, field, colors),
    })
}

/// Refuses ground truth with poses that no camera can have.
fn check_poses(args: &EvaluateArgs, probes: &Sequence) -> anyhow::Result<()> {
    let is_impossible = |pose: Option<CameraPose>| pose.is_some_and(|pose| !pose.is_possible());
    match probes.reference_poses().position(is_impossible) {
        Some(frame) => bail!(
            "{}: the true pose of frame {frame} is impossible for a camera (above the ground, within 200 m of the field's centre): correct it, or leave it out",
            args.probes.display()
        ),
        None => Ok(()),
    }
}

fn check_outputs(args: &EvaluateArgs, probes: &Sequence) -> anyhow::Result<Option<OutputFolder>> {
    let mut inputs = probes.files.clone();
    inputs.extend(probes.frames.iter().map(|frame| probes.folder.join(&frame.image)));
    inputs.push(args.database.clone());
    inputs.extend(args.model.model.clone());
    check_distinct(&[&args.details, &args.pictures].into_iter().flatten().collect::<Vec<_>>())?;
    args.details.as_ref().map_or(Ok(()), |file| check_output_file(file, &inputs))?;
    args.pictures.as_ref().map(|folder| OutputFolder::check(folder, &inputs)).transpose()
}

/// Arranges the true picture first, then those of the methods; grey where a method has no answer.
fn side_by_side(probe: &ProbeResult) -> RgbImage {
    let missing = RgbImage::from_pixel(probe.truth.width(), probe.truth.height(), image::Rgb([128; 3]));
    let of = |name| probe.outcomes.get(name).map_or(&missing, |outcome| &outcome.picture).clone();
    let pictures: Vec<RgbImage> = std::iter::once(probe.truth.clone()).chain(names().map(of)).collect();
    let rows: Vec<&[RgbImage]> = pictures.chunks(3).collect();
    grid(&rows, probe.truth.width())
}

/// Drops the pictures of a probe: those of all probes would fill the memory.
fn without_pictures(mut probe: ProbeResult) -> ProbeResult {
    probe.outcomes.values_mut().for_each(|outcome| outcome.picture = RgbImage::default());
    probe
}

fn details_csv(results: &[ProbeResult]) -> String {
    let mut csv = String::from("frame,distance_px,method,psnr_db,psnr_field_db,ssim,milliseconds,covered\n");
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for ProbeResult { frame, distance_px, outcomes, .. } in results {
        for name in names() {
            let Some(outcome) = outcomes.get(name) else { continue };
            let Outcome { psnr_db, psnr_field_db, ssim, milliseconds, covered, .. } = outcome;
            let (field, ssim) = (number(*psnr_field_db), number(*ssim));
            // Writing into a string cannot fail.
            let _ = writeln!(
                csv,
                "{frame},{},{name},{psnr_db},{field},{ssim},{milliseconds},{}",
                number(*distance_px),
                number(*covered)
            );
        }
    }
    csv
}

impl Report {
    fn new(args: &EvaluateArgs, archive: &Archive, results: &[ProbeResult]) -> Self {
        Self {
            database: args.database.display().to_string(),
            probes: results.len(),
            probes_in_database: results
                .iter()
                .filter(|probe| probe.distance_px.is_some_and(|px| px < 1e-3))
                .count(),
            images: archive.images().len(),
            clean: args.synthesis.is_clean(),
            methods: names().map(|name| (name, MethodReport::new(name, results))).collect(),
            corrections: None,
        }
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{}, {} in {}\n\n",
            counted(self.probes, "probe"),
            counted(self.images, "image"),
            self.database
        );
        if self.probes_in_database > 0 {
            // Writing into a string cannot fail.
            let _ = writeln!(
                text,
                "{} in the database, which makes the results meaningless: build it without them\n",
                counted(self.probes_in_database, "probe")
            );
        }
        if let Some(corrections) = &self.corrections {
            // Writing into a string cannot fail.
            let _ = writeln!(text, "camera: {corrections}\n");
        }
        text.push_str("method      PSNR of the field    PSNR    SSIM       time  answered\n");
        let shown = |value: Option<f64>, digits: usize| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
        };
        for name in names() {
            let MethodReport { psnr_db, psnr_field_db, ssim, milliseconds, answered, .. } =
                &self.methods[name];
            let [field, whole, time] =
                [(psnr_field_db, 2), (psnr_db, 2), (milliseconds, 1)].map(|(v, d)| shown(*v, d));
            let (ssim, percent) = (shown(*ssim, 3), 100.0 * answered);
            // Writing into a string cannot fail.
            let _ = writeln!(
                text,
                "{name:12}{field:>14} dB {whole:>7} dB{ssim:>6}  {time:>6} ms{percent:>8.0} %"
            );
        }
        text
    }
}
