//! Side of an edge on which a patch of rays lies.

/// Position of a patch of rays relative to the outline of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// No ray is inside.
    Outside,
    /// All rays are inside.
    Inside,
    /// Some rays may be inside.
    Edge,
}
