//! Slow errors of the reference poses: errors of motion capture that last for seconds, and what the calibration between its
//! markers and the camera leaves for good.
//!
//! Their columns are nuisance parameters with a prior, so that no slow or constant error of a pose becomes the name of an
//! effect. An error that lasts is taken for a stationary process with the covariance `s² exp(−|t| / τ)`. Its variance `s²` and
//! time constant `τ` are those of the variogram of the frames' estimated pose errors (Cressie, *Statistics for Spatial Data*,
//! section 2.4), which no constant changes; its columns are cosines over the recording with the variances of its spectrum. Errors
//! whose ranks follow each other as at random have no slow part (Bartels, Journal of the American Statistical Association 77,
//! 1982): the variogram of a few frames would find one in any errors.

use reality_sim_core::statistics::{median, robust_sigma};

use crate::{
    linear_model::{
        column::ColumnIndex, fitted_residuals::FittedResiduals, linearized_frame::LinearizedFrame,
    },
    recording::ReferenceKind,
    thresholds::{ReferenceDriftThresholds, Thresholds},
};

const THRESHOLDS: ReferenceDriftThresholds = Thresholds::DEFAULT.linear_model.reference_drift;

/// Direction of an error of the poses.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Direction {
    /// Component of [`crate::linear_model::pose_gradient::pose_gradient`].
    Pose(usize),
    /// Ahead in the camera's heading.
    Ahead,
    /// To the left of the camera's heading.
    Left,
}

/// Slow error of the reference poses with the standard deviation of its prior.
#[derive(Debug, Clone, Copy, PartialEq)]
struct DriftTerm {
    direction: Direction,
    /// Half periods over the recording: 0 for a constant.
    half_periods: usize,
    /// Standard deviation of the root mean square over the recording, radians or metres.
    sigma: f64,
}

/// Slow errors of the reference poses of a recording.
#[derive(Debug)]
pub(crate) struct ReferenceDrift {
    terms: Vec<DriftTerm>,
    /// Times of the first and last frame, seconds.
    span_s: [f64; 2],
}

/// Estimated error of one component of a frame's reference pose.
#[derive(Debug, Clone, Copy)]
struct EstimatedError {
    time_s: f64,
    error: f64,
    /// Posterior variance of the error.
    variance: f64,
}

impl ReferenceDrift {
    /// Estimates the slow errors at frames with these times, seconds, from fits without them. `pose_sigmas` are the standard
    /// deviations of the frames' own errors in these fits.
    pub(crate) fn new(
        reference: ReferenceKind,
        times_s: &[f64],
        fits: &[FittedResiduals],
        pose_sigmas: [f64; 6],
    ) -> Self {
        let (first_s, last_s) = (times_s.first().copied(), times_s.last().copied());
        let span_s = [first_s.unwrap_or(0.0), last_s.unwrap_or(0.0)];
        let duration_s = span_s[1] - span_s[0];
        // Places and headings from the pictures have errors that are free in every frame.
        let is_measured = reference == ReferenceKind::Whole;
        let axes = (0..6).filter(|axis| is_measured || ![1, 3, 4].contains(axis));
        let mut terms = Vec::new();
        for axis in axes {
            let constant =
                THRESHOLDS.calibration[axis / 3].hypot(THRESHOLDS.lasting_part * pose_sigmas[axis]);
            let process = SlowProcess::estimate(&of_axis(times_s, fits, axis), pose_sigmas[axis]);
            let most = THRESHOLDS.largest[axis / 3].powi(2);
            let process = process.filter(|_| duration_s > 0.0);
            let process =
                process.map(|process| SlowProcess { variance: process.variance.min(most), ..process });
            let lasting = process.map_or(0.0, |process| process.mean_variance(duration_s));
            let direction = Direction::Pose(axis);
            terms.push(DriftTerm { direction, half_periods: 0, sigma: constant.hypot(lasting.sqrt()) });
            terms.extend(process.into_iter().flat_map(|process| {
                (1..=THRESHOLDS.half_periods).map(move |half_periods| {
                    let sigma = process.term_variance(duration_s, half_periods).sqrt();
                    DriftTerm { direction, half_periods, sigma }
                })
            }));
        }
        if is_measured {
            let sigma = THRESHOLDS.calibration[1];
            let heading = [Direction::Ahead, Direction::Left];
            terms.extend(heading.map(|direction| DriftTerm { direction, half_periods: 0, sigma }));
        }
        Self { terms, span_s }
    }

