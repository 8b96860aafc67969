//! Rectangles of pixels.

/// Rectangle of whole pixels; the right column and the lower row are the first ones outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct PixelBox {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// First column to the right of it.
    pub right: u32,
    /// First row below it.
    pub bottom: u32,
}

impl PixelBox {
    /// Returns the box around one pixel.
    pub fn around(u: u32, v: u32) -> Self {
        Self { left: u, top: v, right: u + 1, bottom: v + 1 }
    }

    /// Returns the pixels, of a picture of this size, that a region from `least` to `most` touches: a pixel reaches half a
    /// pixel around its centre, which has whole coordinates. `None` where it touches none, or a number is NaN.
    pub fn touched(least: [f64; 2], most: [f64; 2], size: [u32; 2]) -> Option<Self> {
        let first = |axis: usize| (least[axis] + 0.5).floor().max(0.0);
        let end = |axis: usize| ((most[axis] + 0.5).floor() + 1.0).min(f64::from(size[axis]));
        let is_some = (0..2).all(|axis| most[axis] >= least[axis] && first(axis) < end(axis));
        is_some.then(|| Self {
            left: first(0) as u32,
            top: first(1) as u32,
            right: end(0) as u32,
            bottom: end(1) as u32,
        })
    }

    /// Returns the box of all pixels of a picture.
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self { left: 0, top: 0, right: width, bottom: height }
    }

    /// Returns the number of columns.
    pub fn width(self) -> u32 {
        self.right.saturating_sub(self.left)
    }

    /// Returns the number of rows.
    pub fn height(self) -> u32 {
        self.bottom.saturating_sub(self.top)
    }

    /// Whether the box contains no pixel.
    pub fn is_empty(self) -> bool {
        self.width() == 0 || self.height() == 0
    }

    /// Whether the box contains a pixel.
    pub fn contains(self, u: u32, v: u32) -> bool {
        (self.left..self.right).contains(&u) && (self.top..self.bottom).contains(&v)
    }

    /// Returns the smallest box around both; an empty one adds nothing.
    pub fn union(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        }
        if other.is_empty() {
            return self;
        }
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    /// Returns the box with a margin around it, inside a picture of this size.
    pub(crate) fn grown(self, margin: u32, [width, height]: [u32; 2]) -> Self {
        Self {
            left: self.left.saturating_sub(margin),
            top: self.top.saturating_sub(margin),
            right: self.right.saturating_add(margin).min(width),
            bottom: self.bottom.saturating_add(margin).min(height),
        }
    }

    /// Whether the boxes share a pixel.
    pub(crate) fn meets(self, other: Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }
}
