//! Gains that match the brightness of neighbours: exposure and white balance differ from picture to picture.
//!
//! For every pair of neighbours and every channel, the ratio of their colours is measured at the places that both see, and
//! its median is taken; from these medians, least squares gives a gain for each neighbour. The geometric mean of the gains
//! is 1, except where some are clipped.

use nalgebra::{DMatrix, DVector};
use reality_sim_core::{
    statistics::median,
    warp::{Look, Source},
};

/// Usable grey values: darker ones are noise, brighter ones are saturated.
const USABLE: std::ops::Range<f32> = 10.0..245.0;

/// Smallest number of common places at which a pair is compared.
const LEAST_PLACES: usize = 8;

/// Weight of the prior that a gain is 1, as a number of places.
const PRIOR_PLACES: f64 = 2.0;

/// Largest change of a neighbour's brightness, up or down: beyond this it must show something else.
const LARGEST_GAIN: f64 = 2.0;

/// Returns a gain for red, green and blue of each source.
pub(crate) fn gains(look: &Look, sources: &[Source]) -> Vec<[f32; 3]> {
    let seen: Vec<Vec<Option<[f32; 3]>>> = sources.iter().map(|source| look.colors(source)).collect();
    let channels = [0, 1, 2].map(|channel| channel_gains(&seen, channel));
    (0..sources.len()).map(|source| [0, 1, 2].map(|channel| channels[channel][source])).collect()
}

fn channel_gains(seen: &[Vec<Option<[f32; 3]>>], channel: usize) -> Vec<f32> {
    let count = seen.len();
    let mut normal = DMatrix::identity(count, count) * PRIOR_PLACES;
    let mut right = DVector::zeros(count);
    for a in 0..count {
        for b in a + 1..count {
            let Some((log_ratio, places)) = median_log_ratio(&seen[a], &seen[b], channel) else { continue };
            // log gain a − log gain b = log (b / a).
            normal[(a, a)] += places;
            normal[(b, b)] += places;
            normal[(a, b)] -= places;
            normal[(b, a)] -= places;
            right[a] += places * log_ratio;
            right[b] -= places * log_ratio;
        }
    }
    let limit = LARGEST_GAIN.ln();
    // The matrix is positive definite by its prior.
    let logs = normal.cholesky().map_or(DVector::zeros(count), |normal| normal.solve(&right));
    logs.iter().map(|log| log.clamp(-limit, limit).exp() as f32).collect()
}

/// Median of log (b / a), and the number of places that it was taken over.
fn median_log_ratio(a: &[Option<[f32; 3]>], b: &[Option<[f32; 3]>], channel: usize) -> Option<(f64, f64)> {
    let both = a.iter().zip(b).filter_map(|(a, b)| Some(((*a)?[channel], (*b)?[channel])));
    let usable = both.filter(|(a, b)| USABLE.contains(a) && USABLE.contains(b));
    let logs: Vec<f64> = usable.map(|(a, b)| f64::from(b / a).ln()).collect();
    if logs.len() < LEAST_PLACES {
        return None;
    }
    let places = logs.len() as f64;
    Some((median(logs), places))
}
