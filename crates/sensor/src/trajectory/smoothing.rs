//! Smoothing of noisy values over time by local quadratic fits, with a bandwidth that cross-validation chooses for each
//! coordinate (Fan and Gijbels, *Local Polynomial Modelling and Its Applications*, 1996, sections 3.1 and 4.10).

use glam::{DMat3, DVec3};

use super::spline::Coordinates;

/// Bandwidths that are tried, in median steps between values: half the width of the tricube kernel. A quadratic needs two
/// values on each side to average anything.
const BANDWIDTHS: [f64; 8] = [2.5, 3.75, 5.6, 8.4, 12.6, 19.0, 28.0, 42.0];
/// Largest bandwidth, seconds: half the period of the fastest shake of a walking robot that is to be kept, 3.3 Hz.
const LARGEST_BANDWIDTH_S: f64 = 0.15;

/// Returns the values smoothed over time. A coordinate whose neighbours predict it best without any smoothing stays as it is.
pub(super) fn smoothed(times_s: &[f64], values: &[Coordinates]) -> Vec<Coordinates> {
    let mut best = values.to_vec();
    let Some(step_s) = median_step_s(times_s) else { return best };
    let mut least = interpolation_errors(times_s, values);
    for bandwidth_s in BANDWIDTHS.map(|steps| steps * step_s) {
        if bandwidth_s > LARGEST_BANDWIDTH_S {
            break;
        }
        let (fitted, errors) = local_fits(times_s, values, bandwidth_s);
        for axis in 0..least.len() {
            if errors[axis] < least[axis] {
                least[axis] = errors[axis];
                best.iter_mut().zip(&fitted).for_each(|(best, fitted)| best[axis] = fitted[axis]);
            }
        }
    }
    best
}

/// Whether values are close enough in time to be smoothed.
pub(super) fn are_dense(times_s: &[f64]) -> bool {
    median_step_s(times_s).is_some_and(|step_s| BANDWIDTHS[0] * step_s <= LARGEST_BANDWIDTH_S)
}

fn median_step_s(times_s: &[f64]) -> Option<f64> {
    let mut steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps_s.len() / 2;
    (!steps_s.is_empty()).then(|| *steps_s.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Returns the mean square by which cubic interpolation between its two neighbours on each side misses a value.
fn interpolation_errors(times_s: &[f64], values: &[Coordinates]) -> Coordinates {
    let mut squares = [0.0; 6];
    for index in 2..times_s.len().saturating_sub(2) {
        let neighbours = [index - 2, index - 1, index + 1, index + 2];
        let weight = |&of: &usize| -> f64 {
            let others = neighbours.iter().filter(|other| **other != of);
            others.map(|&other| (times_s[index] - times_s[other]) / (times_s[of] - times_s[other])).product()
        };
        let weights = neighbours.each_ref().map(weight);
        for (axis, square) in squares.iter_mut().enumerate() {
            let predicted: f64 =
                neighbours.iter().zip(weights).map(|(&other, weight)| weight * values[other][axis]).sum();
            *square += (values[index][axis] - predicted).powi(2);
        }
    }
    let count = times_s.len().saturating_sub(4);
    if count == 0 { [0.0; 6] } else { squares.map(|square| square / count as f64) }
}

/// Returns the values of local quadratic fits, and the mean square by which such fits to all other values miss a value.
fn local_fits(times_s: &[f64], values: &[Coordinates], bandwidth_s: f64) -> (Vec<Coordinates>, Coordinates) {
    let mut fitted = values.to_vec();
    let (mut squares, mut count) = ([0.0; 6], 0.0);
    let mut from = 0;
    for index in 0..times_s.len() {
        while times_s[index] - times_s[from] >= bandwidth_s {
            from += 1;
        }
        let Some(weights) = quadratic_weights(&times_s[from..], times_s[index], bandwidth_s) else {
            continue;
        };
        let own = weights[index - from];
        for axis in 0..6 {
            let fit: f64 =
                weights.iter().zip(&values[from..]).map(|(weight, value)| weight * value[axis]).sum();
            fitted[index][axis] = fit;
            // The residual of a fit without this value, by the leverage of a linear smoother.
            squares[axis] += ((values[index][axis] - fit) / (1.0 - own)).powi(2);
        }
        count += 1.0;
    }
    // Where hardly a value has neighbours, cross-validation says nothing.
    let errors =
        if 2.0 * count > times_s.len() as f64 { squares.map(|square| square / count) } else { [f64::MAX; 6] };
    (fitted, errors)
}

/// Returns the weights with which the values from the first of these times on enter the local quadratic fit at a time; `None`
/// where there are too few.
fn quadratic_weights(times_s: &[f64], at_s: f64, bandwidth_s: f64) -> Option<Vec<f64>> {
    let places = times_s.iter().map(|time_s| (time_s - at_s) / bandwidth_s).take_while(|place| *place < 1.0);
    let terms: Vec<(f64, DVec3)> = places
        .map(|place| ((1.0 - place.abs().powi(3)).powi(3), DVec3::new(1.0, place, place * place)))
        .collect();
    if terms.len() < 4 {
        return None;
    }
    let product = |(weight, term): &(f64, DVec3)| {
        *weight * DMat3::from_cols(term.x * *term, term.y * *term, term.z * *term)
    };
    let normal = terms.iter().map(product).fold(DMat3::ZERO, |sum, term| sum + term);
    let middle = normal.inverse().x_axis;
    let weights: Vec<f64> = terms.iter().map(|(weight, term)| weight * middle.dot(*term)).collect();
    weights.iter().all(|weight| weight.is_finite() && *weight < 1.0).then_some(weights)
}
