//! Residuals that keep a pattern: in the picture, on the field, over time, or by the speed of the picture.
//!
//! Residuals are binned by where and when they were measured. Bins that keep their mean from one part of the recording
//! to the others are no chance: as for effects, frames are judged by the means of the other parts.

mod bins;
mod locus;
mod source;

use std::collections::BTreeMap;

use self::{
    bins::Binned,
    locus::{Cell, Locus},
    source::SOURCES,
};
use reality_sim_core::statistics::median;

use crate::{
    diagnostics::detector::{Detector, FitResiduals, FrameResiduals, SIGNIFICANCE},
    diagnostics::finding::Finding,
    inference::gain::Gain,
    inference::model_error::ModelError,
    measurement::quantity::{Channel, Quantity},
    thresholds::{PatternThresholds, Thresholds},
};

const THRESHOLDS: PatternThresholds = Thresholds::DEFAULT.diagnostics.patterns;

/// Finds patterns of residuals.
pub(crate) struct ResidualPatterns;

impl Detector for ResidualPatterns {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        let found = patterns(&fit.frames, fit.sigmas, fit.model_error, fit.start_s);
        found.iter().map(Pattern::finding).collect()
    }
}

/// A pattern that no effect of the library explains.
#[derive(Debug, Clone, PartialEq)]
struct Pattern {
    channel: Channel,
    locus: Locus,
    /// Gain of frames by the means of others.
    gain: Gain,
    /// Root mean square of the pattern where it is strongest, in the channel's unit.
    size: f64,
    /// Cell whose mean is least likely chance.
    strongest: Cell,
    /// How unlikely that is, corrected for all cells of all patterns.
    p_value: f64,
    /// Mean there.
    strongest_size: f64,
    /// Size below which it does not matter.
    material: f64,
}

impl Pattern {
    /// `tested` cells in all are what p-values are corrected for.
    fn of(binned: &Binned, sigma: f64, material: f64, tested: f64) -> Option<Self> {
        // Of the cells that are no chance the one with the largest mean; where all may be chance, the least likely.
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

    fn is_all_over(&self) -> bool {
        self.gain.score() > THRESHOLDS.least_score && self.size > self.material
    }

    fn is_significant(&self) -> bool {
        let in_one_cell = self.p_value < SIGNIFICANCE && self.strongest_size > self.material;
        self.is_all_over() || in_one_cell
    }

    /// The larger of its size all over and in one cell, as far as each is significant.
    fn reported_size(&self) -> f64 {
        if self.p_value < SIGNIFICANCE {
            self.strongest_size.max(if self.is_all_over() { self.size } else { 0.0 })
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

/// Sizes below which a pattern does not matter, in the channel's unit; `blur_px2` is the usual variance of
/// the blur.
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

/// Every significant pattern of a recording that starts at `start_s`.
fn patterns(
    frames: &[FrameResiduals<'_>],
    sigmas: &BTreeMap<Quantity, f64>,
    model_error: &ModelError,
    start_s: f64,
) -> Vec<Pattern> {
    let blur_px2 = middle(frames, Channel::Sharpness);
    let material = |channel: Channel| material(channel, blur_px2) + model_error.most_off(channel);
    let pairs =
        SOURCES.into_iter().flat_map(|source| source.loci().iter().map(move |&locus| (source, locus)));
    let binned: Vec<Binned> = pairs.map(|pair| Binned::new(frames, sigmas, pair, start_s)).collect();
    let tested = binned.iter().map(Binned::tested).sum::<usize>() as f64;
    let found = binned.iter().filter_map(|binned| {
        let source = binned.source;
        Pattern::of(binned, source.usual_sigma(frames, sigmas), material(source.channel), tested)
    });
    found.filter(Pattern::is_significant).collect()
}

/// The median of a channel's measurements.
fn middle(frames: &[FrameResiduals<'_>], channel: Channel) -> f64 {
    let rows =
        frames.iter().flat_map(|frame| frame.measurements).filter(|row| row.quantity.channel() == channel);
    let values: Vec<f64> = rows.map(|row| row.measured).filter(|value| value.is_finite()).collect();
    median(values)
}

#[cfg(test)]
mod tests;
