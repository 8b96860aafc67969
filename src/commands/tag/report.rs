//! Report of `tag`: one line per picture, and a summary for people and for programs.

use std::{fmt::Write, path::Path};

use serde::Serialize;

use reality_sim::{
    CameraPose, LocalizedFrame, LocalizerConfig, ObservationKind, Sequence,
    calibration::{Assessment, Shift},
    evaluation::{ErrorStatistics, PoseError, percentile},
    filter::{Estimator, Resampling},
    quality::{LineAgreement, RecordingQuality},
    sequence::counted,
    tagging::TaggedPose,
};

use super::options::TagArgs;
use crate::commands::{device::Device, output::aligned, parameter::of_parameter};

/// Standard deviations by which a recording must contradict the calibration for that to be said.
const CONTRADICTED: f64 = 4.0;

/// Formats one line per picture; unknown values are left empty.
pub fn details_csv(
    sequence: &Sequence,
    frames: &[LocalizedFrame],
    results: &[TaggedPose],
    lines: &[LineAgreement],
) -> String {
    const DEGREES_OF_FREEDOM: [&str; 6] = ["x_m", "y_m", "yaw_rad", "height_m", "pitch_rad", "roll_rad"];
    let mut csv = String::from("timestamp_s");
    let sigmas = DEGREES_OF_FREEDOM.map(|name| format!("sigma_{name}"));
    for name in DEGREES_OF_FREEDOM.into_iter().chain(sigmas.iter().map(String::as_str)) {
        csv.push(',');
        csv.push_str(name);
    }
    csv.push_str(
        ",effective_sample_size,particles,line_fraction,explained_fraction,sure,mirror_probability,searched,error_m,error_yaw_rad,lines_within_5px,lines_within_10px,settled,lines_seen,lines_unseen,lines_unexplained\n",
    );
    for (index, (frame, result)) in frames.iter().zip(results).enumerate() {
        let pose = result.pose;
        // Writing into a string cannot fail.
        let _ = write!(csv, "{}", sequence.frames[index].timestamp_s);
        for value in [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m, pose.pitch_rad, pose.roll_rad] {
            let _ = write!(csv, ",{value}");
        }
        for axis in 0..DEGREES_OF_FREEDOM.len() {
            csv.push(',');
            if let Some(sigmas) = result.sigmas() {
                let _ = write!(csv, "{}", sigmas[axis]);
            }
        }
        let _ = write!(
            csv,
            ",{},{},{},{},{},{},{}",
            frame.filter.effective_sample_size,
            frame.filter.particles,
            frame.line_fraction,
            frame.explained_fraction,
            frame.sure,
            frame.mirrored_probability,
            frame.searched
        );
        let _ = match sequence.frames[index].reference_pose.map(|truth| PoseError::new(pose, truth)) {
            Some(error) => write!(csv, ",{},{}", error.distance_m, error.yaw_rad),
            None => write!(csv, ",,"),
        };
        add_lines(&mut csv, frame, lines.get(index).copied().unwrap_or_default());
    }
    csv
}

/// Adds the agreement of one picture's lines with its pose, and ends the line.
fn add_lines(csv: &mut String, frame: &LocalizedFrame, lines: LineAgreement) {
    for fraction in [lines.fraction_within_5px(), lines.fraction_within_10px()] {
        csv.push(',');
        if let Some(fraction) = fraction {
            let _ = write!(csv, "{fraction}");
        }
    }
    let LineAgreement { seen, unseen, unexplained, .. } = lines;
    let _ = writeln!(csv, ",{},{seen},{unseen},{unexplained}", frame.settled);
}

/// Report that `--json` prints.
#[derive(Debug, Serialize)]
pub struct Report {
    sequence: String,
    frames: usize,
    observation: ObservationKind,
    backend: &'static str,
    /// Name of the graphics adapter.
    adapter: Option<String>,
    /// Reason why the device is not the graphics card.
    #[serde(skip_serializing_if = "Option::is_none")]
    backend_reason: Option<String>,
    particles: usize,
    iterations: u32,
    resampling: Resampling,
    estimator: Estimator,
    adaptive: bool,
    seed: u64,
    smoothed: bool,
    /// Median time per frame; decoding, drawing and writing are excluded.
    seconds_per_frame: f64,
    sure_frames: usize,
    searched_frames: usize,
    /// Agreement of poses and pictures as papers on broadcast cameras report it: JaC@5, JaC@10 and completeness.
    lines_within_5px: f64,
    lines_within_10px: f64,
    completeness: f64,
    /// The same in a sentence that says whether it is good.
    lines_verdict: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<ErrorStatistics>,
    out: Option<String>,
    details: Option<String>,
    overlay: Option<String>,
    /// What of the model was used.
    #[serde(skip_serializing_if = "Option::is_none")]
    corrections: Option<String>,
    /// By how much the recording contradicts the calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    calibration: Option<String>,
}

