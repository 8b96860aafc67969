//! Curves of the field.

/// Index of a curve among [`FieldDimensions::curves`](reality_sim_core::field::FieldDimensions::curves).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct CurveIndex(pub(crate) usize);
