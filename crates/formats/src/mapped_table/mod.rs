//! A folder of pictures and a CSV file with any column names as a recording, by a small mapping file.
//!
//! ```toml
//! name = "walk"
//! table = "log.csv"        # relative to the mapping's folder, as the other paths
//! delimiter = ";"          # by default a comma; "\t" for a tabulator
//! images = "pictures"      # by default the mapping's own folder
//! camera = "camera.toml"
//! field = "spl"            # a preset, or a field.toml
//!
//! [columns]
//! timestamp_s = { column = "stamp", unit = "ms" }
//! image = "file"
//! odometry_x_m = { column = "x", unit = "mm" }
//! odometry_y_m = { column = "y", unit = "mm", sign = -1 }
//! odometry_yaw_rad = { column = "heading", unit = "deg" }
//! pitch_rad = { column = "head_pitch", unit = "deg", offset = 1.5 }
//! roll_rad = { value = 0.0 }
//! ```
//!
//! A value is `sign · column + offset`, both in the column's unit; `value` stands for a column that is not there. The names on the
//! left are those of `frames.csv`; `reference_x_m`, `reference_y_m`, `reference_yaw_rad`, and also `reference_height_m`,
//! `reference_pitch_rad`, `reference_roll_rad`, give reference poses.

mod mapping;
mod rows;
mod target;

use std::{
    fs,
    path::{Path, PathBuf},
};

use reality_sim_core::{
    field::FieldDimensions,
    pose::CameraPose,
    sequence::{Sequence, check_image, read_camera, read_field, write_atomically},
};

use self::mapping::Mapping;
use crate::{
    file::{MAX_PICTURE_BYTES, read_bytes},
    model_error::{ModelError, ModelFault},
    posed::IMAGES,
};

/// Reads a table by its mapping file and writes it, with its pictures, as a recording. Returns the number of frames. Fails with the
/// file, line and column of the first value that is missing or impossible.
pub fn read_table_as_sequence(mapping: &Path, out: &Path) -> Result<usize, ModelError> {
    let folder = mapping.parent().unwrap_or(Path::new("")).to_path_buf();
    let mapping = Mapping::read(mapping)?;
    let setup = read_camera(&folder.join(&mapping.camera))?;
    let field = field(&folder, &mapping.field)?;
    let mut frames = rows::frames(&folder.join(&mapping.table), &mapping, setup.mount_height_m)?;
    let images = mapping.images.as_ref().map_or(folder.clone(), |images| folder.join(images));
    let pictures: Vec<PathBuf> = frames.iter().map(|frame| images.join(&frame.image)).collect();
    for (index, (frame, picture)) in frames.iter_mut().zip(&pictures).enumerate() {
        let bytes = read_bytes(picture, MAX_PICTURE_BYTES)?;
        check_image(picture, &bytes, [setup.camera.width, setup.camera.height])?;
        let ending = if bytes.starts_with(b"\x89PNG") { "png" } else { "jpg" };
        frame.image = Path::new(IMAGES).join(format!("{index:06}.{ending}"));
        let folder = out.join(IMAGES);
        fs::create_dir_all(&folder)
            .map_err(|error| ModelError::of_file(&folder, ModelFault::Unwritable(error)))?;
        write_atomically(&out.join(&frame.image), &bytes)?;
    }
    let count = frames.len();
    let sequence = Sequence {
        folder: out.to_path_buf(),
        files: Vec::new(),
        name: mapping.name,
        setup,
        field,
        start: frames.first().and_then(|frame| frame.reference_pose).map(CameraPose::planar),
        frames,
        poses_between_frames: Vec::new(),
        calibration: None,
        corrected_by: None,
    };
    sequence.write(out)?;
    Ok(count)
}

fn field(folder: &Path, name: &str) -> Result<FieldDimensions, ModelError> {
    match FieldDimensions::preset(name) {
        Some(field) => Ok(field),
        None => Ok(read_field(&folder.join(name))?),
    }
}
