//! Residuals of the odometry that follow the robot's movement.
//!
//! As for patterns in the pictures, a part of the recording is judged by what the other parts foretell.

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
/// What residuals may follow, in the order of [`movements`].
const FOLLOWED: [Movement; 3] = [Movement::Ahead, Movement::Turn, Movement::Time];
/// Components of a step.
const COMPONENTS: [(OdometryComponent, Quantity); 3] = [
    (OdometryComponent::Forward, Quantity::OdometryForward),
    (OdometryComponent::Left, Quantity::OdometryLeft),
    (OdometryComponent::Turn, Quantity::OdometryTurn),
];

/// What a number may follow, and the number, both in its standard deviation.
type Pair = (f64, f64);

/// Finds residuals of the odometry that follow the movement.
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
        let mut rows = frame.measurements.iter().zip(&frame.values);
        rows.find(|(row, value)| row.quantity == quantity && value.is_finite())
            .map(|(_, value)| value / sigma)
    };
    let values: Vec<Option<f64>> = fit.frames.iter().map(value).collect();
    let off = fit.model_error.off(quantity) / sigma;
    let (follows, rms) =
        most_followed(steps, &values).filter(|(_, rms)| *rms > THRESHOLDS.least_model_errors * off)?;
    Some(Finding::Odometry { component, follows, size: rms * sigma })
}

/// What each step of the odometry may follow: how far the robot walks ahead at about that time, turns, and for how long. To
/// the left the camera sways: no odometry knows of that.
fn movements(recording: &Recording<'_>, frames: &[&Frame]) -> Vec<Option<[f64; 3]>> {
    let followed = |(motion, frame): (Option<Motion2>, &&Frame)| {
        let Motion2 { forward_m, turn_rad, .. } = motion?;
        Some([forward_m, turn_rad, frame.step?.until_s - frame.time_s])
    };
    instrumental_motions(recording, frames).into_iter().zip(frames).map(followed).collect()
}

/// What a component of the steps follows most, and how large that is in its standard deviations.
fn most_followed(steps: &[Option<[f64; 3]>], values: &[Option<f64>]) -> Option<(Movement, f64)> {
    let follows = (0..).zip(FOLLOWED).filter_map(|(axis, followed): (usize, Movement)| {
        let pair = |(step, value): (&Option<[f64; 3]>, &Option<f64>)| {
            Vec::from_iter(step.zip(*value).map(|(step, value)| (step[axis], value)))
        };
        let follows = Follows::of(&steps.iter().zip(values).map(pair).collect::<Vec<_>>())?;
        (follows.rms > THRESHOLDS.least_ratio * follows.left).then_some((follows.rms, followed))
    });
    let (rms, followed) = follows.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((followed, rms))
}

/// Numbers that follow others.
struct Follows {
    /// Root mean square of what is foretold.
    rms: f64,
    /// And of what is not.
    left: f64,
}

impl Follows {
    /// None where frames do not foretell each other.
    fn of(frames: &[Vec<Pair>]) -> Option<Self> {
        let slope = slope(frames.iter());
        let rms = |of: &dyn Fn(&Pair) -> f64| {
            let squares = frames.iter().flatten().map(|pair| of(pair).powi(2));
            let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
            f64::sqrt(sum / f64::max(count, 1.0))
        };
        let found = Self { rms: rms(&|(to, _)| to * slope), left: rms(&|(to, value)| value - to * slope) };
        let count = frames.len();
        let fold = |frame: usize| stretch(frame, count, THRESHOLDS.folds);
        let gain = |frame: usize| {
            let others = (0..count).filter(|&other| fold(other) != fold(frame));
            let slope = self::slope(others.map(|other| &frames[other]));
            let gains = frames[frame].iter().map(|(to, value)| {
                let foretold = to * slope;
                foretold * value - 0.5 * foretold * foretold
            });
            // What a number's standard deviation is taken to be may have what is foretold in it.
            gains.sum::<f64>() / found.left.powi(2).max(1e-9)
        };
        let gain = sum_of(&(0..count).map(gain).collect::<Vec<f64>>());
        (gain.value > THRESHOLDS.least_gain && gain.score() > THRESHOLDS.least_score).then_some(found)
    }
}

/// Least squares.
fn slope<'a>(frames: impl Iterator<Item = &'a Vec<Pair>>) -> f64 {
    let sums =
        frames.flatten().fold([0.0; 2], |[both, square], (to, value)| [both + to * value, square + to * to]);
    if sums[1] > 0.0 { sums[0] / sums[1] } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    /// Frames with six numbers each that follow a movement by this slope.
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
    fn what_follows_the_movement_is_told_with_its_size() {
        let follows = Follows::of(&frames(1, 1.5)).unwrap();
        assert!((follows.rms - 1.5 / f64::sqrt(2.0)).abs() < 0.15, "{}", follows.rms);
        assert!((follows.left - 1.0).abs() < 0.15, "{}", follows.left);
    }

    #[test]
    fn scatter_follows_nothing() {
        let told = (0..300).filter(|&seed| Follows::of(&frames(seed, 0.0)).is_some()).count();
        assert_eq!(told, 0);
    }
}
