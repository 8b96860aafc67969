//! Comparison of methods at poses whose true picture is known.

use std::{collections::BTreeMap, time::Instant};

use image::RgbImage;
use serde::Serialize;

use crate::{
    CameraPose, SynthesisError, Synthesizer,
    evaluation::percentile,
    preprocess::luma,
    sensor::{RenderError, Renderer},
    synthesis::{
        MethodKind,
        quality::{Mask, psnr_db, ssim},
    },
};

/// Result of one method for one probe.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Peak signal-to-noise ratio against the true picture, dB.
    pub psnr_db: f64,
    /// PSNR over the field's carpet, dB; `None` if the probe shows no carpet.
    pub psnr_field_db: Option<f64>,
    /// Structural similarity of the grey values; `None` in pictures smaller than its window.
    pub ssim: Option<f64>,
    /// Time with the neighbours' pictures already decoded.
    pub milliseconds: f64,
    /// Share of the pixels that some recorded picture shows; `None` for a picture drawn from the model.
    pub covered: Option<f64>,
    /// Picture that the method made.
    pub picture: RgbImage,
}

/// Probe with the outcome of each method that gave a picture.
#[derive(Debug, Clone)]
pub struct ProbeResult {
    /// Number of the probe.
    pub frame: usize,
    /// Distance from the nearest recorded picture, root mean square pixels.
    pub distance_px: Option<f64>,
    /// True picture.
    pub truth: RgbImage,
    /// Outcomes by the names of the methods.
    pub outcomes: BTreeMap<&'static str, Outcome>,
}

/// Means over the probes that got a picture; the time is the median.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MethodReport {
    /// PSNR over whole pictures, dB.
    pub psnr_db: Option<f64>,
    /// PSNR over the field's carpet, dB.
    pub psnr_field_db: Option<f64>,
    /// Structural similarity of the grey values.
    pub ssim: Option<f64>,
    /// Time with the neighbours' pictures already decoded.
    pub milliseconds: Option<f64>,
    /// Share of the pixels that some recorded picture shows.
    pub covered: Option<f64>,
    /// Share of the probes that got a picture.
    pub answered: f64,
}

/// Makes the picture at a pose by every method and compares it with the true one, which has the size of the synthesizer's
/// camera. Methods that refuse have no outcome.
pub fn compare_methods(
    synthesizer: &Synthesizer,
    renderer: &Renderer,
    frame: usize,
    pose: CameraPose,
    truth: RgbImage,
) -> Result<ProbeResult, ProbingError> {
    let mask = Mask::carpet(synthesizer.camera(), pose, synthesizer.archive().field());
    let grey = luma(&truth);
    let compare = |picture: RgbImage, milliseconds: f64, covered: Option<f64>| {
        let psnr = psnr_db(&picture, &truth, None)?;
        let (psnr_field_db, ssim) = (psnr_db(&picture, &truth, Some(&mask)), ssim(&luma(&picture), &grey));
        Some(Outcome { psnr_db: psnr, psnr_field_db, ssim, milliseconds, covered, picture })
    };
    let mut outcomes = BTreeMap::new();
    for method in MethodKind::COMPARED {
        // The first call decodes the neighbours, the second one is timed.
        let answer =
            synthesizer.image_at(pose, &method).and_then(|_| timed(|| synthesizer.image_at(pose, &method)));
        match answer {
            Ok((reconstruction, milliseconds)) => {
                let covered = Some(reconstruction.covered());
                let outcome = compare(reconstruction.picture, milliseconds, covered);
                outcomes.extend(outcome.map(|outcome| (method.name(), outcome)));
            }
            Err(error) if error.is_refusal() => {}
            Err(error) => return Err(error.into()),
        }
    }
    let (drawn, milliseconds) = timed(|| renderer.draw(pose))?;
    outcomes.extend(compare(drawn, milliseconds, None).map(|outcome| (Renderer::NAME, outcome)));
    let distance_px = synthesizer.nearest(pose, 1).ok().map(|nearest| nearest[0].distance_px);
    Ok(ProbeResult { frame, distance_px, truth, outcomes })
}

/// Reason why a probe has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProbingError {
    /// A method failed.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// The field's model cannot be drawn from the pose.
    #[error(transparent)]
    Pose(#[from] RenderError),
}

fn timed<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<(T, f64), E> {
    let start = Instant::now();
    let result = work()?;
    Ok((result, 1e3 * start.elapsed().as_secs_f64()))
}

/// Returns the names of the methods, in the order in which they are shown.
pub fn names() -> impl Iterator<Item = &'static str> {
    MethodKind::COMPARED.into_iter().map(MethodKind::name).chain([Renderer::NAME])
}

impl MethodReport {
    /// Summarises the results of the method with this name.
    pub fn new(name: &str, results: &[ProbeResult]) -> Self {
        let outcomes: Vec<&Outcome> = results.iter().filter_map(|probe| probe.outcomes.get(name)).collect();
        let values =
            |of: fn(&Outcome) -> Option<f64>| outcomes.iter().filter_map(|outcome| of(outcome)).collect();
        let mean =
            |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        let mut times: Vec<f64> = values(|outcome| Some(outcome.milliseconds));
        times.sort_by(f64::total_cmp);
        Self {
            psnr_db: mean(values(|outcome| Some(outcome.psnr_db))),
            psnr_field_db: mean(values(|outcome| outcome.psnr_field_db)),
            ssim: mean(values(|outcome| outcome.ssim)),
            milliseconds: percentile(&times, 0.5),
            covered: mean(values(|outcome| outcome.covered)),
            answered: outcomes.len() as f64 / results.len().max(1) as f64,
        }
    }
}
