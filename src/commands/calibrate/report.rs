//! Report of `calibrate`, for people and for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use reality_sim::{
    calibration::{Advice, Calibration, Parameter},
    sequence::counted,
};

use super::{options::CalibrateArgs, start::Start};
use crate::commands::{output::aligned, parameter::of_parameter};

/// Standard deviations above which the place and the heading of the camera on the body count as undetermined, metres and radians: what
/// a person measures with a rule.
const LARGEST_OFFSET_SIGMA_M: f64 = 0.02;
const LARGEST_HEADING_SIGMA_RAD: f64 = 0.02;

/// Uncertainty of the projection from which more pictures are advised, pixels.
const WORTH_ADVICE_PX: f64 = 0.1;

/// Value of a parameter with its standard deviation, in the parameter's own unit.
#[derive(Debug, Clone, Copy, Serialize)]
struct Estimate {
    value: f64,
    sigma: f64,
}

/// Report that `--json` prints.
#[derive(Debug, Serialize)]
pub struct Report {
    sequence: String,
    start: String,
    model: &'static str,
    pictures: usize,
    pictures_used: usize,
    parameters: BTreeMap<&'static str, Estimate>,
    /// Parameters that the pictures do not determine.
    undetermined: Vec<&'static str>,
    /// Pairs that the pictures hardly tell apart, with the correlation of their errors.
    confusable: Vec<(&'static str, &'static str, f64)>,
    reprojection_px: f64,
    held_out_px: f64,
    /// Root mean square of the projection's uncertainty where lines were measured, pixels.
    uncertainty_px: f64,
    /// Part of the picture in which no line was measured.
    unseen_fraction: f64,
    /// Distortion terms that were compared, and how well each predicts pictures that it was not fitted to.
    compared: Vec<Compared>,
    /// Noise from picture to picture.
    height_sigma_m: f64,
    pitch_sigma_rad: f64,
    roll_sigma_rad: f64,
    /// What would help most.
    advice: Vec<String>,
    out: String,
}

/// Choice of the parameters of the lens.
#[derive(Debug, Serialize)]
struct Compared {
    distortion: Vec<&'static str>,
    held_out_px: f64,
    chosen: bool,
}

impl Report {
    pub fn new(args: &CalibrateArgs, start: &Start, calibration: &Calibration) -> Self {
        let distortion = &calibration.camera.distortion;
        let uncertainties: Vec<f64> = calibration.uncertainty.where_measured().collect();
        let mean_square =
            uncertainties.iter().map(|sigma| sigma * sigma).sum::<f64>() / uncertainties.len().max(1) as f64;
        let confusable = calibration.confusable().into_iter().map(|pair| {
            let [first, second] = pair.parameters.map(|parameter| parameter.name(distortion));
            (first, second, pair.correlation)
        });
        Self {
            sequence: args.sequence.display().to_string(),
            start: start.words.clone(),
            model: distortion.colmap_name(),
            pictures: calibration.pictures,
            pictures_used: calibration.poses.len(),
            parameters: estimates(calibration),
            undetermined: undetermined(calibration),
            confusable: confusable.collect(),
            reprojection_px: calibration.reprojection_px,
            held_out_px: calibration.held_out_px,
            uncertainty_px: mean_square.sqrt(),
            unseen_fraction: calibration.uncertainty.unseen_fraction(),
            compared: compared(calibration),
            height_sigma_m: calibration.noise.height_m,
            pitch_sigma_rad: calibration.noise.pitch_rad,
            roll_sigma_rad: calibration.noise.roll_rad,
            advice: advice(calibration),
            out: args.out.display().to_string(),
        }
    }

    /// Formats the report for people.
    pub fn text(&self, calibration: &Calibration) -> String {
        let used = counted(self.pictures, "picture");
        let mut lines = vec![
            ("sequence", format!("{}, {} of {used} used", self.sequence, self.pictures_used)),
            ("start", self.start.clone()),
            ("lens", format!("{}, {}", self.model, self.words(Parameter::is_of_lens, calibration))),
            ("mount", self.words(|parameter| !parameter.is_of_lens(), calibration)),
        ];
        lines.extend(self.body_words().map(|words| ("on body", words)));
        lines.push((
            "lines",
            format!(
                "{:.2} px off in the pictures of the fit, {:.2} px in pictures that were left out of it",
                self.reprojection_px, self.held_out_px
            ),
        ));
        lines.push((
            "certainty",
            format!(
                "the projection is known to {:.2} px where lines were seen, which is {:.0} % of the picture",
                self.uncertainty_px,
                100.0 * (1.0 - self.unseen_fraction)
            ),
        ));
        lines.push(("not told", self.not_told()));
        lines.extend(self.advice.iter().map(|advice| ("to do", advice.clone())));
        lines.push(("camera", self.out.clone()));
        aligned(&lines)
    }

