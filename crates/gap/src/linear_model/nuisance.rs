//! Nuisance parameters: errors of nominal values, which are free in every fit and have a normal prior.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::{
    measurement::{
        frame::FrameMeasurements,
        quantity::{ColorChannel, Quantity},
        scalar::Measurement,
    },
    thresholds::{NuisanceThresholds, Thresholds},
};

/// Error of a nominal value, with the standard deviation of its prior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Nuisance {
    /// Offset that all measurements of a quantity share.
    Offset {
        quantity: Quantity,
        /// Standard deviation, in the quantity's unit.
        sigma: f64,
    },
    /// Specular reflection of the carpet at grazing angles: a linear value `s (1 − cos θ)^power` added to all colours alike,
    /// where θ is the angle of incidence and `s` the parameter.
    Sheen {
        power: i32,
        /// Standard deviation, linear, at grazing incidence.
        sigma: f64,
    },
    /// Dependence of the blur on the width of a line, because the profile that is fitted is not exactly that of a line.
    Width {
        /// Standard deviation for a factor e in half width, pixels squared.
        sigma: f64,
    },
    /// Shape of the blur kernel: a Gaussian fitted to the disc of a defocused lens, or to the bar of a motion blur, has a
    /// larger variance by this fraction.
    Kernel {
        /// Standard deviation, as a fraction of the variance.
        sigma: f64,
    },
    /// Shape of the blur kernel on lines that are thinner than the blur, where the fraction is larger.
    ThinKernel {
        /// Standard deviation, as a fraction of the variance.
        sigma: f64,
    },
    /// Reflectance of a patch of carpet relative to the rest, in all colours alike.
    Patch {
        /// Square of the field, see [`patch_at`].
        cell: [i32; 2],
        /// Standard deviation of the logarithm.
        sigma: f64,
    },
}

const THRESHOLDS: NuisanceThresholds = Thresholds::DEFAULT.linear_model.nuisance;

/// Nuisance parameters of every recording.
const COMMON: [Nuisance; 13] = [
    offset(Quantity::LineLevel(ColorChannel::Red), THRESHOLDS.line_level),
    offset(Quantity::LineLevel(ColorChannel::Green), THRESHOLDS.line_level),
    offset(Quantity::LineLevel(ColorChannel::Blue), THRESHOLDS.line_level),
    offset(Quantity::CarpetLevel(ColorChannel::Red), THRESHOLDS.carpet_level),
    offset(Quantity::CarpetLevel(ColorChannel::Green), THRESHOLDS.carpet_level),
    offset(Quantity::CarpetLevel(ColorChannel::Blue), THRESHOLDS.carpet_level),
    offset(Quantity::LineBlur, THRESHOLDS.blur_px2),
    offset(Quantity::NoiseVariance, THRESHOLDS.noise_variance),
    Nuisance::Width { sigma: THRESHOLDS.blur_by_width_px2 },
    Nuisance::Kernel { sigma: THRESHOLDS.blur_shape },
    Nuisance::ThinKernel { sigma: THRESHOLDS.thin_blur_shape },
    Nuisance::Sheen { power: 1, sigma: THRESHOLDS.sheen },
    Nuisance::Sheen { power: 2, sigma: THRESHOLDS.sheen },
];

const fn offset(quantity: Quantity, sigma: f64) -> Nuisance {
    Nuisance::Offset { quantity, sigma }
}

/// Returns the square of the field that contains a point on the ground (world axes, metres).
pub(crate) fn patch_at(ground: DVec2) -> [i32; 2] {
    let cell = (ground / THRESHOLDS.patch_m).floor();
    [cell.x as i32, cell.y as i32]
}

/// Returns the nuisance parameters of a recording: those that every recording has, and a patch for every square in which
/// carpet was measured.
pub(crate) fn nuisances(measurements: &[FrameMeasurements]) -> Vec<Nuisance> {
    let blocks = measurements.iter().flat_map(|frame| &frame.blocks);
    let cells: BTreeSet<[i32; 2]> = blocks.map(|block| patch_at(block.ground)).collect();
    let patches = cells.into_iter().map(|cell| Nuisance::Patch { cell, sigma: THRESHOLDS.patch_level });
    COMMON.into_iter().chain(patches).collect()
}

