//! Random field of the reflectance: its patches with the variances of their increments.

use super::{
    increments::IncrementVariances,
    tree::{PatchIndex, Tree},
};

/// Random field of the reflectance: its patches with the variances of their increments.
#[derive(Debug, Clone)]
pub(crate) struct ReflectanceField {
    pub(crate) tree: Tree,
    pub(crate) variances: IncrementVariances,
}

impl ReflectanceField {
    /// Creates the field of these patches with the usual variances.
    pub(crate) fn new(tree: Tree) -> Self {
        Self { tree, variances: IncrementVariances::usual() }
    }

    /// Returns the field with which the colours together tell no more than one of them: that a place is bright, all three show,
    /// although each colour has values of its own.
    pub(crate) fn of_shared_brightness(self) -> Self {
        Self { variances: self.variances.of_shared_brightness(), ..self }
    }

    /// Returns the prior precision of a patch's increment.
    pub(crate) fn precision(&self, patch: PatchIndex) -> f64 {
        self.variances.of(self.tree.scale(patch)).recip()
    }

    /// Returns the increments of all patches for these values.
    pub(super) fn increments<'a>(
        &'a self,
        values: &'a [f64],
    ) -> impl Iterator<Item = (PatchIndex, f64)> + 'a {
        self.tree.patches().map(|patch| {
            let parent = self.tree.parent(patch).map_or(0.0, |parent| values[parent.0]);
            (patch, values[patch.0] - parent)
        })
    }

    /// Returns minus the logarithm of the prior density of these values, up to a constant.
    pub(crate) fn energy(&self, values: &[f64]) -> f64 {
        0.5 * self.prior_product(values, values)
    }

    /// Returns `aᵀ Q b` with the prior precision matrix `Q` of all values.
    pub(crate) fn prior_product(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = self.increments(a).zip(self.increments(b));
        pairs.map(|((patch, a), (_, b))| self.precision(patch) * a * b).sum()
    }
}
