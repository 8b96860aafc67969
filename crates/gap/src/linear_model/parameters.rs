//! The parameters that can be fitted, each a column of the linearised model.

use reality_sim_sensor::{Effect, EffectIndex, Growth, Model, Parameter, Role};

/// A parameter of an effect as a fit sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FittedParameter {
    pub(crate) effect: EffectIndex,
    /// Index of the parameter in the effect's.
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

    /// One unit of the fitted number: the parameter's range (or its square), so that all columns are of one size.
    pub(crate) fn scale(&self) -> f64 {
        let [low, high] = self.parameter().range;
        self.grown((high - self.parameter().neutral).max(self.parameter().neutral - low))
    }

    /// The fitted number, unscaled, for a difference from the neutral value.
    fn grown(&self, difference: f64) -> f64 {
        match self.parameter().growth {
            Growth::Linear => difference,
            Growth::Square => difference * difference,
        }
    }

    /// The fitted number of a parameter's value.
    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        self.grown(value - self.parameter().neutral) / self.scale()
    }

    /// The parameter's value of a fitted number, within its range.
    pub(crate) fn value(&self, coordinate: f64) -> f64 {
        let parameter = self.parameter();
        let scaled = coordinate * self.scale();
        let difference = match parameter.growth {
            Growth::Linear => scaled,
            Growth::Square => scaled.max(0.0).sqrt(),
        };
        (parameter.neutral + difference).clamp(parameter.range[0], parameter.range[1])
    }

    /// Distance from the neutral value, whatever its sign, of a fitted number above zero.
    pub(crate) fn size(&self, coordinate: f64) -> f64 {
        let scaled = coordinate * self.scale();
        match self.parameter().growth {
            Growth::Linear => scaled,
            Growth::Square => scaled.sqrt(),
        }
    }

    /// Standard deviation of the parameter's value, of that of the fitted number.
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

    /// Where this parameter is now.
    pub(crate) fn coordinate_in(&self, model: &Model) -> f64 {
        let value = model
            .values(self.effect().id())
            .map_or(self.parameter().neutral, |values| values[self.parameter]);
        self.coordinate(value)
    }
}

/// Every parameter that can be fitted, effect by effect.
pub(crate) fn columns(excluded: &[String]) -> Vec<FittedParameter> {
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
