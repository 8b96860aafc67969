//! Nuisance parameters: nominal values are not exact, and are free within a standard deviation in every fit.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::{
    measurement::frame::FrameMeasurements,
    measurement::quantity::{ColorChannel, Quantity},
    measurement::scalar::Measurement,
    thresholds::{NuisanceThresholds, Thresholds},
};

/// A nominal value that may be a little off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Nuisance {
    /// All measurements of a quantity are off by the same.
    Offset {
        quantity: Quantity,
        /// Standard deviation, in the rows' unit.
        sigma: f64,
    },
    /// Carpet seen at a grazing angle reflects some of the light as it is, more so to the power given of one less the
    /// cosine of the angle of incidence: a linear value added to all colours alike.
    Sheen {
        power: i32,
        /// Standard deviation, linear, at grazing incidence.
        sigma: f64,
    },
    /// Broad lines look a little more or less blurred than thin ones: their profile is not quite the one that is fitted.
    Width {
        /// Standard deviation for each factor of e in width, pixels squared.
        sigma: f64,
    },
    /// A lens out of focus makes a disc of a point, motion a bar: where a Gaussian is fitted, as here, its variance comes out
    /// this part larger, wherever it is.
    Kernel {
        /// Standard deviation, a part of the variance.
        sigma: f64,
    },
    /// And by this part more for lines thinner than the blur.
    ThinKernel {
        /// Standard deviation, a part of the variance.
        sigma: f64,
    },
    /// A patch of carpet is brighter or darker than the rest, in all colours alike.
    Patch {
        /// Which square of the field, see [`cell_of`].
        cell: [i32; 2],
        /// Standard deviation of the logarithm.
        sigma: f64,
    },
}

const THRESHOLDS: NuisanceThresholds = Thresholds::DEFAULT.linear_model.nuisance;

/// Those that every recording has.
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

/// Which square of the field a point of it is in.
pub(crate) fn cell_of(ground: DVec2) -> [i32; 2] {
    let cell = (ground / THRESHOLDS.patch_m).floor();
    [cell.x as i32, cell.y as i32]
}

/// Nuisance parameters of these measurements.
pub(crate) fn nuisances(measurements: &[FrameMeasurements]) -> Vec<Nuisance> {
    let blocks = measurements.iter().flat_map(|frame| &frame.blocks);
    let cells: BTreeSet<[i32; 2]> = blocks.map(|block| cell_of(block.ground)).collect();
    let patches = cells.into_iter().map(|cell| Nuisance::Patch { cell, sigma: THRESHOLDS.patch_level });
    COMMON.into_iter().chain(patches).collect()
}

impl Nuisance {
    /// Change of a row that is expected to be `expected`, with one standard deviation.
    pub(crate) fn change(&self, row: &Measurement, expected: f64) -> f64 {
        match *self {
            Self::Offset { quantity, sigma } if row.quantity == quantity => sigma,
            Self::Width { sigma } if row.quantity == Quantity::LineBlur => sigma * row.half_width_px.ln(),
            Self::Kernel { sigma } if is_blur(row, expected) => sigma * expected,
            Self::ThinKernel { sigma } if is_blur(row, expected) => {
                sigma * expected * (-row.half_width_px / expected.sqrt()).exp()
            }
            Self::Patch { cell, sigma } if is_carpet(row) && cell_of(row.ground) == cell => sigma,
            Self::Sheen { power, sigma } if is_carpet(row) => {
                // Rows of photometry are logarithms.
                let change = sigma * (1.0 - row.cos_incidence).powi(power) * (-expected).exp();
                if change.is_finite() { change } else { 0.0 }
            }
            _ => 0.0,
        }
    }
}

fn is_blur(row: &Measurement, expected: f64) -> bool {
    row.quantity == Quantity::LineBlur && expected > 0.0
}

fn is_carpet(row: &Measurement) -> bool {
    row.quantity.is_carpet_level()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{carpet_measurement, measurement};

    fn sharpness(half_width_px: f64) -> Measurement {
        Measurement { half_width_px, ..measurement(Quantity::LineBlur) }
    }

    /// What all tolerances of a kernel's shape allow a variance to be off by, as a part of it.
    fn allowed(half_width_px: f64, variance_px2: f64) -> f64 {
        let squares = COMMON.iter().map(|tolerance| {
            let is_shape = matches!(tolerance, Nuisance::Kernel { .. } | Nuisance::ThinKernel { .. });
            let change = tolerance.change(&sharpness(half_width_px), variance_px2) / variance_px2;
            if is_shape { change * change } else { 0.0 }
        });
        squares.sum::<f64>().sqrt()
    }

    #[test]
    fn a_discs_fitted_variance_is_allowed_wherever_it_is_seen() {
        // Half widths in the disc's standard deviations, and by which part the fitted variance is larger: a bar blurred by
        // a uniform disc and a narrow Gaussian, fitted by least squares with a Gaussian.
        for (half_width, off) in
            [(0.3, 0.28), (0.6, 0.22), (1.0, 0.16), (1.5, 0.12), (3.0, 0.12), (5.0, 0.12)]
        {
            let allowed = allowed(half_width * 2.7, 2.7 * 2.7);
            assert!(off < 2.5 * allowed && off > 0.5 * allowed, "{half_width}: {allowed} for {off}");
        }
    }

    #[test]
    fn shapes_of_kernels_have_nothing_to_do_with_other_rows() {
        let line = measurement(Quantity::LineOffset);
        for tolerance in [
            Nuisance::Kernel { sigma: THRESHOLDS.blur_shape },
            Nuisance::ThinKernel { sigma: THRESHOLDS.thin_blur_shape },
        ] {
            assert_eq!(tolerance.change(&line, 1.0), 0.0);
        }
    }

    #[test]
    fn a_patch_changes_the_carpet_in_its_own_square_only() {
        let carpet = |ground: DVec2| carpet_measurement(DVec2::ZERO, ground);
        let patch = Nuisance::Patch { cell: cell_of(DVec2::new(0.7, -0.2)), sigma: THRESHOLDS.patch_level };
        assert_eq!(patch.change(&carpet(DVec2::new(0.9, -0.4)), -2.0), THRESHOLDS.patch_level);
        assert_eq!(patch.change(&carpet(DVec2::new(1.1, -0.4)), -2.0), 0.0);
    }

    #[test]
    fn sheen_is_nothing_from_straight_above_and_stronger_on_dark_colours() {
        let at = |cos_incidence: f64| Measurement {
            cos_incidence,
            ..measurement(Quantity::CarpetLevel(ColorChannel::Red))
        };
        let sheen = Nuisance::Sheen { power: 1, sigma: THRESHOLDS.sheen };
        assert_eq!(sheen.change(&at(1.0), -3.0), 0.0);
        assert!(sheen.change(&at(0.2), -3.0) > sheen.change(&at(0.2), -2.0));
        assert!(sheen.change(&at(0.2), -3.0) > sheen.change(&at(0.6), -3.0));
    }
}
