//! On which side of an edge a patch of rays lies.

/// Place of a patch of rays relative to the outline of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// None of its rays is inside.
    Outside,
    /// All of them are.
    Inside,
    /// Perhaps some.
    Edge,
}
