//! Pixels that a thing covers: how many, and the box around them.

use crate::pixel_box::PixelBox;

/// Number of some pixels and the box around them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Extent {
    /// Number of the pixels.
    pub(crate) count: u32,
    /// Box around them; empty if there are none.
    around: PixelBox,
}

impl Extent {
    /// Adds the pixel in a column and a row.
    #[inline]
    pub(crate) fn add(&mut self, column: u32, row: u32) {
        self.merge(Self { count: 1, around: PixelBox::around(column, row) });
    }

    /// Adds other pixels.
    #[inline]
    pub(crate) fn merge(&mut self, other: Self) {
        self.count += other.count;
        self.around = self.around.union(other.around);
    }

    /// Returns the box around the pixels, if there are any.
    pub(crate) fn around(self) -> Option<PixelBox> {
        (self.count > 0).then_some(self.around)
    }
}
