//! How far lines lie from where the true pose puts them.

use image::RgbImage;
use reality_sim::{
    Camera, CameraPose, FieldDimensions,
    field::{sample_lines, visible_samples},
    preprocess::{Texture, whiteness},
    refine::{MeasureConfig, measure_offsets},
};

/// Between the samples of the lines, metres.
const SPACING_M: f64 = 0.02;
/// Between the samples in the picture, pixels.
const SPACING_PX: f64 = 4.0;
/// Lines are looked for so far from where they should be, pixels; they stand out by so many grey levels.
const MEASURE: MeasureConfig = MeasureConfig { search_px: 8.0, min_contrast: 30.0 };

/// Lines of pictures, and those projected.
#[derive(Default)]
pub struct Lines {
    /// Distances between the two where both are, pixels.
    pub displacements_px: Vec<f64>,
    /// Places at which a line is projected.
    pub projected: usize,
}

impl Lines {
    /// Adds those of a picture.
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
