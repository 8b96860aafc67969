//! Columns of the linearised model.

use super::reflectance::{PatchIndex, ReflectanceField, Tree};

/// Index of a column of the Jacobian. Columns of the fitted parameters come first, followed by those of the nuisance
/// parameters and by those of the reflectance in the patches of the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct ColumnIndex(pub(crate) usize);

impl ColumnIndex {
    /// Iterates over the first `count` columns.
    pub(crate) fn first(count: usize) -> impl Iterator<Item = Self> {
        (0..count).map(Self)
    }
}

/// Numbers of columns of each kind, with the prior of the reflectance. All other columns have the prior `N(0, 1)`.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    /// Number of fitted parameters.
    pub(crate) parameters: usize,
    /// Number of nuisance parameters.
    pub(crate) nuisances: usize,
    pub(crate) field: ReflectanceField,
}

impl Columns {
    /// Creates columns of fitted parameters alone.
    pub(crate) fn of_parameters(parameters: usize) -> Self {
        Self { parameters, nuisances: 0, field: ReflectanceField::new(Tree::default()) }
    }

    /// Returns the number of columns before those of the reflectance.
    pub(crate) fn dense(&self) -> usize {
        self.parameters + self.nuisances
    }

    /// Returns the number of all columns.
    pub(crate) fn len(&self) -> usize {
        self.dense() + self.field.tree.len()
    }

    /// Returns the column of a patch's reflectance.
    pub(crate) fn of_patch(&self, patch: PatchIndex) -> ColumnIndex {
        ColumnIndex(self.dense() + patch.0)
    }

    /// Returns minus the logarithm of the prior density of the nuisance parameters and of the reflectance in a change of all
    /// columns, up to a constant.
    pub(crate) fn nuisance_energy(&self, delta: &[f64]) -> f64 {
        let (nuisances, patches) = delta[self.parameters..].split_at(self.nuisances);
        0.5 * nuisances.iter().map(|value| value * value).sum::<f64>() + self.field.energy(patches)
    }
}
