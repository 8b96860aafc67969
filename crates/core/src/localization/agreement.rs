//! How well a pose and a picture agree, both ways.

/// Agreement of a pose with a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Agreement {
    /// Fraction of the line in view that the picture shows where the pose projects it.
    pub line_fraction: f64,
    /// Fraction of the white lines in the picture that are lines of the field as seen from the pose.
    pub explained_fraction: f64,
    /// Whether the pose is next to the one that fits best around it.
    pub is_at_fit: bool,
}
