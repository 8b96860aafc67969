//! Least-squares fit of a blurred bar to a line's profile in luma.

use nalgebra::{SMatrix, SVector};
use statrs::function::erf::erf;

use super::samples::{LinePiece, Sample};
use crate::thresholds::{ProfileThresholds, Thresholds};

/// Most iterations of the Levenberg–Marquardt method.
const MAX_STEPS: usize = 12;
const THRESHOLDS: ProfileThresholds = Thresholds::DEFAULT.measurement.profile;

/// Parameters of the bar: middle (pixels), variance of the blur (pixels squared), and the linear levels of the line and of
/// the flanks before and after it.
type Values = SVector<f64, 5>;

/// Fitted bar.
pub(super) struct Bar {
    pub(super) values: Values,
    /// Standard deviations of the parameters.
    pub(super) sigma: Values,
    /// Root mean square of the residuals, encoded.
    pub(super) residual: f64,
}

/// Fits a bar by the Levenberg–Marquardt method (Marquardt 1963). None if the fit does not end well
/// inside the permitted range.
pub(super) fn fit_bar(samples: &[Sample], gamma: f64, piece: &LinePiece, found_px: f64) -> Option<Bar> {
    let mut values = start(samples, gamma, piece, found_px)?;
    let mut damping = 1e-3;
    let mut equations = NormalEquations::new(samples, gamma, piece.half_width_px, &values);
    for _ in 0..MAX_STEPS {
        let mut damped = equations.normal;
        for i in 0..5 {
            damped[(i, i)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&equations.gradient);
        let mut next = values + step;
        next[1] = next[1].clamp(THRESHOLDS.variance_px2[0], THRESHOLDS.variance_px2[1]);
        for level in next.iter_mut().skip(2) {
            *level = level.max(1e-5);
        }
        let tried = NormalEquations::new(samples, gamma, piece.half_width_px, &next);
        if tried.squares < equations.squares {
            let settled = (next - values).amax() < 1e-4;
            (values, equations) = (next, tried);
            damping *= 0.2;
            if settled {
                break;
            }
        } else {
            damping *= 8.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let degrees =
        samples.len().checked_sub(5).filter(|&degrees| degrees >= THRESHOLDS.least_degrees_of_freedom)?
            as f64;
    let covariance = equations.normal.try_inverse()? * (equations.squares / degrees);
    let inside = THRESHOLDS.variance_px2.iter().all(|edge| (values[1] - edge).abs() > 1e-6);
    let near = (values[0] - found_px).abs() < piece.half_width_px + THRESHOLDS.most_shift_px;
    (inside && near).then(|| Bar {
        values,
        sigma: covariance.diagonal().map(|variance| variance.max(0.0).sqrt()),
        residual: (equations.squares / samples.len() as f64).sqrt(),
    })
}

/// Returns the initial values. Levels are means over the samples well inside and well outside the line. Where the line is divided for that
/// only changes where the fit begins.
fn start(samples: &[Sample], gamma: f64, piece: &LinePiece, found_px: f64) -> Option<Values> {
    let mut sums = [(0.0, 0.0); 3];
    let blur = piece.variance_px2.sqrt();
    for sample in samples {
        let across = sample.across_px - found_px;
        let kind = if across.abs() < 0.6 * piece.half_width_px {
            0
        } else if across.abs() > piece.half_width_px + blur {
            1 + usize::from(across > 0.0)
        } else {
            continue;
        };
        sums[kind].0 += sample.luma;
        sums[kind].1 += 1.0;
    }
    let level = |(sum, count): (f64, f64)| (count > 0.0).then(|| (sum / count).max(1e-3).powf(gamma));
    Some(Values::new(
        found_px,
        piece.variance_px2.max(0.1),
        level(sums[0])?,
        level(sums[1])?,
        level(sums[2])?,
    ))
}

/// Normal equations of the Gauss–Newton step at some parameters.
struct NormalEquations {
    normal: SMatrix<f64, 5, 5>,
    gradient: Values,
    /// Sum of squared residuals.
    squares: f64,
}

impl NormalEquations {
    fn new(samples: &[Sample], gamma: f64, half_width_px: f64, values: &Values) -> Self {
        let mut equations = Self { normal: SMatrix::zeros(), gradient: Values::zeros(), squares: 0.0 };
        let sigma = values[1].sqrt();
        let (line, before, after) = (values[2], values[3], values[4]);
        for sample in samples {
            let from_middle = sample.across_px - values[0];
            let (low, high) = ((from_middle + half_width_px) / sigma, (from_middle - half_width_px) / sigma);
            let (rise, fall) = (cumulative(low), cumulative(high));
            let (steep_rise, steep_fall) = (density(low), density(high));
            let linear = (before + (line - before) * rise - (line - after) * fall).max(1e-5);
            let encoded = linear.powf(1.0 / gamma);
            let slope = encoded / (gamma * linear);
            let derivatives = slope
                * Values::new(
                    (-(line - before) * steep_rise + (line - after) * steep_fall) / sigma,
                    (-(line - before) * steep_rise * low + (line - after) * steep_fall * high)
                        / (2.0 * values[1]),
                    rise - fall,
                    1.0 - rise,
                    fall,
                );
            let residual = sample.luma - encoded;
            equations.normal.ger(1.0, &derivatives, &derivatives, 1.0);
            equations.gradient += residual * derivatives;
            equations.squares += residual * residual;
        }
        equations
    }
}

/// Cumulative distribution function of the standard normal distribution.
fn cumulative(z: f64) -> f64 {
    0.5 * (1.0 + erf(z * std::f64::consts::FRAC_1_SQRT_2))
}

/// Density of the standard normal distribution.
fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt()
}
