//! The picture at a pose: every stage, pixel by pixel.

use image::RgbImage;
use rayon::prelude::*;
use reality_sim_core::{field::FieldDimensions, pose::CameraPose, sequence::CameraSetup};

use crate::{SceneColors, encoding::Encoding, lens::Lens, view::View, world::World};

/// Parts along each side of a pixel that an edge crosses.
const DEFAULT_PARTS_PER_SIDE: u16 = 3;

/// A pose from which nothing can be drawn.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A coordinate is NaN or infinite.
    #[error("the camera's pose {0:?} has a coordinate that is not a finite number: give six finite ones")]
    NotFinite(CameraPose),
    /// The camera is on the ground or under it.
    #[error("the camera's height is {height_m} m: it must be above 0, the ground")]
    NotAboveGround {
        /// As given, metres.
        height_m: f64,
    },
}

/// Draws what one camera sees of one field, at any pose. Make it once: it keeps every pixel's rays.
#[derive(Debug, Clone)]
pub struct Renderer {
    world: World,
    lens: Lens,
    encoding: Encoding,
    size: [u32; 2],
    parts_per_side: u16,
}

impl Renderer {
    /// A renderer for a camera, a field and colours. The hall's walls are 3 m outside the carpet, its ceiling is 4 m
    /// above it. Pixel values follow the gamma of the camera's photometry, 2.2 where it has none.
    pub fn new(setup: &CameraSetup, field: &FieldDimensions, colors: SceneColors) -> Self {
        Self {
            world: World::new(field, colors),
            lens: Lens::new(&setup.camera),
            encoding: Encoding::new(setup.photometry.as_ref()),
            size: [setup.camera.width, setup.camera.height],
            parts_per_side: DEFAULT_PARTS_PER_SIDE,
        }
    }

    /// The same renderer with pixels that an edge crosses cut into `per_side` × `per_side` parts (0 is taken as 1);
    /// 3 × 3 unless told. What a shape covers of a part is computed, not sampled: more parts help where edges of
    /// several colours meet.
    pub fn with_parts_per_side(self, per_side: u16) -> Self {
        Self { parts_per_side: per_side.max(1), ..self }
    }

    /// The picture at a pose. Pixels beyond the camera's valid angle or outside its image circle are black.
    pub fn draw(&self, pose: CameraPose) -> Result<RgbImage, PoseError> {
        if !pose.is_finite() {
            return Err(PoseError::NotFinite(pose));
        }
        if pose.height_m <= 0.0 {
            return Err(PoseError::NotAboveGround { height_m: pose.height_m });
        }
        let view = View::new(&self.world, pose);
        let [width, height] = self.size;
        let mut picture = RgbImage::new(width, height);
        let row_length = 3 * width as usize;
        picture
            .par_chunks_exact_mut(row_length)
            .enumerate()
            .for_each(|(v, row)| self.draw_row(&view, v, row));
        Ok(picture)
    }

    fn draw_row(&self, view: &View, v: usize, row: &mut [u8]) {
        for (patch, pixel) in self.lens.row(v).iter().zip(row.as_chunks_mut::<3>().0) {
            if let Some(patch) = patch {
                *pixel = self.encoding.encode(view.color(*patch, self.parts_per_side));
            }
        }
    }
}
