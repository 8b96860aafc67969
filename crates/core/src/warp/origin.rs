//! Origin of the pixels of a warped picture.

/// Which picture a pixel came from, and how far to trust it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Index of the source that contributed most, or one of [`Origin::NOWHERE`], [`Origin::OUTSIDE`] and [`Origin::GROUND`].
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

    /// None of the sources shows this pixel without something in front of it: it shows the ground as many pictures together saw it.
    pub const GROUND: u8 = u8::MAX - 2;

    /// Returns whether some recorded picture saw what this pixel shows.
    pub fn is_recorded(self) -> bool {
        self.source < Self::OUTSIDE
    }
}
