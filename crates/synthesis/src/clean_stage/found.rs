//! Masks of pictures: what stood in front of the ground.

use reality_sim_core::warp::ProxyGeometry;
use reality_sim_db::ImageMask;

use super::{
    blobs::{Bits, things},
    differences::{excesses, gain, noise},
    goal_volumes::GoalVolumes,
    mosaic::Mosaic,
    predicted::{Expected, GroundPyramid, Predicted, predict},
    upright::with_upper_parts,
};
use crate::shrunk::ShrunkPicture;

/// Error of a pose, pixels of small pictures, that is always allowed for: lines are fitted to about one pixel of the whole picture,
/// and the mosaic's cells are about as large.
const POSE_ERROR_PX: usize = 2;
/// Difference from which a pixel may belong to a thing, in standard deviations of those that show the ground.
const DIFFERS: f32 = 3.0;
/// Smallest such difference, grey levels.
const LEAST_DIFFERS: f32 = 10.0;
/// Difference of strong evidence, in those of the weak one.
const STRONG: f32 = 2.0;
/// Smallest number of pixels with strong evidence of a thing.
const LEAST_STRONG: usize = 5;

/// Scene without things, by which masks are found.
pub(super) struct EmptyScene<'a> {
    pub mosaic: &'a Mosaic,
    pub pyramid: GroundPyramid,
    pub proxy: &'a ProxyGeometry,
    pub goals: &'a GoalVolumes,
}

impl EmptyScene<'_> {
    fn predict(&self, picture: &ShrunkPicture) -> Predicted {
        predict(picture, self.mosaic, &self.pyramid, self.proxy, self.goals)
    }

    /// Finds the pixels that show things in front of the ground, and evens the picture.
    pub fn things_in(&self, picture: &mut ShrunkPicture) -> Things {
        let predicted = self.predict(picture);
        if let Some(gain) = gain(picture, &predicted) {
            picture.gain = gain;
        }
        let differs = (DIFFERS * noise(picture, &predicted)).max(LEAST_DIFFERS);
        let excesses = excesses(picture, &predicted, POSE_ERROR_PX);
        let pixels = excesses.iter().zip(&predicted.pixels);
        let weak = pixels.map(|(excess, expected)| {
            excess.is_some_and(|excess| excess > differs) || *expected == Expected::NeverEmpty
        });
        let strong = excesses.iter().map(|excess| excess.is_some_and(|excess| excess > STRONG * differs));
        let [weak, strong] = [weak.collect(), strong.collect()].map(|bits| Bits::new(predicted.width, bits));
        let mut pixels = things(&weak, &strong, LEAST_STRONG);
        for (is_thing, expected) in pixels.pixels.iter_mut().zip(&predicted.pixels) {
            *is_thing &= *expected != Expected::NoGround;
        }
        Things { pixels, predicted }
    }

    /// Finds the pixels that show things, also where they stand out over the ground. Other pictures, whose masks count, tell what the
    /// hall looks like behind them.
    pub fn whole_things_in(&self, picture: &mut ShrunkPicture, others: &[ShrunkPicture]) -> Bits {
        let Things { pixels, predicted } = self.things_in(picture);
        with_upper_parts(picture, &predicted, pixels, others, self.proxy)
    }
}

/// Things in front of the ground.
pub(super) struct Things {
    /// Pixels that show them.
    pub pixels: Bits,
    /// What the picture would show without them.
    predicted: Predicted,
}

/// Makes the mask that is stored of an image: each of its cells is two pixels wide and high.
pub(super) fn image_mask(things: &Bits) -> ImageMask {
    let (width, height) = (things.width, things.pixels.len() / things.width);
    let is_hidden = |column: u32, row: u32| {
        let rows = 2 * row as usize..height.min(2 * row as usize + 2);
        let columns = 2 * column as usize..width.min(2 * column as usize + 2);
        rows.into_iter().any(|row| columns.clone().any(|column| things.pixels[row * width + column]))
    };
    ImageMask::new([width.div_ceil(2), height.div_ceil(2)].map(|side| side as u32), is_hidden)
}
