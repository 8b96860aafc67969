//! Fits of sets of effects at the present model.

use nalgebra::DVector;
use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::evidence::Evidence, linear_model::column::ColumnIndex,
    linear_model::parameters::FittedParameter, linear_model::reduced_equations::Fit,
};

/// Distance from an end of its range, as a part of the range, at which a value counts as lying there: rounding.
const END_OF_RANGE: f64 = 1e-6;

/// Fits of effects by their parameters' columns.
#[derive(Debug)]
pub(crate) struct EffectFits<'a> {
    pub(crate) evidence: Evidence<'a>,
    pub(crate) columns: &'a [FittedParameter],
}

impl EffectFits<'_> {
    /// Returns the columns of some effects.
    pub(crate) fn columns_of(&self, effects: &[EffectIndex]) -> Vec<ColumnIndex> {
        let all = ColumnIndex::first(self.columns.len());
        all.filter(|column| effects.contains(&self.columns[column.0].effect)).collect()
    }

    /// Returns the columns of an effect's sizes.
    pub(crate) fn sizes_of(&self, effect: EffectIndex) -> Vec<ColumnIndex> {
        let mut columns = self.columns_of(&[effect]);
        columns.retain(|column| self.columns[column.0].is_size());
        columns
    }

    /// Returns the effects that have columns.
    pub(crate) fn effects(&self) -> Vec<EffectIndex> {
        let mut effects: Vec<EffectIndex> = self.columns.iter().map(|column| column.effect).collect();
        effects.dedup();
        effects
    }

    /// Fits effects with all parameters within their ranges: a parameter that would leave its range is held at the limit
    /// while the others are refitted. None if the fit is singular.
    pub(crate) fn fit_in_range(&self, effects: &[EffectIndex]) -> Option<Fit> {
        let mut free = self.columns_of(effects);
        let mut held = -&self.evidence.base;
        loop {
            let fit = self.evidence.fit_beside(&free, &held)?;
            let farthest = free.iter().copied().map(|column| (column, self.outside(&fit, column)));
            match farthest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
                Some((column, outside)) if outside != 0.0 => {
                    held[column.0] = fit.delta[column.0] - outside;
                    free.retain(|&other| other != column);
                }
                _ => return Some(fit),
            }
        }
    }

    /// Whether a size of an effect of the present model lies at an end of its range: then it was not measured.
    pub(crate) fn is_at_end_of_range(&self, effect: EffectIndex) -> bool {
        self.sizes_of(effect).into_iter().any(|column| {
            let parameter = self.columns[column.0].parameter();
            let value = self.columns[column.0].value(self.evidence.base[column.0]);
            let margin = END_OF_RANGE * (parameter.range[1] - parameter.range[0]);
            let at = |end: f64| end != parameter.neutral && (value - end).abs() < margin;
            at(parameter.range[0]) || at(parameter.range[1])
        })
    }

    /// Returns how far a fitted column lies beyond its range; 0 inside.
    fn outside(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        let coordinate = self.coordinate(fit, column);
        let inside = self.columns[column.0].coordinate(self.columns[column.0].value(coordinate));
        if (coordinate - inside).abs() > 1e-9 { coordinate - inside } else { 0.0 }
    }

    /// Returns the coordinate of a fitted column.
    pub(crate) fn coordinate(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        self.evidence.base[column.0] + fit.delta[column.0]
    }

    /// Returns the fitted value of a column's parameter, in the parameter's unit.
    pub(crate) fn value(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        self.columns[column.0].value(self.coordinate(fit, column))
    }
}

/// Returns a model in the coordinates of the columns.
pub(crate) fn base(columns: &[FittedParameter], model: &Model) -> DVector<f64> {
    DVector::from_iterator(columns.len(), columns.iter().map(|column| column.coordinate_in(model)))
}
