//! Residuals of the odometry that are proportional to the robot's movement.
//!
//! A residual is regressed on the movement in each part of the recording, and the slope must predict the residuals of the
//! other parts (cross-validation).

use reality_sim_core::pose::Motion2;

use crate::{
    diagnostics::detector::{Detector, FitResiduals, FrameResiduals},
    diagnostics::finding::{Finding, Movement, OdometryComponent},
    inference::gain::sum_of,
    inference::split::stretch,
    linear_model::odometry_steps::instrumental_motions,
    measurement::quantity::Quantity,
    recording::{Frame, Recording},
    thresholds::{OdometryThresholds, Thresholds},
};

const THRESHOLDS: OdometryThresholds = Thresholds::DEFAULT.diagnostics.odometry;
/// Movements that residuals may be proportional to, in the order of [`movements`].
const MOVEMENTS: [Movement; 3] = [Movement::Ahead, Movement::Turn, Movement::Time];
/// Components of an odometry step.
const COMPONENTS: [(OdometryComponent, Quantity); 3] = [
    (OdometryComponent::Forward, Quantity::OdometryForward),
    (OdometryComponent::Left, Quantity::OdometryLeft),
    (OdometryComponent::Turn, Quantity::OdometryTurn),
];

/// Movement, and a residual in its standard deviation.
type Pair = (f64, f64);

/// Detector of residuals of the odometry that are proportional to the movement.
pub(crate) struct Odometry;

impl Detector for Odometry {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        let steps = movements(fit.recording, &fit.steps);
        let of = |(component, quantity)| of_component(fit, &steps, component, quantity);
        COMPONENTS.into_iter().filter_map(of).collect()
    }
}

fn of_component(
    fit: &FitResiduals<'_>,
    steps: &[Option<[f64; 3]>],
    component: OdometryComponent,
    quantity: Quantity,
) -> Option<Finding> {
    let sigma = *fit.sigmas.get(&quantity)?;
    let value = |frame: &FrameResiduals<'_>| {
        let mut residuals = frame.measurements.iter().zip(&frame.values);
        residuals
            .find(|(measurement, value)| measurement.quantity == quantity && value.is_finite())
            .map(|(_, value)| value / sigma)
    };
    let values: Vec<Option<f64>> = fit.frames.iter().map(value).collect();
    let off = fit.model_error.off(quantity) / sigma;
    let (follows, rms) =
        strongest(steps, &values).filter(|(_, rms)| *rms > THRESHOLDS.least_model_errors * off)?;
    Some(Finding::Odometry { component, follows, size: rms * sigma })
}

/// Returns the movement in each step of the odometry: the distance forward in metres at about that time, the turn in radians,
/// and the duration in seconds. The motion to the left is left out: it is mostly sway of the camera, which no odometry
/// measures.
fn movements(recording: &Recording<'_>, frames: &[&Frame]) -> Vec<Option<[f64; 3]>> {
    let movement = |(motion, frame): (Option<Motion2>, &&Frame)| {
        let Motion2 { forward_m, turn_rad, .. } = motion?;
        Some([forward_m, turn_rad, frame.step?.until_s - frame.time_s])
    };
    instrumental_motions(recording, frames).into_iter().zip(frames).map(movement).collect()
}

/// Returns the movement that a component's residuals depend on most, and the root mean square of the dependent part in
/// standard deviations.
fn strongest(steps: &[Option<[f64; 3]>], values: &[Option<f64>]) -> Option<(Movement, f64)> {
    let regressions = (0..).zip(MOVEMENTS).filter_map(|(axis, movement): (usize, Movement)| {
        let pair = |(step, value): (&Option<[f64; 3]>, &Option<f64>)| {
            Vec::from_iter(step.zip(*value).map(|(step, value)| (step[axis], value)))
        };
        let regression = Regression::of(&steps.iter().zip(values).map(pair).collect::<Vec<_>>())?;
        (regression.rms > THRESHOLDS.least_ratio * regression.residual_rms)
            .then_some((regression.rms, movement))
    });
    let (rms, movement) = regressions.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((movement, rms))
}

/// Regression of residuals on a movement.
struct Regression {
    /// Root mean square of the predicted part.
    rms: f64,
    /// Root mean square of the rest.
    residual_rms: f64,
}

impl Regression {
    /// Regresses residuals on a movement. None if the slope of some frames does not predict the others.
    fn of(frames: &[Vec<Pair>]) -> Option<Self> {
        let slope = slope(frames.iter());
        let rms = |of: &dyn Fn(&Pair) -> f64| {
            let squares = frames.iter().flatten().map(|pair| of(pair).powi(2));
            let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
            f64::sqrt(sum / f64::max(count, 1.0))
        };
        let whole = Self {
            rms: rms(&|(movement, _)| movement * slope),
            residual_rms: rms(&|(movement, value)| value - movement * slope),
        };
        let count = frames.len();
        let fold = |frame: usize| stretch(frame, count, THRESHOLDS.folds);
        let gain = |frame: usize| {
            let others = (0..count).filter(|&other| fold(other) != fold(frame));
            let slope = self::slope(others.map(|other| &frames[other]));
            let gains = frames[frame].iter().map(|(movement, value)| {
                let predicted = movement * slope;
                predicted * value - 0.5 * predicted * predicted
            });
            // The standard deviation of a residual may include the predicted part, so the variance of the rest is used.
            gains.sum::<f64>() / whole.residual_rms.powi(2).max(1e-9)
        };
        let gain = sum_of(&(0..count).map(gain).collect::<Vec<f64>>());
        (gain.value > THRESHOLDS.least_gain && gain.score() > THRESHOLDS.least_score).then_some(whole)
    }
}

/// Returns the slope of a line through the origin, by least squares; 0 without movement.
fn slope<'a>(frames: impl Iterator<Item = &'a Vec<Pair>>) -> f64 {
    let sums = frames.flatten().fold([0.0; 2], |[both, square], (movement, value)| {
        [both + movement * value, square + movement * movement]
    });
    if sums[1] > 0.0 { sums[0] / sums[1] } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    /// Frames with six residuals each that depend on a movement by this slope.
    fn frames(seed: u64, slope: f64) -> Vec<Vec<Pair>> {
        let mut noise = Noise(seed);
        let frame = |index: u32| {
            (0..6)
                .map(|axis| {
                    let rate = (0.7 * f64::from(index) + f64::from(axis)).sin();
                    (rate, slope * rate + noise.next())
                })
                .collect()
        };
        (0..40).map(frame).collect()
    }

    #[test]
    fn residuals_proportional_to_a_movement_are_found_with_their_size() {
        let regression = Regression::of(&frames(1, 1.5)).unwrap();
        assert!((regression.rms - 1.5 / f64::sqrt(2.0)).abs() < 0.15, "{}", regression.rms);
        assert!((regression.residual_rms - 1.0).abs() < 0.15, "{}", regression.residual_rms);
    }

    #[test]
    fn noise_depends_on_no_movement() {
        let found = (0..300).filter(|&seed| Regression::of(&frames(seed, 0.0)).is_some()).count();
        assert_eq!(found, 0);
    }
}
