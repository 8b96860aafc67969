//! Columns of the linearised model.

/// Index of a column of the Jacobian: the fitted parameters come first, the nuisance parameters behind them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct ColumnIndex(pub(crate) usize);

impl ColumnIndex {
    /// The first so many columns.
    pub(crate) fn first(count: usize) -> impl Iterator<Item = Self> {
        (0..count).map(Self)
    }
}
