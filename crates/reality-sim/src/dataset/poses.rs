//! Poses drawn at random where pictures were recorded.

use std::f64::consts::TAU;

use glam::DVec2;

use reality_sim_core::{
    filter::{Purpose, Stream},
    pose::{CameraPose, Pose2},
};
use reality_sim_synthesis::Archive;

/// Number of poses that are drawn for a picture before it is given up: where one in ten thousand is near enough, one picture in
/// twenty thousand is. Each takes some microseconds.
const MOST_POSES: u32 = 100_000;

/// Pose drawn for a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnPose {
    pub pose: CameraPose,
    /// Time at which the picture was recorded whose height, pitch and roll the pose has, seconds.
    pub timestamp_s: f64,
    /// Number of poses that were drawn before it.
    pub before: u32,
}

/// Source of random poses: places uniform over the carpet, headings uniform, height, pitch and roll together those of one recorded
/// picture, and then only those near a recorded picture.
pub struct Poses<'a> {
    pub archive: &'a Archive,
    pub seed: u64,
    /// Largest distance of the nearest recorded picture, root mean square pixels.
    pub within_px: f64,
}

impl Poses<'_> {
    /// Draws the next pose for a picture, after so many others. `None` if none of many is near a recorded picture.
    pub fn draw(&self, picture: u32, after: u32) -> Option<DrawnPose> {
        let near = |drawn: &DrawnPose| self.archive.index().check_reach(drawn.pose, self.within_px).is_ok();
        (after..MOST_POSES).map(|number| self.any(picture, number)).find(near)
    }

    fn any(&self, picture: u32, number: u32) -> DrawnPose {
        let stream = Stream::new(self.seed, Purpose::Dataset, picture, number);
        let half = self.archive.field().carpet_half_extent_m();
        let place = half * (2.0 * DVec2::new(stream.uniform(0), stream.uniform(1)) - 1.0);
        let images = self.archive.images();
        // The archive has at least one image.
        let image = &images[((stream.uniform(3) * images.len() as f64) as usize).min(images.len() - 1)];
        let pose = image.pose.with_planar(Pose2::new(place.x, place.y, TAU * stream.uniform(2)));
        DrawnPose { pose, timestamp_s: image.timestamp_s, before: number }
    }
}
