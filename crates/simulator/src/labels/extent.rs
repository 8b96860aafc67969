//! Pixels that a thing covers: how many, and the box around them.

/// Number of some pixels and the box around them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Number of the pixels.
    pub count: u32,
    /// First column and first row.
    pub min: [u32; 2],
    /// Last column and last row.
    pub max: [u32; 2],
}

impl Extent {
    /// No pixel.
    pub const NONE: Self = Self { count: 0, min: [u32::MAX; 2], max: [0; 2] };

    /// Adds the pixel in a column and a row.
    pub fn add(&mut self, pixel: [u32; 2]) {
        self.merge(Self { count: 1, min: pixel, max: pixel });
    }

    /// Adds other pixels.
    pub fn merge(&mut self, other: Self) {
        self.count += other.count;
        for axis in 0..2 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }
}
