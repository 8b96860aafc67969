//! Distance of lines from where the true pose projects them.

use image::RgbImage;
use reality_sim::{
    Camera, CameraPose, FieldDimensions,
    field::{sample_lines, visible_samples},
    preprocess::{Texture, whiteness},
    refine::{MeasureConfig, measure_offsets},
};

/// Distance between samples along the lines, metres.
const SPACING_M: f64 = 0.02;
/// Distance between samples in the picture, pixels.
const SPACING_PX: f64 = 4.0;
/// Search range for lines around their projection, pixels, and their least contrast, grey levels.
const MEASURE: MeasureConfig = MeasureConfig { search_px: 8.0, min_contrast: 30.0 };

/// Measured and projected lines of pictures.
#[derive(Default)]
pub struct Lines {
    /// Distances between measured and projected lines, where both exist, pixels.
    pub displacements_px: Vec<f64>,
    /// Number of places at which a line is projected.
    pub projected: usize,
}

impl Lines {
    /// Adds the lines of a picture.
    pub fn add(&mut self, picture: &RgbImage, camera: &Camera, field: &FieldDimensions, pose: CameraPose) {
        let (found, projected) = displacements_px(picture, camera, field, pose);
        self.displacements_px.extend(found);
        self.projected += projected;
    }
}

fn displacements_px(
    picture: &RgbImage,
    camera: &Camera,
    field: &FieldDimensions,
    pose: CameraPose,
) -> (Vec<f64>, usize) {
    let clear = |sample: &_| -> bool {
        let sample: &reality_sim::field::LineSample = sample;
        sample.clearance_m > 1.5 * field.line_width_m
    };
    let samples: Vec<_> = sample_lines(field, SPACING_M).into_iter().filter(clear).collect();
    let visible = visible_samples(field, &samples, camera, pose, SPACING_PX);
    let found = measure_offsets(&Texture::pack(&whiteness(picture)), &visible, MEASURE);
    (found.iter().map(|offset| offset.offset_px.abs()).collect(), visible.len())
}
