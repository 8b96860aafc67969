//! Origin of the pixels of a warped picture.

/// Which picture a pixel came from, and how far to trust it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Index of the source that contributed most, or [`Origin::NOWHERE`].
    pub source: u8,
    /// Trust, 0 to 255: high if a neighbour saw the ground from the same direction at the same resolution, and no other
    /// contradicts it.
    pub trust: u8,
}

impl Origin {
    /// No source saw this pixel: its colour is continued from the surroundings.
    pub const NOWHERE: u8 = u8::MAX;

    /// The camera sees nothing at this pixel, for example outside its image circle: it is black.
    pub const OUTSIDE: u8 = u8::MAX - 1;

    /// Returns whether some source saw this pixel.
    pub fn is_recorded(self) -> bool {
        self.source < Self::OUTSIDE
    }
}
