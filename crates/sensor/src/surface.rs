//! Surfaces of the field.

/// Surface of the field with a reflectance of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Surface {
    /// Painted line.
    Line,
    /// Carpet.
    Carpet,
}

impl Surface {
    /// Both surfaces.
    pub const ALL: [Self; 2] = [Self::Line, Self::Carpet];
}