    /// Returns the number of columns.
    pub(crate) fn len(&self) -> usize {
        self.terms.len()
    }

    /// Returns the standard deviations of all errors of the poses, from those of the frames' own errors.
    pub(crate) fn together_with(&self, own_sigmas: [f64; 6]) -> [f64; 6] {
        let mut variances = own_sigmas.map(|sigma| sigma * sigma);
        for term in &self.terms {
            match term.direction {
                Direction::Pose(axis) => variances[axis] += term.sigma * term.sigma,
                // Ahead and aside are each along x and along y in half of all headings.
                Direction::Ahead | Direction::Left => {
                    variances[3..5]
                        .iter_mut()
                        .for_each(|variance| *variance += 0.5 * term.sigma * term.sigma);
                }
            }
        }
        variances.map(f64::sqrt)
    }

    /// Adds the columns of the slow errors to a frame, from the column `first` on, each in units of its prior's standard
    /// deviation. `yaw_rad` is the camera's heading.
    pub(crate) fn add_to(&self, frame: &mut LinearizedFrame, time_s: f64, yaw_rad: f64, first: usize) {
        let (sin, cos) = yaw_rad.sin_cos();
        let size = |term: &DriftTerm| term.sigma * self.basis(term.half_periods, time_s);
        let sizes: Vec<f64> = self.terms.iter().map(size).collect();
        for (gradient, row) in frame.pose_gradients.iter().zip(&mut frame.jacobian) {
            if gradient.iter().all(|value| *value == 0.0) {
                continue;
            }
            for (index, (term, size)) in self.terms.iter().zip(&sizes).enumerate() {
                let along = match term.direction {
                    Direction::Pose(axis) => gradient[axis],
                    Direction::Ahead => cos * gradient[3] + sin * gradient[4],
                    Direction::Left => cos * gradient[4] - sin * gradient[3],
                };
                row.push((ColumnIndex(first + index), size * along));
            }
        }
    }

    /// Returns a cosine whose mean square over the recording is 1.
    fn basis(&self, half_periods: usize, time_s: f64) -> f64 {
        if half_periods == 0 {
            return 1.0;
        }
        let part = (time_s - self.span_s[0]) / (self.span_s[1] - self.span_s[0]);
        std::f64::consts::SQRT_2 * (std::f64::consts::PI * half_periods as f64 * part).cos()
    }
}

/// Returns the estimated errors of one component of the pose.
fn of_axis(times_s: &[f64], fits: &[FittedResiduals], axis: usize) -> Vec<EstimatedError> {
    let error = |(&time_s, fit): (&f64, &FittedResiduals)| EstimatedError {
        time_s,
        error: fit.pose_error[axis],
        variance: fit.pose_variance[axis],
    };
    times_s.iter().zip(fits).map(error).collect()
}

/// Stationary process with an exponential covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SlowProcess {
    variance: f64,
    time_constant_s: f64,
}

