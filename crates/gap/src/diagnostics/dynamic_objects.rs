//! Objects that stand on the carpet and walk away: where one stood, other pictures show plain carpet.

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

/// Finds objects that are not where they were in other pictures.
pub(crate) struct DynamicObjects;

impl Detector for DynamicObjects {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        Vec::from_iter(dynamic_objects(&fit.frames, carpet::sigma(fit.sigmas)))
    }
}

/// A block of carpet, or of what hides it.
#[derive(Debug, Clone, Copy)]
struct Spot {
    ground: DVec2,
    is_hidden: bool,
}

/// What a picture shows of the carpet.
struct Spots {
    time_s: f64,
    /// The place that the camera is above.
    camera: DVec2,
    spots: Vec<Spot>,
}

/// `sigma` is the standard deviation of a block of carpet.
fn dynamic_objects(frames: &[FrameResiduals<'_>], sigma: f64) -> Option<Finding> {
    let pictures: Vec<Spots> = frames.iter().map(|frame| Spots::new(frame, sigma)).collect();
    let shows_one = |picture: &&Spots| picture.feet().any(|foot| has_left(&pictures, picture.time_s, foot));
    let share = pictures.iter().filter(shows_one).count() as f64 / pictures.len().max(1) as f64;
    (share > THRESHOLDS.least_share).then_some(Finding::DynamicObjects { share })
}

impl Spots {
    fn new(frame: &FrameResiduals<'_>, sigma: f64) -> Self {
        let spots = carpet::blocks(frame)
            .map(|(row, value)| Spot { ground: row.ground, is_hidden: carpet::is_hidden(value, sigma) });
        Self { time_s: frame.time_s, camera: frame.camera, spots: spots.collect() }
    }

    /// Where things touch the carpet: hidden, and between there and the camera there is plain carpet and nothing hidden, a
    /// thing's sides being in front of what is farther away.
    fn feet(&self) -> impl Iterator<Item = DVec2> {
        let is_foot = |spot: &&Spot| {
            let is_before = |other: &&Spot| self.is_before(other.ground, spot.ground);
            let mut before = self.spots.iter().filter(is_before).peekable();
            spot.is_hidden && before.peek().is_some() && before.all(|other| !other.is_hidden)
        };
        self.spots.iter().filter(is_foot).map(|spot| spot.ground)
    }

    /// Whether a place is nearer to the camera than another one, in its direction.
    fn is_before(&self, place: DVec2, other: DVec2) -> bool {
        let (to_place, way) = (place - self.camera, other - self.camera);
        let distance = way.length();
        let along = to_place.dot(way) / distance.max(1e-9);
        let beside = to_place.perp_dot(way).abs() / distance.max(1e-9);
        (0.0..distance - THRESHOLDS.same_m).contains(&along) && beside < THRESHOLDS.near_m
    }
}

/// Whether other pictures show plain carpet where a thing stood at a time.
fn has_left(pictures: &[Spots], time_s: f64, foot: DVec2) -> bool {
    let (mut seen, mut clear) = (0_usize, 0_usize);
    for picture in pictures.iter().filter(|picture| (picture.time_s - time_s).abs() > THRESHOLDS.later_s) {
        let around: Vec<&Spot> =
            picture.spots.iter().filter(|spot| spot.ground.distance(foot) < THRESHOLDS.near_m).collect();
        let is_there = around.iter().any(|spot| spot.ground.distance(foot) < THRESHOLDS.there_m);
        if is_there && around.len() >= THRESHOLDS.least_blocks {
            seen += 1;
            clear += usize::from(around.iter().all(|spot| !spot.is_hidden));
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

    /// Carpet of 2 m by 2 m in blocks of 10 cm, seen from above a place 1 m before it, with things that stand there: 20 cm
    /// thick where they touch the carpet, 40 cm above half of the camera's height.
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

    /// Twenty pictures in four seconds, the camera moving past.
    fn judged(things: impl Fn(f64) -> Vec<DVec2>) -> Option<Finding> {
        let times_s: Vec<f64> = (0..20).map(|i| 0.2 * f64::from(i)).collect();
        let camera = |time_s: f64| DVec2::new(0.5 * time_s, -1.0);
        let pictures: Vec<_> = times_s.iter().map(|&t| picture(camera(t), &things(t))).collect();
        let frames = times_s.iter().zip(&pictures).map(|(&time_s, (rows, values))| FrameResiduals {
            measurements: rows,
            values: values.clone(),
            time_s,
            camera: camera(time_s),
            size: [160, 160],
        });
        dynamic_objects(&frames.collect::<Vec<_>>(), SIGMA)
    }

    #[test]
    fn who_walks_over_the_carpet_is_seen_and_in_how_many_pictures() {
        let found = judged(|time_s| vec![DVec2::new(0.1 + 0.5 * time_s, 0.9)]);
        let Some(Finding::DynamicObjects { share }) = found else { panic!("{found:?}") };
        assert!(share > 0.8, "{share}");
    }

    #[test]
    fn what_stays_where_it_is_does_not_move_although_other_carpet_is_hidden_from_elsewhere() {
        assert_eq!(judged(|_| vec![DVec2::new(0.7, 0.9), DVec2::new(1.3, 0.2)]), None);
        // Two legs with one body on them, and carpet between.
        assert_eq!(judged(|_| vec![DVec2::new(0.6, 0.4), DVec2::new(0.9, 0.4)]), None);
        assert_eq!(judged(|_| Vec::new()), None);
    }

    #[test]
    fn a_glimpse_is_not_enough() {
        let glimpse = |time_s: f64| if time_s < 0.1 { vec![DVec2::new(0.7, 0.9)] } else { Vec::new() };
        assert_eq!(judged(glimpse), None);
    }
}
