//! Luma of colour pixels.

/// Weights of red, green and blue in luma (ITU-R BT.601).
pub(crate) const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