impl Nuisance {
    /// Returns the derivative of a measurement's prediction by this parameter in units of its standard deviation.
    pub(crate) fn derivative(&self, measurement: &Measurement, predicted: f64) -> f64 {
        match *self {
            Self::Offset { quantity, sigma } if measurement.quantity == quantity => sigma,
            Self::Width { sigma } if measurement.quantity == Quantity::LineBlur => {
                sigma * measurement.half_width_px.ln()
            }
            Self::Kernel { sigma } if is_blur(measurement, predicted) => sigma * predicted,
            Self::ThinKernel { sigma } if is_blur(measurement, predicted) => {
                sigma * predicted * (-measurement.half_width_px / predicted.sqrt()).exp()
            }
            Self::Patch { cell, sigma } if is_carpet(measurement) && patch_at(measurement.ground) == cell => {
                sigma
            }
            Self::Sheen { power, sigma } if is_carpet(measurement) => {
                // Levels are logarithms of linear values: d ln(v) = dv / v.
                let derivative = sigma * (1.0 - measurement.cos_incidence).powi(power) * (-predicted).exp();
                if derivative.is_finite() { derivative } else { 0.0 }
            }
            _ => 0.0,
        }
    }
}

fn is_blur(measurement: &Measurement, predicted: f64) -> bool {
    measurement.quantity == Quantity::LineBlur && predicted > 0.0
}

fn is_carpet(measurement: &Measurement) -> bool {
    measurement.quantity.is_carpet_level()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{carpet_measurement, measurement};

    fn line_blur(half_width_px: f64) -> Measurement {
        Measurement { half_width_px, ..measurement(Quantity::LineBlur) }
    }

    /// Returns the standard deviation of the variance by the priors of the kernel's shape, as a fraction of the variance.
    fn prior_sigma(half_width_px: f64, variance_px2: f64) -> f64 {
        let squares = COMMON.iter().map(|nuisance| {
            let is_shape = matches!(nuisance, Nuisance::Kernel { .. } | Nuisance::ThinKernel { .. });
            let relative = nuisance.derivative(&line_blur(half_width_px), variance_px2) / variance_px2;
            if is_shape { relative * relative } else { 0.0 }
        });
        squares.sum::<f64>().sqrt()
    }

    #[test]
    fn the_prior_of_the_kernels_shape_covers_a_disc_at_every_line_width() {
        // Half widths in the disc's standard deviations, and the relative error of the fitted variance: a bar blurred by a
        // uniform disc and a narrow Gaussian, fitted by least squares with a Gaussian.
        for (half_width, error) in
            [(0.3, 0.28), (0.6, 0.22), (1.0, 0.16), (1.5, 0.12), (3.0, 0.12), (5.0, 0.12)]
        {
            let sigma = prior_sigma(half_width * 2.7, 2.7 * 2.7);
            assert!(error < 2.5 * sigma && error > 0.5 * sigma, "{half_width}: {sigma} for {error}");
        }
    }

    #[test]
    fn the_kernels_shape_does_not_change_line_offsets() {
        let line = measurement(Quantity::LineOffset);
        for nuisance in [
            Nuisance::Kernel { sigma: THRESHOLDS.blur_shape },
            Nuisance::ThinKernel { sigma: THRESHOLDS.thin_blur_shape },
        ] {
            assert_eq!(nuisance.derivative(&line, 1.0), 0.0);
        }
    }

    #[test]
    fn a_patch_changes_only_the_carpet_in_its_own_square() {
        let carpet = |ground: DVec2| carpet_measurement(DVec2::ZERO, ground);
        let patch = Nuisance::Patch { cell: patch_at(DVec2::new(0.7, -0.2)), sigma: THRESHOLDS.patch_level };
        assert_eq!(patch.derivative(&carpet(DVec2::new(0.9, -0.4)), -2.0), THRESHOLDS.patch_level);
        assert_eq!(patch.derivative(&carpet(DVec2::new(1.1, -0.4)), -2.0), 0.0);
    }

    #[test]
    fn sheen_vanishes_from_straight_above_and_is_stronger_on_dark_colours() {
        let at = |cos_incidence: f64| Measurement {
            cos_incidence,
            ..measurement(Quantity::CarpetLevel(ColorChannel::Red))
        };
        let sheen = Nuisance::Sheen { power: 1, sigma: THRESHOLDS.sheen };
        assert_eq!(sheen.derivative(&at(1.0), -3.0), 0.0);
        assert!(sheen.derivative(&at(0.2), -3.0) > sheen.derivative(&at(0.2), -2.0));
        assert!(sheen.derivative(&at(0.2), -3.0) > sheen.derivative(&at(0.6), -3.0));
    }
}
