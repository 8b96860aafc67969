//! nerfstudio's `transforms.json`: cameras in OpenGL's axes, with the pictures beside it.
//!
//! The format is that of nerfstudio's page "Data conventions": a pose is the world's axes from the camera's, as a 4 × 4 matrix,
//! with the camera's x to the right, y up and z backwards. A pixel's centre is (0.5, 0.5) there (`Cameras.get_image_coords` adds
//! 0.5 to whole pixels) and (0, 0) here.

mod file;
mod lens;
mod matrix;
mod read;
mod write;

pub use self::{
    read::read_nerfstudio_as_sequence,
    write::{POINTS_FILE, write_nerfstudio},
};

/// Name of the file.
pub const TRANSFORMS_FILE: &str = "transforms.json";
