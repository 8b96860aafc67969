//! Objects that move over the carpet: where one stood, other pictures show plain carpet.

use glam::DVec2;

use crate::{
    diagnostics::{
        carpet,
        detector::{Detector, FitResiduals, FrameResiduals},
        finding::Finding,
    },
    thresholds::{DynamicObjectThresholds, Thresholds},
};

const THRESHOLDS: DynamicObjectThresholds = Thresholds::DEFAULT.diagnostics.dynamic_objects;

/// Detector of objects that are elsewhere in other pictures.
pub(crate) struct DynamicObjects;

impl Detector for DynamicObjects {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        Vec::from_iter(dynamic_objects(&fit.frames, carpet::sigma(fit.sigmas)))
    }
}

/// Block of carpet, or of an object that hides it.
#[derive(Debug, Clone, Copy)]
struct Block {
    /// Point on the field, world axes, metres.
    ground: DVec2,
    is_hidden: bool,
}

/// Blocks of the carpet that a picture shows.
struct CarpetPicture {
    time_s: f64,
    /// Point on the field below the camera, world axes, metres.
    camera: DVec2,
    blocks: Vec<Block>,
}

/// Returns the share of pictures that show a moving object, if it is large enough. `sigma` is the standard deviation of a
/// block's residual.
fn dynamic_objects(frames: &[FrameResiduals<'_>], sigma: f64) -> Option<Finding> {
    let pictures: Vec<CarpetPicture> = frames.iter().map(|frame| CarpetPicture::new(frame, sigma)).collect();
    let shows_one =
        |picture: &&CarpetPicture| picture.feet().any(|foot| has_left(&pictures, picture.time_s, foot));
    let share = pictures.iter().filter(shows_one).count() as f64 / pictures.len().max(1) as f64;
    (share > THRESHOLDS.least_share).then_some(Finding::DynamicObjects { share })
}

impl CarpetPicture {
    fn new(frame: &FrameResiduals<'_>, sigma: f64) -> Self {
        let blocks = carpet::blocks(frame).map(|(measurement, residual)| Block {
            ground: measurement.ground,
            is_hidden: carpet::is_hidden(residual, sigma),
        });
        Self { time_s: frame.time_s, camera: frame.camera, blocks: blocks.collect() }
    }

    /// Returns the points where objects touch the carpet: hidden blocks with plain carpet and no other hidden block between
    /// them and the camera. Farther hidden blocks may only be covered by the upper part of an object.
    fn feet(&self) -> impl Iterator<Item = DVec2> {
        let is_foot = |block: &&Block| {
            let is_before = |other: &&Block| self.is_before(other.ground, block.ground);
            let mut before = self.blocks.iter().filter(is_before).peekable();
            block.is_hidden && before.peek().is_some() && before.all(|other| !other.is_hidden)
        };
        self.blocks.iter().filter(is_foot).map(|block| block.ground)
    }

    /// Whether a place lies between the camera and another place.
    fn is_before(&self, place: DVec2, other: DVec2) -> bool {
        let (to_place, way) = (place - self.camera, other - self.camera);
        let distance = way.length();
        let along = to_place.dot(way) / distance.max(1e-9);
        let beside = to_place.perp_dot(way).abs() / distance.max(1e-9);
        (0.0..distance - THRESHOLDS.same_m).contains(&along) && beside < THRESHOLDS.near_m
    }
}

/// Whether pictures of other times show plain carpet where an object stood at `time_s`.
fn has_left(pictures: &[CarpetPicture], time_s: f64, foot: DVec2) -> bool {
    let (mut seen, mut clear) = (0_usize, 0_usize);
    for picture in pictures.iter().filter(|picture| (picture.time_s - time_s).abs() > THRESHOLDS.later_s) {
        let distance = |block: &Block| block.ground.distance(foot);
        let around: Vec<&Block> =
            picture.blocks.iter().filter(|block| distance(block) < THRESHOLDS.near_m).collect();
        let is_there = around.iter().any(|block| distance(block) < THRESHOLDS.there_m);
        if is_there && around.len() >= THRESHOLDS.least_blocks {
            seen += 1;
            clear += usize::from(around.iter().all(|block| !block.is_hidden));
        }
    }
    seen as f64 >= THRESHOLDS.least_seen * pictures.len() as f64
        && clear as f64 >= THRESHOLDS.least_clear * seen as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{measurement::scalar::Measurement, testing::carpet_measurement};

    const SIGMA: f64 = 0.05;
    const CAMERA_M: f64 = 0.5;

    /// Carpet of 2 m by 2 m in blocks of 10 cm, seen from a camera 1 m in front of it, with objects on it. An object is 20 cm
    /// wide, and 40 cm above half of the camera's height.
    fn picture(camera: DVec2, things: &[DVec2]) -> (Vec<Measurement>, Vec<f64>) {
        let places = (0..400).map(|i| 0.1 * DVec2::new(f64::from(i % 20), f64::from(i / 20)));
        let hides = |thing: &DVec2, place: DVec2| {
            let way = place - camera;
            let part = ((*thing - camera).dot(way) / way.length_squared()).clamp(0.0, 1.0);
            let height_m = CAMERA_M * (1.0 - part);
            (camera + part * way).distance(*thing) < if height_m > 0.5 * CAMERA_M { 0.2 } else { 0.1 }
        };
        let seen = places.map(|place| {
            let is_hidden = things.iter().any(|thing| hides(thing, place));
            (carpet_measurement(DVec2::ZERO, place), if is_hidden { -1.0 } else { 0.3 * SIGMA })
        });
        seen.unzip()
    }

    /// Returns the finding in twenty pictures within four seconds, taken while the camera moves past.
    fn found(things: impl Fn(f64) -> Vec<DVec2>) -> Option<Finding> {
        let times_s: Vec<f64> = (0..20).map(|i| 0.2 * f64::from(i)).collect();
        let camera = |time_s: f64| DVec2::new(0.5 * time_s, -1.0);
        let pictures: Vec<_> = times_s.iter().map(|&t| picture(camera(t), &things(t))).collect();
        let frames = times_s.iter().zip(&pictures).map(|(&time_s, (measurements, values))| FrameResiduals {
            measurements,
            values: values.clone(),
            time_s,
            camera: camera(time_s),
            size: [160, 160],
        });
        dynamic_objects(&frames.collect::<Vec<_>>(), SIGMA)
    }

    #[test]
    fn a_person_who_walks_over_the_carpet_is_found_with_the_share_of_pictures() {
        let found = found(|time_s| vec![DVec2::new(0.1 + 0.5 * time_s, 0.9)]);
        let Some(Finding::DynamicObjects { share }) = found else { panic!("{found:?}") };
        assert!(share > 0.8, "{share}");
    }

    #[test]
    fn an_object_at_rest_does_not_move_although_it_hides_other_carpet_from_elsewhere() {
        assert_eq!(found(|_| vec![DVec2::new(0.7, 0.9), DVec2::new(1.3, 0.2)]), None);
        // Two legs of one body, with carpet between them.
        assert_eq!(found(|_| vec![DVec2::new(0.6, 0.4), DVec2::new(0.9, 0.4)]), None);
        assert_eq!(found(|_| Vec::new()), None);
    }

    #[test]
    fn an_object_in_a_single_picture_is_not_reported() {
        let glimpse = |time_s: f64| if time_s < 0.1 { vec![DVec2::new(0.7, 0.9)] } else { Vec::new() };
        assert_eq!(found(glimpse), None);
    }
}
