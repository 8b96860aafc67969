//! Pictures that show an effect, in a temporary folder.

use image::{ExtendedColorType, ImageEncoder, RgbImage, codecs::jpeg::JpegEncoder};
use rayon::prelude::*;
use reality_sim_core::{
    pose::CameraPose,
    sequence::{Sequence, decode_image, save_image, write_atomically},
};
use reality_sim_sensor::Redevelopment;
use tempfile::TempDir;

use super::error::InjectionError;
use crate::measurement::quantization::luma_steps;

/// Seed of the noise that is added.
const SEED: u64 = 1;

/// Writes the pictures of all frames with a pose as the other camera would have recorded them, and makes `changed` refer to them.
pub(super) fn with(
    sequence: &Sequence,
    redevelopment: &Redevelopment<'_>,
    changed: &mut Sequence,
) -> Result<TempDir, InjectionError> {
    let folder = tempfile::tempdir().map_err(InjectionError::Folder)?;
    let size = [sequence.setup.camera.width, sequence.setup.camera.height];
    let write = |index: usize, pose: CameraPose| -> Result<(), InjectionError> {
        let Ok(bytes) = sequence.image_bytes(index) else { return Ok(()) };
        let Ok(picture) = decode_image(&sequence.image_path(index)?, &bytes, size) else { return Ok(()) };
        let picture = redevelopment.picture(&picture, pose, sequence.frames[index].timestamp_s, SEED);
        let path = folder.path().join(file_name(index, &bytes));
        match quality_like(&bytes) {
            Some(quality) => write_atomically(&path, &jpeg(&picture, quality))?,
            None => save_image(&path, &picture)?,
        }
        Ok(())
    };
    let poses = sequence.frames.iter().map(|frame| frame.reference_pose);
    let frames: Vec<(usize, CameraPose)> =
        poses.enumerate().filter_map(|(index, pose)| Some((index, pose?))).collect();
    frames.par_iter().try_for_each(|&(index, pose)| write(index, pose))?;
    for (index, _) in frames {
        // A picture that cannot be read is left out later, as it would be without the effect.
        let bytes = sequence.image_bytes(index).unwrap_or_default();
        changed.frames[index].image = file_name(index, &bytes).into();
    }
    changed.folder = folder.path().to_path_buf();
    Ok(folder)
}

fn file_name(index: usize, bytes: &[u8]) -> String {
    format!("{index:06}.{}", if quality_like(bytes).is_some() { "jpg" } else { "png" })
}

/// Returns the quality at which an encoder's quantisation of luma is most like that of a JPEG file. None for other files.
fn quality_like(bytes: &[u8]) -> Option<u8> {
    bytes.starts_with(&[0xFF, 0xD8]).then_some(())?;
    let wanted = luma_steps(bytes);
    let small = RgbImage::new(8, 8);
    let distance = |quality: u8| -> f64 {
        let steps = luma_steps(&jpeg(&small, quality));
        let pairs = steps.as_flattened().iter().zip(wanted.as_flattened());
        pairs.map(|(step, wanted)| (step / wanted).ln().abs()).sum()
    };
    (1..=100).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
}

fn jpeg(picture: &RgbImage, quality: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let (width, height) = picture.dimensions();
    // Writing to memory does not fail, and every size of a recorded picture is one of JPEG.
    let _ = JpegEncoder::new_with_quality(&mut bytes, quality).write_image(
        picture,
        width,
        height,
        ExtendedColorType::Rgb8,
    );
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jpeg_file_is_written_again_with_its_own_quality() {
        let picture = RgbImage::from_fn(32, 24, |x, y| image::Rgb([8 * x as u8, 9 * y as u8, 77]));
        for quality in [60, 85, 92] {
            assert_eq!(quality_like(&jpeg(&picture, quality)), Some(quality));
        }
        assert_eq!(quality_like(b"no picture"), None);
    }
}