    fn words(&self, is_wanted: fn(Parameter) -> bool, calibration: &Calibration) -> String {
        let names = calibration.parameters.iter().filter(|parameter| is_wanted(**parameter));
        let words = names.filter_map(|parameter| {
            let name = parameter.name(&calibration.camera.distortion);
            self.parameters.get(name).map(|estimate| estimate.words(name))
        });
        words.collect::<Vec<_>>().join(", ")
    }

    fn body_words(&self) -> Option<String> {
        let names = ["forward_m", "left_m", "heading_rad"];
        let words: Option<Vec<String>> =
            names.iter().map(|name| Some(self.parameters.get(name)?.words(name))).collect();
        words.map(|words| format!("{} from the point that the odometry follows", words.join(", ")))
    }

    fn not_told(&self) -> String {
        let scale = "the scale, which is that of the field's file: lines 1 % longer make height and distances 1 % larger";
        let others: Vec<&str> =
            self.undetermined.iter().copied().filter(|name| *name != FIELD_SCALE).collect();
        let pairs = self.confusable.iter().map(|(first, second, _)| format!("{first} against {second}"));
        let all: Vec<String> = std::iter::once(scale.to_owned())
            .chain(others.iter().map(|&name| name.to_owned()))
            .chain(pairs)
            .collect();
        all.join("; ")
    }
}

/// Name of what no picture tells.
const FIELD_SCALE: &str = "field_scale";

impl Estimate {
    fn words(&self, name: &str) -> String {
        of_parameter(name, self.value, self.sigma)
    }
}

fn estimates(calibration: &Calibration) -> BTreeMap<&'static str, Estimate> {
    let distortion = &calibration.camera.distortion;
    let sigmas = calibration.sigmas();
    let fitted = calibration.parameters.iter().zip(&calibration.values).zip(sigmas);
    let mut estimates: BTreeMap<&'static str, Estimate> = fitted
        .map(|((parameter, &value), sigma)| (parameter.name(distortion), Estimate { value, sigma }))
        .collect();
    // Terms that were not needed are zero.
    for (&name, value) in distortion.names().iter().zip(distortion.parameters()) {
        estimates.entry(name).or_insert(Estimate { value, sigma: 0.0 });
    }
    if let Some(&fx) = estimates.get("fx") {
        let ratio = calibration.camera.fy / calibration.camera.fx;
        let of_ratio = estimates.get("aspect_ratio").map_or(0.0, |ratio| ratio.sigma);
        let sigma = (ratio * fx.sigma).hypot(calibration.camera.fx * of_ratio);
        estimates.insert("fy", Estimate { value: calibration.camera.fy, sigma });
    }
    if let Some(offset) = &calibration.body_offset {
        for (axis, name) in ["forward_m", "left_m", "heading_rad"].into_iter().enumerate() {
            let sigma = offset.covariance[(axis, axis)].sqrt();
            estimates.insert(name, Estimate { value: offset.value[axis], sigma });
        }
    }
    estimates
}

fn undetermined(calibration: &Calibration) -> Vec<&'static str> {
    let distortion = &calibration.camera.distortion;
    let mut names: Vec<&'static str> =
        calibration.undetermined().iter().map(|parameter| parameter.name(distortion)).collect();
    let offset = ["forward_m", "left_m", "heading_rad"].into_iter().enumerate();
    let is_unknown = |axis: usize| {
        let largest = if axis < 2 { LARGEST_OFFSET_SIGMA_M } else { LARGEST_HEADING_SIGMA_RAD };
        calibration.body_offset.is_none_or(|offset| offset.covariance[(axis, axis)].sqrt() > largest)
    };
    names.extend(offset.filter(|(axis, _)| is_unknown(*axis)).map(|(_, name)| name));
    names.push(FIELD_SCALE);
    names
}

fn compared(calibration: &Calibration) -> Vec<Compared> {
    let distortion = &calibration.camera.distortion;
    let is_of_distortion =
        |parameter: &&Parameter| matches!(parameter, Parameter::Distortion(_) | Parameter::AspectRatio);
    let choices = calibration.choices.iter().enumerate();
    choices
        .map(|(index, choice)| Compared {
            distortion: choice
                .parameters
                .iter()
                .filter(is_of_distortion)
                .map(|parameter| parameter.name(distortion))
                .collect(),
            held_out_px: choice.held_out_px,
            chosen: index == calibration.chosen,
        })
        .collect()
}

fn advice(calibration: &Calibration) -> Vec<String> {
    let is_worth_it = |advice: &&Advice| advice.rms_px[0] > WORTH_ADVICE_PX;
    calibration.advice.iter().filter(is_worth_it).map(advice_words).collect()
}

fn advice_words(advice: &Advice) -> String {
    let pose = advice.pose;
    format!(
        "add about {} from near x {:.0} m, y {:.0} m (or the place turned by 180°), heading {:.0}°, looking {:.0}° down: the projection is \
         then known to {:.2} px over the whole picture instead of {:.2} px",
        counted(advice.pictures as usize, "picture"),
        pose.x_m,
        pose.y_m,
        pose.yaw_rad.to_degrees(),
        pose.pitch_rad.to_degrees(),
        advice.rms_px[1],
        advice.rms_px[0]
    )
}
