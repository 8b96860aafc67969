//! Columns of the linearised model.

/// Index of a column of the Jacobian. Columns of the fitted parameters come first, followed by those of the nuisance
/// parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct ColumnIndex(pub(crate) usize);

impl ColumnIndex {
    /// Iterates over the first `count` columns.
    pub(crate) fn first(count: usize) -> impl Iterator<Item = Self> {
        (0..count).map(Self)
    }
}
