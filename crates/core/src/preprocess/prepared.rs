//! A picture with everything that the observation models read.

use crate::mount::MountPose;
use std::sync::Arc;

use image::{GrayImage, RgbImage};

use super::{
    BorderDetector, FieldBorder, LineScale, WhiteLevels,
    line_points::{LinePoints, LineScan},
    luma, white_levels, white_line_evidence, whiteness,
};
use crate::camera::Camera;

/// Picture that is ready to be scored.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Original picture.
    pub picture: Arc<RgbImage>,
    /// Smallest of the three channels of each pixel: bright only on white.
    pub whiteness: GrayImage,
    /// Whiteness of carpet and lines.
    pub levels: WhiteLevels,
    /// White pixels in some of the rows, column and row each: enough of them to tell where lines are.
    pub white_pixels: Vec<[u32; 2]>,
    /// Border of the field.
    pub border: FieldBorder,
    scale: LineScale,
}

impl Prepared {
    /// Computes the grey values. The result is not cached: not every observation model needs it.
    pub fn luma(&self) -> GrayImage {
        luma(&self.picture)
    }

    /// Computes the white pixels (255) inside the border. The result is not cached, as with [`Prepared::luma`].
    pub fn evidence(&self) -> GrayImage {
        white_line_evidence(&self.whiteness, &self.border, self.scale, &self.levels)
    }

    /// Finds points on the centres of the white lines inside the border. Of the camera's
    /// pose only the mount's part is used, to know about how broad lines are. The result is not cached, as with
    /// [`Prepared::luma`].
    pub fn line_points(&self) -> LinePoints {
        let Self { picture, whiteness, border, scale, levels, .. } = self;
        LineScan { picture, whiteness, border, scale: *scale, levels }.line_points()
    }
}

/// Prepares pictures of one camera on one field.
#[derive(Debug, Clone)]
pub struct Preprocessor {
    border: BorderDetector,
    focal_px: f32,
    line_width_m: f32,
}

impl Preprocessor {
    /// Makes a preprocessor for pictures of this camera on a field with lines of this width, metres.
    pub fn new(camera: &Camera, line_width_m: f64) -> Self {
        let focal_px = (0.5 * (camera.fx + camera.fy)) as f32;
        Self { border: BorderDetector::new(camera), focal_px, line_width_m: line_width_m as f32 }
    }

    /// Prepares a picture taken with this mount pose.
    pub fn prepare(&self, picture: impl Into<Arc<RgbImage>>, mount: MountPose) -> Prepared {
        let picture = picture.into();
        let (border, whiteness) = rayon::join(|| self.border.detect(&picture, mount), || whiteness(&picture));
        let scale = LineScale {
            focal_px: self.focal_px,
            line_width_m: self.line_width_m,
            height_m: mount.height_m as f32,
        };
        let (levels, white_pixels) = white_levels(&whiteness, &border, scale);
        Prepared { picture, whiteness, levels, white_pixels, border, scale }
    }
}
