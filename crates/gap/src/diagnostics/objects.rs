//! Search for things on the carpet: where they stand, what they hide of it, and whether they move.

use glam::DVec2;

use crate::{
    diagnostics::{
        carpet,
        detector::{FitResiduals, FrameResiduals},
        object::{Object, ObjectMotion},
    },
    thresholds::{ObjectThresholds, Thresholds},
};

const THRESHOLDS: ObjectThresholds = Thresholds::DEFAULT.diagnostics.objects;

/// Returns the things that hide carpet: those that stand, the largest share first, then what moves.
pub(crate) fn objects(fit: &FitResiduals<'_>) -> Vec<Object> {
    objects_in(&fit.frames, carpet::sigma(fit.sigmas))
}

/// Returns the things in these pictures. `sigma` is the standard deviation of a block's residual.
fn objects_in(frames: &[FrameResiduals<'_>], sigma: f64) -> Vec<Object> {
    let pictures: Vec<CarpetPicture> = frames.iter().map(|frame| CarpetPicture::new(frame, sigma)).collect();
    let sightings = (0..).zip(&pictures).flat_map(|(index, picture)| picture.sightings(index));
    let (moving, standing): (Vec<Sighting>, Vec<Sighting>) =
        sightings.partition(|seen| has_left(&pictures, pictures[seen.picture].time_s, seen.foot));
    let count = pictures.len() as f64;
    let mut objects: Vec<Object> = clusters(standing)
        .iter()
        .map(|cluster| object(cluster, count, Some(centre(cluster).to_array())))
        .filter(|object| {
            object.share >= THRESHOLDS.least_share && object.pictures >= THRESHOLDS.least_pictures
        })
        .collect();
    objects.sort_by(|a, b| b.share.total_cmp(&a.share));
    objects.extend(
        Some(object(&moving, count, None))
            .filter(|object| object.pictures > THRESHOLDS.least_moving_pictures),
    );
    objects
}

/// Block of carpet, or of a thing that hides it.
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

/// Part of a thing in one picture: where it touches the carpet, and what it hides beyond.
#[derive(Debug, Clone, Copy)]
struct Sighting {
    /// Index of the picture.
    picture: usize,
    /// Point on the field, world axes, metres.
    foot: DVec2,
    /// Share of the picture's carpet that is hidden, 0 to 1.
    share: f64,
}

impl CarpetPicture {
    fn new(frame: &FrameResiduals<'_>, sigma: f64) -> Self {
        let blocks = carpet::blocks(frame).map(|(measurement, residual)| Block {
            ground: measurement.ground,
            is_hidden: carpet::is_hidden(residual, sigma),
        });
        Self { time_s: frame.time_s, camera: frame.camera, blocks: blocks.collect() }
    }

    /// Returns the feet of things, each with the share of the carpet that is hidden there and behind it.
    fn sightings(&self, picture: usize) -> Vec<Sighting> {
        let feet: Vec<DVec2> = self.feet().collect();
        let mut shares = vec![0.0; feet.len()];
        for block in self.blocks.iter().filter(|block| block.is_hidden) {
            let reaches = |foot: DVec2| foot == block.ground || self.is_before(foot, block.ground);
            let distance = |&index: &usize| feet[index].distance_squared(block.ground);
            let behind = (0..feet.len()).filter(|&index| reaches(feet[index]));
            if let Some(nearest) = behind.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                shares[nearest] += 1.0 / self.blocks.len() as f64;
            }
        }
        feet.into_iter().zip(shares).map(|(foot, share)| Sighting { picture, foot, share }).collect()
    }

    /// Returns the points where things touch the carpet: hidden blocks with plain carpet and no other hidden block between
    /// them and the camera. Farther hidden blocks may only be covered by the upper part of a thing.
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

/// Groups sightings whose feet are within a thing's width of each other, beginning with those that hide most.
fn clusters(mut sightings: Vec<Sighting>) -> Vec<Vec<Sighting>> {
    sightings.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut clusters: Vec<Vec<Sighting>> = Vec::new();
    for sighting in sightings {
        let is_near =
            |cluster: &&mut Vec<Sighting>| cluster[0].foot.distance(sighting.foot) < 2.0 * THRESHOLDS.near_m;
        match clusters.iter_mut().find(is_near) {
            Some(cluster) => cluster.push(sighting),
            None => clusters.push(vec![sighting]),
        }
    }
    clusters
}

/// Returns the mean of the feet, each by what it hides.
fn centre(cluster: &[Sighting]) -> DVec2 {
    let (sum, weight) = cluster
        .iter()
        .fold((DVec2::ZERO, 0.0), |(sum, weight), seen| (sum + seen.share * seen.foot, weight + seen.share));
    sum / weight
}

/// Returns a thing that is seen in some of `count` pictures. It moves if it has no place.
fn object(seen: &[Sighting], count: f64, place_m: Option<[f64; 2]>) -> Object {
    let mut pictures: Vec<usize> = seen.iter().map(|sighting| sighting.picture).collect();
    pictures.sort_unstable();
    pictures.dedup();
    Object {
        motion: if place_m.is_some() { ObjectMotion::Standing } else { ObjectMotion::Moving },
        share: seen.iter().map(|sighting| sighting.share).sum::<f64>() / count.max(1.0),
        pictures: pictures.len() as f64 / count.max(1.0),
        place_m,
    }
}

/// Whether pictures of other times show plain carpet where a thing stood at `time_s`.
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

    /// Carpet of 2 m by 2 m in blocks of 10 cm, seen from a camera 1 m in front of it, with things on it. A thing is 20 cm
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

    /// Returns the things in twenty pictures within four seconds, taken while the camera moves past, and the share of the
    /// carpet that is hidden.
    fn found(things: impl Fn(f64) -> Vec<DVec2>) -> (Vec<Object>, f64) {
        let times_s: Vec<f64> = (0..20).map(|i| 0.2 * f64::from(i)).collect();
        let camera = |time_s: f64| DVec2::new(0.5 * time_s, -1.0);
        let pictures: Vec<_> = times_s.iter().map(|&t| picture(camera(t), &things(t))).collect();
        let hidden = pictures.iter().flat_map(|(_, values)| values).filter(|value| **value < -0.5).count();
        let frames = times_s.iter().zip(&pictures).map(|(&time_s, (measurements, values))| FrameResiduals {
            measurements,
            values: values.clone(),
            time_s,
            camera: camera(time_s),
            size: [160, 160],
        });
        (objects_in(&frames.collect::<Vec<_>>(), SIGMA), hidden as f64 / (20.0 * 400.0))
    }

    fn moves(object: &Object) -> bool {
        object.motion == ObjectMotion::Moving
    }

    #[test]
    fn a_person_who_walks_over_the_carpet_moves_in_most_pictures() {
        let (found, _) = found(|time_s| vec![DVec2::new(0.1 + 0.5 * time_s, 0.9)]);
        let walker = found.iter().find(|object| moves(object));
        assert!(walker.is_some_and(|walker| walker.pictures > 0.8 && walker.place_m.is_none()), "{found:?}");
    }

    #[test]
    fn things_at_rest_stand_in_their_places_although_they_hide_other_carpet_from_elsewhere() {
        let places = [DVec2::new(0.7, 0.9), DVec2::new(1.3, 0.2)];
        let (found, hidden) = found(|_| places.to_vec());
        assert_eq!(found.len(), 2, "{found:?}");
        for place in places {
            let distance = |object: &Object| DVec2::from(object.place_m.unwrap()).distance(place);
            assert!(found.iter().any(|object| !moves(object) && distance(object) < 0.15), "{found:?}");
        }
        let share: f64 = found.iter().map(|object| object.share).sum();
        assert!((share / hidden - 1.0).abs() < 0.2, "{share} of {hidden}");
    }

    #[test]
    fn two_legs_of_one_body_do_not_walk_and_empty_carpet_has_nothing_on_it() {
        let (legs, _) = found(|_| vec![DVec2::new(0.6, 0.4), DVec2::new(0.9, 0.4)]);
        assert!(!legs.is_empty() && !legs.iter().any(moves), "{legs:?}");
        assert_eq!(found(|_| Vec::new()).0, []);
    }

    #[test]
    fn a_thing_in_a_single_picture_is_not_listed() {
        let glimpse = |time_s: f64| if time_s < 0.1 { vec![DVec2::new(0.7, 0.9)] } else { Vec::new() };
        assert_eq!(found(glimpse).0, []);
    }
}
