//! Where the pixels of a picture drawn from others came from.

/// Where a pixel of a reconstruction came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// The source that it came from most, or [`Origin::NOWHERE`].
    pub source: u8,
    /// How far it can be trusted, 0 to 255: high where a neighbour saw the ground from the same direction at the same
    /// resolution and no other contradicts.
    pub trust: u8,
}

impl Origin {
    /// No source saw this: the colour is that of the surroundings.
    pub const NOWHERE: u8 = u8::MAX;

    /// The camera sees nothing there, outside its image circle say: the colour is black.
    pub const OUTSIDE: u8 = u8::MAX - 1;

    /// Whether some source saw this.
    pub fn is_recorded(self) -> bool {
        self.source < Self::OUTSIDE
    }
}
