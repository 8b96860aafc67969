//! Patterns of residuals: in the picture, on the field, over time, or by the speed of the picture.
//!
//! Residuals are binned by where and when they were measured. A pattern is significant if the bins' means in some parts of the
//! recording predict the residuals in the others (cross-validation), or if the mean of a single bin is significant. Light that
//! the reflectance of places has taken up is found by [`crate::inference::light_pattern`], and reported where no bin tells of it.

mod bins;
mod locus;
mod source;

use std::collections::BTreeMap;

use self::{
    bins::Binned,
    locus::{Cell, Locus, picture_cell},
    source::SOURCES,
};
use reality_sim_core::statistics::median;

use crate::{
    diagnostics::detector::{Detector, FitResiduals, FrameResiduals, SIGNIFICANCE},
    diagnostics::finding::{Finding, PatternCell},
    inference::gain::Gain,
    inference::light_pattern::{LightPattern, Strongest},
    inference::model_error::ModelError,
    measurement::quantity::{Channel, Quantity},
    thresholds::{PatternThresholds, Thresholds},
};

const THRESHOLDS: PatternThresholds = Thresholds::DEFAULT.diagnostics.patterns;

/// Detector of patterns of residuals.
pub(crate) struct ResidualPatterns;

impl Detector for ResidualPatterns {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        let found = patterns(&fit.frames, fit.sigmas, fit.model_error, fit.start_s);
        let is_told = found.iter().any(|pattern| pattern.channel == Channel::Photometry);
        let light = fit.light.filter(|_| !is_told).and_then(|light| light_finding(light, fit));
        found.iter().map(Pattern::finding).chain(light).collect()
    }
}

/// Pattern that no effect of the library explains.
#[derive(Debug, Clone, PartialEq)]
struct Pattern {
    channel: Channel,
    locus: Locus,
    /// Gain in log-likelihood of frames that are predicted by the means of others.
    gain: Gain,
    /// Root mean square of the largest means, in the channel's unit.
    size: f64,
    /// Cell with the largest significant mean, or with the smallest p-value if none is significant.
    strongest: Cell,
    /// P-value of that cell's mean, corrected for all cells of all patterns.
    p_value: f64,
    /// Length of that cell's mean, in the channel's unit.
    strongest_size: f64,
    /// Size below which the pattern does not matter, in the channel's unit.
    material: f64,
}

impl Pattern {
    /// Summarises binned residuals with standard deviation `sigma`; `tested` is the number of cells of all patterns, for which
    /// p-values are corrected. None if no cell is seen often enough.
    fn new(binned: &Binned, sigma: f64, material: f64, tested: f64) -> Option<Self> {
        let cells = binned.p_values().map(|(cell, p_value)| {
            let p_value = (tested * p_value).min(1.0);
            let rank = if p_value < SIGNIFICANCE { 1.0 + binned.mean(cell) } else { 1.0 - p_value };
            (rank, p_value, cell)
        });
        let (_, p_value, strongest) = cells.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Self {
            channel: binned.source.channel,
            locus: binned.locus,
            gain: binned.held_out_gain(),
            size: sigma * binned.largest(),
            strongest,
            p_value,
            material,
            strongest_size: sigma * binned.mean(strongest),
        })
    }

    /// Whether the means of all bins together are significant and large enough to matter.
    fn is_overall_significant(&self) -> bool {
        self.gain.score() > THRESHOLDS.least_score && self.size > self.material
    }

    fn is_significant(&self) -> bool {
        let in_one_cell = self.p_value < SIGNIFICANCE && self.strongest_size > self.material;
        self.is_overall_significant() || in_one_cell
    }

    /// Returns the larger one of the overall size and the strongest cell's, as far as each is significant.
    fn reported_size(&self) -> f64 {
        if self.p_value < SIGNIFICANCE {
            self.strongest_size.max(if self.is_overall_significant() { self.size } else { 0.0 })
        } else {
            self.size
        }
    }

    fn finding(&self) -> Finding {
        Finding::Pattern {
            channel: self.channel,
            strongest: self.locus.pattern_cell(self.strongest),
            size: self.reported_size(),
            p_value: self.p_value,
        }
    }
}

/// Returns the finding of a pattern of light that is significant and large enough to matter.
fn light_finding(light: LightPattern, fit: &FitResiduals<'_>) -> Option<Finding> {
    let material = THRESHOLDS.material_photometry + fit.model_error.most_off(Channel::Photometry);
    let camera = &fit.recording.sequence.setup.camera;
    let strongest = match light.strongest {
        Strongest::Picture(pixel) => {
            Locus::Picture.pattern_cell(picture_cell(pixel, [camera.width, camera.height]))
        }
        Strongest::Field(place) => PatternCell::Field { x_m: place.x, y_m: place.y },
        Strongest::Time(after_s) => PatternCell::Time { after_s },
    };
    let LightPattern { size, p_value, .. } = light;
    (p_value < SIGNIFICANCE && size > material).then_some(Finding::Pattern {
        channel: Channel::Photometry,
        strongest,
        size,
        p_value,
    })
}

/// Returns the size below which a pattern does not matter, in the channel's unit. `blur_px2` is the median variance of the
/// blur.
fn material(channel: Channel, blur_px2: f64) -> f64 {
    match channel {
        Channel::Geometry => THRESHOLDS.material_geometry_px,
        Channel::Photometry => THRESHOLDS.material_photometry,
        Channel::Sharpness => {
            THRESHOLDS.material_sharpness_px2.max(THRESHOLDS.material_sharpness_ratio * blur_px2)
        }
        Channel::Color => THRESHOLDS.material_color_px + THRESHOLDS.material_color_px_per_px2 * blur_px2,
        Channel::Noise => THRESHOLDS.material_noise,
        Channel::Motion => f64::INFINITY,
    }
}

/// Returns all significant patterns of a recording that starts at `start_s`.
fn patterns(
    frames: &[FrameResiduals<'_>],
    sigmas: &BTreeMap<Quantity, f64>,
    model_error: &ModelError,
    start_s: f64,
) -> Vec<Pattern> {
    let blur_px2 = median_measurement(frames, Channel::Sharpness);
    let material = |channel: Channel| material(channel, blur_px2) + model_error.most_off(channel);
    let pairs =
        SOURCES.into_iter().flat_map(|source| source.loci().iter().map(move |&locus| (source, locus)));
    let binned: Vec<Binned> = pairs.map(|pair| Binned::new(frames, sigmas, pair, start_s)).collect();
    let tested = binned.iter().map(Binned::tested).sum::<usize>() as f64;
    let found = binned.iter().filter_map(|binned| {
        let source = binned.source;
        Pattern::new(binned, source.usual_sigma(frames, sigmas), material(source.channel), tested)
    });
    found.filter(Pattern::is_significant).collect()
}

/// Returns the median of a channel's measurements.
fn median_measurement(frames: &[FrameResiduals<'_>], channel: Channel) -> f64 {
    let measurements = frames.iter().flat_map(|frame| frame.measurements);
    let values = measurements.filter(|one| one.quantity.channel() == channel).map(|one| one.measured);
    median(values.filter(|value| value.is_finite()).collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests;
