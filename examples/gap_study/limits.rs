//! Sizes of hidden effects in detection limits of the recording that they are hidden in.

use std::error::Error;

use reality_sim::sensor::{Role, effect};
use reality_sim_hidden::{Hidden, Random};

use crate::{
    plan::{Chosen, Task},
    run::Limits,
    truth::{hidden_size, main_size, parameters},
};

/// Largest size of a hidden effect, as a fraction of its plausible range.
const LARGEST: f64 = 0.8;
/// Largest plausible factor of the noise's standard deviation.
const LARGEST_NOISE_FACTOR: f64 = 4.0;

/// Returns an effect at a size in detection limits of the task's recording. None if the effect cannot be seen there, or if
/// the size is not plausible.
pub fn chosen(
    task: &Task,
    id: &str,
    in_limits: f64,
    limits: &Limits,
) -> Result<Option<Chosen>, Box<dyn Error>> {
    let Some((parameter, limit)) = limits.get(id) else { return Ok(None) };
    let unit = Hidden::of(id, 1.0, &mut Random::new(task.seed.wrapping_mul(77)))?;
    let limit = hidden_size(&unit, *limit, task.recipe().facts().noise_shot);
    let known = parameters(&unit).into_iter().find(|(name, _)| name == parameter);
    let per_multiple = known.map_or(main_size(&unit), |(_, value)| value).abs();
    let largest = LARGEST * reach(id, &unit) / main_size(&unit).abs();
    let multiple = (in_limits * limit / per_multiple).min(largest);
    let reached = multiple * per_multiple / limit;
    // What is asked for at six limits may be at three, if it cannot plausibly be larger.
    let enough = reached > 0.99 * in_limits.min(crate::plan::CLEAR);
    Ok(enough.then(|| Chosen { id: id.to_owned(), multiple, in_limits: reached }))
}

/// Returns how far an effect's first size may plausibly be from its neutral value, on the side on which it is hidden.
fn reach(id: &str, unit: &Hidden) -> f64 {
    let first = effect(id)
        .and_then(|effect| effect.parameters().iter().find(|parameter| parameter.role == Role::Size));
    let is_below = parameters(unit).iter().any(|(_, value)| *value < 0.0);
    match (unit, first) {
        // A factor, whereas the library's parameters are variances.
        (Hidden::SensorNoise { .. }, _) => LARGEST_NOISE_FACTOR,
        (_, Some(parameter)) if is_below => parameter.neutral - parameter.range[0],
        (_, Some(parameter)) => parameter.range[1] - parameter.neutral,
        (_, None) => f64::INFINITY,
    }
}
