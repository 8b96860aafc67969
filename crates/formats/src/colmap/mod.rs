//! COLMAP's models: `cameras`, `images` and `points3D`, as text and as binary files.
//!
//! The formats are those of COLMAP's page "Output Format". A pixel's centre is (0.5, 0.5) there and (0, 0) here; a pose is the
//! camera's axes from the world's (`camera_from_world`), its quaternion begins with w.

mod binary;
mod bytes;
mod camera;
mod folders;
mod image;
mod import;
mod model;
mod text;
mod write;

pub use self::{
    camera::{ColmapCamera, ColmapLens},
    folders::{MODEL_FOLDER, TIMESTAMPS_FILE, is_colmap},
    image::{ColmapImage, Keypoint},
    import::{read_colmap, read_colmap_as_sequence},
    model::{ColmapModel, ColmapPoint},
    write::{Encodings, write_colmap},
};
