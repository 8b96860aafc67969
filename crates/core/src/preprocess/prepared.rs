//! Everything the observation models read of one picture.

use image::{GrayImage, RgbImage};

use super::{Attitude, BorderDetector, FieldBorder, WhiteLevels, luma, white_line_evidence, whiteness};
use crate::camera::Camera;

/// A picture ready to be scored.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Grey values.
    pub luma: GrayImage,
    /// Smallest channel: bright only on white.
    pub whiteness: GrayImage,
    /// White pixels (255) inside the border.
    pub evidence: GrayImage,
    /// Whiteness of carpet and lines.
    pub levels: WhiteLevels,
    /// The field's border.
    pub border: FieldBorder,
}

/// Prepares pictures of one camera.
#[derive(Debug, Clone)]
pub struct Preprocessor {
    border: BorderDetector,
}

impl Preprocessor {
    /// For pictures of this camera.
    pub fn new(camera: &Camera) -> Self {
        Self { border: BorderDetector::new(camera) }
    }

    /// Prepares a picture taken with this attitude.
    pub fn prepare(&self, picture: &RgbImage, attitude: Attitude) -> Prepared {
        let (border, (luma, whiteness)) =
            rayon::join(|| self.border.detect(picture, attitude), || (luma(picture), whiteness(picture)));
        let (evidence, levels) = white_line_evidence(&whiteness, &border);
        Prepared { luma, whiteness, evidence, levels, border }
    }
}