impl SlowProcess {
    /// Estimates the slow part of one component of the pose errors, whose prior had the standard deviation `sigma`. None if
    /// there is next to none.
    fn estimate(errors: &[EstimatedError], sigma: f64) -> Option<Self> {
        if !last(errors) {
            return None;
        }
        let variogram = variogram(errors);
        let duration_s = errors.last()?.time_s - errors.first()?.time_s;
        let seen =
            |time_constant_s: &&f64| **time_constant_s <= THRESHOLDS.longest_time_constant * duration_s;
        let fits = THRESHOLDS.time_constants_s.iter().filter(seen).filter_map(|&time_constant_s| {
            let (variance, misfit) = slow_variance(&variogram, time_constant_s)?;
            Some((misfit, Self { variance, time_constant_s }))
        });
        let (_, fitted) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
        // An error that is hardly seen in its frame is estimated too small, by this factor.
        let posterior = median(errors.iter().map(|error| error.variance));
        let shrunk = (1.0 - posterior / (sigma * sigma)).max(THRESHOLDS.least_shrinkage);
        let variance = fitted.variance / (shrunk * shrunk);
        (variance > (THRESHOLDS.least_part * sigma).powi(2)).then_some(Self { variance, ..fitted })
    }

    /// Returns the variance of the mean over a recording.
    fn mean_variance(self, duration_s: f64) -> f64 {
        let part = self.time_constant_s / duration_s;
        self.variance * 2.0 * part * (1.0 - part * (1.0 - (-1.0 / part).exp()))
    }

    /// Returns the variance of the amplitude of a cosine of mean square 1, by the process's spectrum.
    fn term_variance(self, duration_s: f64, half_periods: usize) -> f64 {
        let part = self.time_constant_s / duration_s;
        self.variance * 2.0 * part / (1.0 + (std::f64::consts::PI * half_periods as f64 * part).powi(2))
    }
}

/// Whether errors last from frame to frame, by the rank version of von Neumann's ratio (Bartels 1982, with its variance).
fn last(errors: &[EstimatedError]) -> bool {
    let count = errors.len() as f64;
    if errors.len() < 4 {
        return false;
    }
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&a, &b| errors[a].error.total_cmp(&errors[b].error));
    let mut ranks = vec![0.0; errors.len()];
    order.iter().enumerate().for_each(|(rank, &index)| ranks[index] = rank as f64);
    let successive: f64 = ranks.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    let ratio = successive / (count * (count * count - 1.0) / 12.0);
    let variance = 4.0 * (count - 2.0) * (5.0 * count * count - 2.0 * count - 9.0)
        / (5.0 * count * (count + 1.0) * (count - 1.0).powi(2));
    ratio < 2.0 - THRESHOLDS.least_lasting_score * variance.sqrt()
}

/// Returns half the robust mean square difference of errors over their distance in time, seconds.
fn variogram(errors: &[EstimatedError]) -> Vec<(f64, f64)> {
    let (Some(first), Some(last)) = (errors.first(), errors.last()) else { return Vec::new() };
    let width_s = THRESHOLDS.longest_lag * (last.time_s - first.time_s) / THRESHOLDS.lags as f64;
    let mut bins = vec![(Vec::new(), 0.0); THRESHOLDS.lags];
    for (index, one) in errors.iter().enumerate() {
        for other in &errors[index + 1..] {
            let lag_s = other.time_s - one.time_s;
            if let Some((differences, sum_s)) = bins.get_mut((lag_s / width_s) as usize) {
                differences.push(other.error - one.error);
                *sum_s += lag_s;
            }
        }
    }
    let filled = bins.into_iter().filter(|(differences, _)| !differences.is_empty());
    filled
        .map(|(differences, sum_s)| {
            (sum_s / differences.len() as f64, 0.5 * robust_sigma(differences).powi(2))
        })
        .collect()
}