impl Report {
    pub fn new(
        args: &TagArgs,
        sequence: &Sequence,
        config: &LocalizerConfig,
        device: &Device,
        frames: &[LocalizedFrame],
        poses: &[CameraPose],
    ) -> Self {
        let mut seconds: Vec<f64> = frames.iter().map(|frame| frame.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        Self {
            sequence: shown(&args.sequence),
            frames: frames.len(),
            observation: config.observation.kind,
            backend: device.name,
            adapter: device.adapter.clone(),
            backend_reason: device.reason.clone(),
            particles: config.filter.particles,
            iterations: config.filter.iterations,
            resampling: config.filter.resampling,
            estimator: config.filter.estimator,
            adaptive: config.filter.adaptive.is_some(),
            seed: config.filter.seed,
            smoothed: args.smooth,
            seconds_per_frame: percentile(&seconds, 0.5).unwrap_or(0.0),
            sure_frames: frames.iter().filter(|frame| frame.sure).count(),
            searched_frames: frames.iter().filter(|frame| frame.searched).count(),
            lines_within_5px: 0.0,
            lines_within_10px: 0.0,
            completeness: 0.0,
            lines_verdict: String::new(),
            error: ErrorStatistics::of(sequence, poses),
            out: args.out.as_deref().map(shown),
            details: args.details.as_deref().map(shown),
            overlay: args.overlay.as_deref().map(shown),
            corrections: None,
            calibration: None,
        }
    }

    /// Adds what of the model was used.
    pub fn with_corrections(self, corrections: Option<String>) -> Self {
        Self { corrections, ..self }
    }

    /// Adds how well poses and pictures agree.
    pub fn with_lines(self, frames: &[LocalizedFrame], lines: &[LineAgreement]) -> Self {
        let settled = frames.iter().map(|frame| frame.settled);
        let quality = RecordingQuality::new(lines.iter().copied().zip(settled));
        let RecordingQuality { lines_within_5px, lines_within_10px, completeness, .. } = quality;
        let lines_verdict = quality.sentence();
        Self { lines_within_5px, lines_within_10px, completeness, lines_verdict, ..self }
    }

    /// Adds by how much the recording contradicts the calibration, if it does.
    pub fn with_calibration(self, sequence: &Sequence, assessed: Option<&Assessment>) -> Self {
        let distortion = &sequence.setup.camera.distortion;
        let is_clear = |shift: &&Shift| shift.by.abs() > CONTRADICTED * shift.sigma;
        let shifts: Vec<String> = assessed
            .iter()
            .flat_map(|assessed| assessed.shifts.iter().filter(is_clear))
            .map(|shift| of_parameter(shift.parameter.name(distortion), shift.by, shift.sigma))
            .collect();
        let calibration = (!shifts.is_empty()).then(|| {
            format!(
                "the lines fit a camera better that differs by {}: run `reality-sim calibrate`",
                shifts.join(", ")
            )
        });
        Self { calibration, ..self }
    }

    fn backend_text(&self) -> String {
        let why = self.adapter.as_ref().map(|name| format!(", {name}"));
        let why = why.or_else(|| self.backend_reason.as_ref().map(|reason| format!(": {reason}")));
        format!("{}{}", self.backend, why.unwrap_or_default())
    }

    /// Formats the report for people.
    pub fn text(&self, name: &str) -> String {
        let mut lines = vec![
            ("sequence", format!("{name}, {}", counted(self.frames, "frame"))),
            (
                "model",
                format!(
                    "{}, {}, {}",
                    self.observation,
                    counted(self.particles, "particle"),
                    counted(self.iterations as usize, "iteration")
                ),
            ),
            ("backend", self.backend_text()),
            ("time", format!("{:.1} ms a frame (median)", 1e3 * self.seconds_per_frame)),
            ("sure", format!("{}; {} searched", counted(self.sure_frames, "frame"), self.searched_frames)),
        ];
        lines.push(("lines", self.lines_verdict.clone()));
        lines.extend(self.corrections.iter().map(|corrections| ("camera", corrections.clone())));
        lines.extend(self.calibration.iter().map(|words| ("calibration", words.clone())));
        if let Some(error) = &self.error {
            let cm = |metres: f64| format!("{:.2} cm", 100.0 * metres);
            let [mean, median, p95, max] = [error.mean_m, error.median_m, error.p95_m, error.max_m].map(cm);
            lines.push(("error", format!("mean {mean}, median {median}, 95 % below {p95}, largest {max}")));
            let yaw = error.mean_yaw_rad.to_degrees();
            lines.push((
                "",
                format!("yaw {yaw:.2}° in the mean; {} lost", counted(error.lost_frames, "frame")),
            ));
        }
        for (name, path) in [("poses", &self.out), ("details", &self.details), ("overlay", &self.overlay)] {
            lines.extend(path.iter().map(|path| (name, path.clone())));
        }
        aligned(&lines)
    }
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}
