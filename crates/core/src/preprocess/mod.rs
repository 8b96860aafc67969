//! Preprocessing: turns a recorded picture into the input of the observation models: grey values, blur, the field's
//! border and the evidence for white lines.

mod blur;
mod border;
mod carpet;
mod distance;
mod grey;
mod line_points;
mod prepared;
mod strips;
mod texture;
mod white_line;

pub use self::{
    blur::{gaussian_blur, gaussian_kernel},
    border::{BorderDetector, CELL_PX, FieldBorder},
    carpet::CarpetColor,
    distance::{DISTANCE_RADIUS_PX, DISTANCE_UNITS_PER_PX, distance_field},
    grey::{LUMA_WEIGHTS, luma, whiteness},
    line_points::LinePoints,
    prepared::{Prepared, Preprocessor},
    texture::Texture,
    white_line::{LineScale, WhiteLevels, white_levels, white_line_evidence},
};
