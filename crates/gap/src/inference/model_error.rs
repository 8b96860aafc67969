//! Model error: no model is exact, so its error is taken to be a fraction of what its effects explain.

use std::collections::BTreeMap;

use crate::{
    inference::held_out::HeldOutResiduals,
    inference::selected_model::SelectedModel,
    measurement::quantity::{Channel, Quantity},
    thresholds::Thresholds,
};

/// Root mean square of the change from the given model to the extended one, by quantity.
#[derive(Debug, Clone, Default)]
pub(crate) struct ModelError(BTreeMap<Quantity, f64>);

impl ModelError {
    /// Computes the model error from residuals with the given model and with the extended one, on held-out frames.
    pub(crate) fn new(found: &SelectedModel, before: &HeldOutResiduals, after: &HeldOutResiduals) -> Self {
        let mut sums: BTreeMap<Quantity, (f64, f64)> = BTreeMap::new();
        for frame in found.split.held_out() {
            let residuals = before.residuals[frame].iter().zip(&after.residuals[frame]);
            for (measurement, (before, after)) in
                found.linearized.frames[frame].measurements.iter().zip(residuals)
            {
                let change = before - after;
                if change.is_finite() {
                    let sum = sums.entry(measurement.quantity).or_default();
                    *sum = (sum.0 + change * change, sum.1 + 1.0);
                }
            }
        }
        Self(sums.into_iter().map(|(key, (sum, count))| (key, f64::sqrt(sum / count))).collect())
    }

    /// Returns the model error of a quantity, in its unit.
    pub(crate) fn off(&self, quantity: Quantity) -> f64 {
        Thresholds::DEFAULT.inference.model_error * self.0.get(&quantity).copied().unwrap_or(0.0)
    }

    /// Returns the model error of a channel: the largest of its quantities'.
    pub(crate) fn most_off(&self, channel: Channel) -> f64 {
        let quantities = self.0.keys().filter(|quantity| quantity.channel() == channel);
        quantities.map(|quantity| self.off(*quantity)).fold(0.0, f64::max)
    }

    #[cfg(test)]
    pub(crate) fn by(quantity: Quantity, size: f64) -> Self {
        Self(BTreeMap::from([(quantity, size)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::quantity::ColorChannel;

    #[test]
    fn the_model_error_is_a_fraction_of_what_the_model_explains() {
        let explained = ModelError::by(Quantity::LineLevel(ColorChannel::Blue), 0.5);
        assert_eq!(
            explained.off(Quantity::LineLevel(ColorChannel::Blue)),
            Thresholds::DEFAULT.inference.model_error * 0.5
        );
        assert_eq!(explained.off(Quantity::LineLevel(ColorChannel::Green)), 0.0);
        assert_eq!(explained.most_off(Channel::Photometry), Thresholds::DEFAULT.inference.model_error * 0.5);
        assert_eq!(explained.most_off(Channel::Geometry), 0.0);
    }
}
