//! Parameters of effects that can be fitted. Each is a column of the linearised model.

use reality_sim_sensor::{Effect, EffectIndex, Growth, Model, Parameter, Role};

/// Parameter of an effect that is fitted.
///
/// What is fitted is its coordinate: the distance from the neutral value (or its square, see [`Growth`]) in units of the
/// range.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FittedParameter {
    pub(crate) effect: EffectIndex,
    /// Index among the effect's parameters.
    pub(crate) parameter: usize,
}

impl FittedParameter {
    pub(crate) fn effect(&self) -> &'static dyn Effect {
        self.effect.effect()
    }

    pub(crate) fn parameter(&self) -> &'static Parameter {
        &self.effect().parameters()[self.parameter]
    }

    pub(crate) fn is_size(&self) -> bool {
        self.parameter().role == Role::Size
    }

    /// Unit of the coordinate: the parameter's largest distance from neutral (or its square), so that all columns have
    /// comparable sizes.
    pub(crate) fn scale(&self) -> f64 {
        let [low, high] = self.parameter().range;
        self.unscaled((high - self.parameter().neutral).max(self.parameter().neutral - low))
    }

    /// Returns the coordinate, before scaling, of a difference from the neutral value.
    fn unscaled(&self, difference: f64) -> f64 {
        match self.parameter().growth {
            Growth::Linear => difference,
            Growth::Square => difference * difference,
        }
    }

    /// Returns the coordinate of a value of the parameter.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        self.unscaled(value - self.parameter().neutral) / self.scale()
    }

    /// Returns the parameter's value at a coordinate, clamped to its range.
    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        let parameter = self.parameter();
        let scaled = coordinate * self.scale();
        let difference = match parameter.growth {
            Growth::Linear => scaled,
            Growth::Square => scaled.max(0.0).sqrt(),
        };
        (parameter.neutral + difference).clamp(parameter.range[0], parameter.range[1])
    }

    /// Returns the distance from the neutral value at a positive coordinate.
    pub(crate) fn size(&self, coordinate: f64) -> f64 {
        let scaled = coordinate * self.scale();
        match self.parameter().growth {
            Growth::Linear => scaled,
            Growth::Square => scaled.sqrt(),
        }
    }

    /// Returns the standard deviation of the parameter's value at a coordinate with the standard deviation `sigma`, to first
    /// order.
    pub(crate) fn value_sigma(&self, coordinate: f64, sigma: f64) -> f64 {
        let scaled = sigma * self.scale();
        match self.parameter().growth {
            Growth::Linear => scaled,
            Growth::Square => {
                let size = (coordinate * self.scale()).max(0.0).sqrt();
                if size > 0.0 { scaled / (2.0 * size) } else { scaled.sqrt() }
            }
        }
    }

    /// Returns the coordinate of this parameter in a model; that of the neutral value if the model lacks the effect.
    pub(crate) fn coordinate_in(&self, model: &Model) -> f64 {
        let value = model
            .values(self.effect().id())
            .map_or(self.parameter().neutral, |values| values[self.parameter]);
        self.coordinate(value)
    }
}

/// Returns every parameter that can be fitted, effect by effect, without those of the effects whose ids are excluded.
pub(crate) fn fitted_parameters(excluded: &[String]) -> Vec<FittedParameter> {
    EffectIndex::all()
        .filter(|effect| !excluded.iter().any(|id| id == effect.effect().id()))
        .flat_map(|effect| {
            let parameters = effect.effect().parameters().iter().enumerate();
            parameters
                .filter(|(_, parameter)| parameter.role != Role::Fixed)
                .map(move |(parameter, _)| FittedParameter { effect, parameter })
        })
        .collect()
}
