//! Sizes of hidden effects in detection limits of the recording that they are hidden in.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    error::Error,
};

use reality_sim::sensor::{Role, effect};
use reality_sim_hidden::{Hidden, Random};

use crate::{
    plan::{Part, Task},
    run,
    truth::{hidden_size, main_size, parameters},
};

/// Largest size of a hidden effect, as a fraction of its plausible range.
const LARGEST: f64 = 0.8;
/// Largest plausible factor of the noise's standard deviation.
const LARGEST_NOISE_FACTOR: f64 = 4.0;

/// Detection limits of a recording by effect: name of the parameter and its size.
type OfRecording = BTreeMap<String, (String, f64)>;

/// Detection limits by seed and picture size, each determined in that recording with nothing hidden.
#[derive(Default)]
pub struct Limits(BTreeMap<(u64, [u32; 2]), OfRecording>);

impl Limits {
    /// Returns an effect's size as a multiple of [`Hidden::of`]'s, and in the recording's detection limits. None if the
    /// effect cannot be seen in that recording.
    pub fn size(
        &mut self,
        task: &Task,
        id: &str,
        in_limits: f64,
    ) -> Result<Option<(f64, f64)>, Box<dyn Error>> {
        let limits = match self.0.entry((task.seed, task.picture)) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(unknown) => {
                let nothing = Task { part: Part::Nulls, effects: Vec::new(), without: None, ..task.clone() };
                unknown.insert(run::run(&nothing, &[])?.limits)
            }
        };
        let Some((parameter, limit)) = limits.get(id) else { return Ok(None) };
        let unit = Hidden::of(id, 1.0, &mut Random::new(task.seed.wrapping_mul(77)))?;
        let limit = hidden_size(&unit, *limit);
        let known = parameters(&unit).into_iter().find(|(name, _)| name == parameter);
        let per_multiple = known.map_or(main_size(&unit), |(_, value)| value).abs();
        let largest = LARGEST * reach(id, &unit) / main_size(&unit).abs();
        let multiple = (in_limits * limit / per_multiple).min(largest);
        Ok(Some((multiple, multiple * per_multiple / limit)))
    }
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