/// Fits `w + s² (1 − exp(−t / τ))` with `w ≥ 0` and `s² ≥ 0` to a variogram; returns `s²` and the misfit. Long lags have few
/// independent pairs, and count less.
fn slow_variance(variogram: &[(f64, f64)], time_constant_s: f64) -> Option<(f64, f64)> {
    let mut sums = [0.0; 6];
    for &(lag_s, half_square) in variogram {
        let (weight, rise) = (lag_s.recip(), 1.0 - (-lag_s / time_constant_s).exp());
        let terms = [1.0, rise, rise * rise, half_square, rise * half_square, half_square * half_square];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
    }
    let [n, x, xx, y, xy, yy] = sums;
    let determinant = n * xx - x * x;
    if variogram.len() < 3 || determinant <= 0.0 {
        return None;
    }
    let free = (n * xy - x * y) / determinant;
    let white = (y - free * x) / n;
    let (white, slow) = match (white >= 0.0, free >= 0.0) {
        (true, true) => (white, free),
        (_, false) => (y / n, 0.0),
        (false, true) => (0.0, xy / xx),
    };
    let misfit =
        yy - 2.0 * (white * y + slow * xy) + white * white * n + 2.0 * white * slow * x + slow * slow * xx;
    Some((slow, misfit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    /// Returns errors with a white part and a slow part of these standard deviations, every 0.2 s.
    fn errors(seed: u64, white: f64, slow: f64, time_constant_s: f64) -> Vec<EstimatedError> {
        let mut noise = Noise(seed);
        let kept = (-0.2 / time_constant_s).exp();
        let mut state = slow * noise.next();
        (0..60)
            .map(|frame| {
                state = kept * state + slow * (1.0 - kept * kept).sqrt() * noise.next();
                let error = 0.05 + state + white * noise.next();
                let time_s = 0.2 * f64::from(frame);
                EstimatedError { time_s, error, variance: 0.0 }
            })
            .collect()
    }

    fn slow_sigmas(white: f64, slow: f64, time_constant_s: f64) -> Vec<f64> {
        let of = |seed| {
            let process = SlowProcess::estimate(&errors(seed, white, slow, time_constant_s), 0.003);
            process.map_or(0.0, |process| process.variance.sqrt())
        };
        let mut sigmas: Vec<f64> = (0..100).map(of).collect();
        sigmas.sort_by(f64::total_cmp);
        sigmas
    }

    #[test]
    fn the_size_of_slow_errors_is_estimated_beside_white_ones_and_an_offset() {
        for time_constant_s in [0.5, 1.0, 2.0] {
            let sigmas = slow_sigmas(0.0015, 0.003, time_constant_s);
            assert!((0.002..0.0045).contains(&sigmas[50]), "{time_constant_s}: {}", sigmas[50]);
            assert!(sigmas[10] > 0.001, "{time_constant_s}: {}", sigmas[10]);
        }
        // Of five time constants in twelve seconds, a part of the process is a constant to the recording.
        assert!(slow_sigmas(0.0015, 0.003, 5.0)[50] > 0.001);
    }

    #[test]
    fn white_errors_are_not_slow() {
        let sigmas = slow_sigmas(0.003, 0.0, 1.0);
        assert!(sigmas[90] == 0.0, "{} {}", sigmas[50], sigmas[90]);
    }

    #[test]
    fn the_terms_have_the_variance_of_the_process() {
        let process = SlowProcess { variance: 4.0, time_constant_s: 1.0 };
        let terms: f64 = (1..2000).map(|half_periods| process.term_variance(12.0, half_periods)).sum();
        let total = process.mean_variance(12.0) + terms;
        assert!((total - 4.0).abs() < 0.4, "{total}");
        assert!((process.mean_variance(1e6) * 1e6 - 2.0 * 4.0).abs() < 1e-3);
        assert!((process.mean_variance(1e-3) - 4.0).abs() < 0.01);
    }

    #[test]
    fn cosines_are_orthogonal_over_the_recording() {
        let drift = ReferenceDrift { terms: Vec::new(), span_s: [3.0, 15.0] };
        let product = |a: usize, b: usize| -> f64 {
            let times = (0..1200).map(|i| 3.0 + 0.01 * (f64::from(i) + 0.5));
            times.map(|time_s| drift.basis(a, time_s) * drift.basis(b, time_s)).sum::<f64>() / 1200.0
        };
        for (a, b) in [(0, 0), (1, 1), (5, 5)] {
            assert!((product(a, b) - 1.0).abs() < 1e-6);
        }
        for (a, b) in [(0, 1), (1, 2), (2, 5)] {
            assert!(product(a, b).abs() < 1e-6);
        }
    }
}
