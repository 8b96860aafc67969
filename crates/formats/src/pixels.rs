//! Where pixels begin.

/// Half a pixel: what is added to our pixel coordinates, in which the first pixel's centre is (0, 0), where a format's begin at
/// that pixel's corner.
pub(crate) const HALF_PIXEL: f64 = 0.5;
