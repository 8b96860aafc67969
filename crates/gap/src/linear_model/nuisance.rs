//! Nuisance parameters: errors of nominal values, which are free in every fit and have a normal prior.

use reality_sim_core::sequence::Photometry;
use reality_sim_sensor::Surface;

use crate::{
    linear_model::mean_reflectance::MeanReflectance,
    linear_model::texture::{self, CarpetTexture},
    measurement::{
        luma::LUMA,
        quantity::{ColorChannel, Quantity},
        scalar::{Measurement, Subject},
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
    /// Gain that all levels share, or those of one surface.
    Gain {
        surface: Option<Surface>,
        /// Standard deviation of the logarithm.
        sigma: f64,
    },
    /// Level of thin lines, whose middle the blur mixes with what is beside them: proportional to one over half the width.
    ThinLine {
        /// Standard deviation of the logarithm at a half width of 1 pixel.
        sigma: f64,
    },
    /// Exponent of the noise's variance in the carpet's brightness, because the nominal model of noise is not exactly that
    /// of the sensor and of what its driver does.
    NoiseExponent {
        /// Natural logarithm of the brightness at which the nominal noise holds.
        log_reference: f64,
        /// Standard deviation.
        sigma: f64,
    },
    /// Specular reflection of the carpet at grazing angles: a reflectance `s (1 − cos θ)^power` added to that of all colours
    /// alike, where θ is the angle of incidence and `s` the parameter.
    Sheen {
        power: i32,
        /// Standard deviation, linear, at grazing incidence.
        sigma: f64,
        /// Reflectance of the carpet in each colour without it.
        carpet: [f64; 3],
    },
    /// Brightness of the carpet by the direction in which its pile is seen: proportional to a component of the direction of
    /// view on the ground, sin θ long.
    Pile {
        /// World axis of the component: 0 is x, 1 is y.
        axis: usize,
        /// Standard deviation of the logarithm at grazing incidence.
        sigma: f64,
    },
    /// Fine texture of the carpet, which looks like noise: its contrast at one resolution of the ground.
    Texture {
        /// Resolution in powers of [`NuisanceThresholds::texture_octave`] below that straight down.
        octave: usize,
        /// Standard deviation of the logarithm of the carpet's brightness.
        contrast: f64,
        /// Texture that the recording shows.
        seen: CarpetTexture,
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
    /// Clock of the odometry: it may be the pictures' or that of the reference poses.
    OdometryClock {
        /// Time between the two, seconds.
        sigma_s: f64,
    },
    /// Clock of joints and IMU, likewise.
    AttitudeClock {
        /// Time between the two, seconds.
        sigma_s: f64,
    },
}

const THRESHOLDS: NuisanceThresholds = Thresholds::DEFAULT.linear_model.nuisance;

/// Nuisance parameters of every recording beside those of [`nuisances`].
const COMMON: [Nuisance; 7] = [
    Nuisance::Gain { surface: None, sigma: THRESHOLDS.gain },
    Nuisance::ThinLine { sigma: THRESHOLDS.thin_line_level },
    Nuisance::Width { sigma: THRESHOLDS.blur_by_width_px2 },
    Nuisance::Kernel { sigma: THRESHOLDS.blur_shape },
    Nuisance::ThinKernel { sigma: THRESHOLDS.thin_blur_shape },
    Nuisance::Pile { axis: 0, sigma: THRESHOLDS.pile },
    Nuisance::Pile { axis: 1, sigma: THRESHOLDS.pile },
];

/// Returns the nuisance parameters of a recording, whose nominal brightness is trusted as far as `mean` says, and whose noise and
/// point spread function as far as the camera's file does.
pub(crate) fn nuisances(
    mean: &MeanReflectance,
    texture: &CarpetTexture,
    given: &Photometry,
) -> Vec<Nuisance> {
    let offset = |quantity: Quantity, sigma: f64| Nuisance::Offset { quantity, sigma };
    let lines = ColorChannel::ALL.map(|color| offset(Quantity::LineLevel(color), mean.line.color_sigma));
    let carpet = ColorChannel::ALL.map(|color| offset(Quantity::CarpetLevel(color), mean.carpet.color_sigma));
    let gain = |surface, sigma| Nuisance::Gain { surface: Some(surface), sigma };
    let gains = [gain(Surface::Line, mean.line.sigma), gain(Surface::Carpet, mean.carpet.sigma)];
    // A variance is off by twice the part that the standard deviation is.
    let of_variance = |trust: Option<f64>, usual: f64| trust.map_or(usual, |stated| 2.0 * stated);
    let blur_px2 = given.psf_sigma_px.map_or(THRESHOLDS.free_blur_px2, |sigma_px| {
        let share = of_variance(given.trust().blur, THRESHOLDS.blur_share);
        THRESHOLDS.blur_px2.hypot(share * sigma_px * sigma_px)
    });
    let noise = of_variance(given.trust().noise, THRESHOLDS.noise_variance);
    let luma: f64 = mean.carpet.linear_rgb.iter().zip(LUMA).map(|(value, weight)| value * weight).sum();
    let others = [
        offset(Quantity::LineBlur, blur_px2),
        offset(Quantity::NoiseVariance, noise),
        Nuisance::NoiseExponent { log_reference: luma.max(1e-6).ln(), sigma: THRESHOLDS.noise_exponent },
    ];
    let textures = (0..texture::OCTAVES).map(|octave| Nuisance::Texture {
        octave,
        contrast: THRESHOLDS.texture[0] * THRESHOLDS.texture[1].powi(octave as i32),
        seen: *texture,
    });
    let carpet_rgb = mean.carpet.linear_rgb.map(|linear| linear.max(THRESHOLDS.least_reflectance));
    let sheen = [1, 2].map(|power| Nuisance::Sheen { power, sigma: THRESHOLDS.sheen, carpet: carpet_rgb });
    lines
        .into_iter()
        .chain(carpet)
        .chain(sheen)
        .chain(gains)
        .chain(others)
        .chain(COMMON)
        .chain(textures)
        .collect()
}

impl Nuisance {
    /// Returns the derivative of a measurement's prediction by this parameter in units of its standard deviation.
    /// `by_input` is that of a level by the logarithm of the light that the surface reflects, and that of what odometry, joints
    /// and IMU say by the time that their clock is ahead.
    pub(crate) fn derivative(&self, measurement: &Measurement, predicted: f64, by_input: f64) -> f64 {
        match *self {
            Self::Offset { quantity, sigma } if measurement.quantity == quantity => {
                if quantity.is_level() {
                    sigma * by_input
                } else {
                    sigma
                }
            }
            Self::Gain { surface, sigma }
                if measurement.quantity.surface().is_some_and(|of| surface.is_none_or(|only| only == of)) =>
            {
                sigma * by_input
            }
            Self::ThinLine { sigma } if measurement.quantity.surface() == Some(Surface::Line) => {
                sigma * by_input / measurement.half_width_px
            }
            Self::NoiseExponent { log_reference, sigma }
                if measurement.quantity == Quantity::NoiseVariance =>
            {
                sigma * (measurement.log_brightness - log_reference)
            }
            Self::Width { sigma } if measurement.quantity == Quantity::LineBlur => {
                sigma * measurement.half_width_px.ln()
            }
            Self::Kernel { sigma } if is_blur(measurement, predicted) => sigma * predicted,
            Self::ThinKernel { sigma } if is_blur(measurement, predicted) => {
                sigma * predicted * (-measurement.half_width_px / predicted.sqrt()).exp()
            }
            Self::Sheen { power, sigma, carpet } => {
                let Quantity::CarpetLevel(color) = measurement.quantity else { return 0.0 };
                // Levels grow with the logarithm of the reflectance: d ln(v) = dv / v.
                let share = (1.0 - measurement.cos_incidence).powi(power) / carpet[color as usize];
                sigma * by_input * share
            }
            Self::OdometryClock { sigma_s } if measurement.subject == Subject::OdometryStep => {
                sigma_s * by_input
            }
            Self::AttitudeClock { sigma_s } if measurement.subject == Subject::Attitude => sigma_s * by_input,
            Self::Pile { axis, sigma } if is_carpet(measurement) => {
                sigma * by_input * measurement.view_direction[axis]
            }
            Self::Texture { octave, contrast, seen } if measurement.quantity == Quantity::NoiseVariance => {
                seen.derivative(octave, contrast, measurement, predicted)
            }
            _ => 0.0,
        }
    }
}

fn is_blur(measurement: &Measurement, predicted: f64) -> bool {
    measurement.quantity == Quantity::LineBlur && predicted > 0.0
}

fn is_carpet(measurement: &Measurement) -> bool {
    measurement.quantity.surface() == Some(Surface::Carpet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::measurement;

    fn line_blur(half_width_px: f64) -> Measurement {
        Measurement { half_width_px, ..measurement(Quantity::LineBlur) }
    }

    /// Returns the standard deviation of the variance by the priors of the kernel's shape, as a fraction of the variance.
    fn prior_sigma(half_width_px: f64, variance_px2: f64) -> f64 {
        let squares = COMMON.iter().map(|nuisance| {
            let is_shape = matches!(nuisance, Nuisance::Kernel { .. } | Nuisance::ThinKernel { .. });
            let relative = nuisance.derivative(&line_blur(half_width_px), variance_px2, 1.0) / variance_px2;
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
            assert_eq!(nuisance.derivative(&line, 1.0, 1.0), 0.0);
        }
    }

    #[test]
    fn sheen_vanishes_from_straight_above_and_is_stronger_on_dark_colours() {
        let at = |cos_incidence: f64, color| Measurement {
            cos_incidence,
            ..measurement(Quantity::CarpetLevel(color))
        };
        let sheen = Nuisance::Sheen { power: 1, sigma: THRESHOLDS.sheen, carpet: [0.04, 0.14, 0.05] };
        let of = |cos_incidence, color| sheen.derivative(&at(cos_incidence, color), -3.0, 1.0);
        assert_eq!(of(1.0, ColorChannel::Red), 0.0);
        assert!(of(0.2, ColorChannel::Red) > of(0.2, ColorChannel::Green));
        assert!(of(0.2, ColorChannel::Red) > of(0.6, ColorChannel::Red));
    }
}
