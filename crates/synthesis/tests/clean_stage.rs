//! The clean stage in a drawn hall: pictures by a ray caster of its own, with and without things on the carpet.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{f64::consts::TAU, io::Cursor, path::Path, sync::Arc};

use glam::{DVec2, DVec3};
use image::{ImageFormat, Rgb, RgbImage};
use reality_sim_core::{
    camera::{Camera, Distortion, OpencvFisheye},
    field::{FieldDimensions, MARK_HALF_SIDE_M},
    pose::{CameraPose, Pose2},
    sequence::{CameraSetup, Sequence},
};
use reality_sim_db::{Database, NewImage, PoseEstimate, PoseSource, Recording};
use reality_sim_synthesis::{
    Archive, Auto, Blend, FoundCleanStage, MethodKind, Nearest, SynthesisError, Synthesizer,
    find_clean_stage,
    quality::{Mask, psnr_db},
};
use tempfile::TempDir;

/// Number of recorded pictures.
const PICTURES: usize = 90;

fn field() -> FieldDimensions {
    FieldDimensions::preset("humanoid-kidsize-2010").unwrap()
}

fn camera() -> Camera {
    let lens = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
    Camera::new([320, 240], [107.0, 107.0, 159.5, 119.5], Distortion::OpencvFisheye(lens)).unwrap()
}

/// Upright cylinder on the carpet.
#[derive(Clone, Copy)]
struct Thing {
    center_m: DVec2,
    radius_m: f64,
    height_m: f64,
    color: [f64; 3],
}

impl Thing {
    /// Returns the distance at which a ray enters it.
    fn distance_m(&self, from: DVec3, ray: DVec3) -> Option<f64> {
        let (a, b) = (ray.truncate(), from.truncate() - self.center_m);
        let (squares, half, rest) =
            (a.length_squared(), a.dot(b), b.length_squared() - self.radius_m * self.radius_m);
        let root = (half * half - squares * rest).sqrt();
        let side = (-half - root) / squares;
        let is_on_side = side > 0.0 && (0.0..=self.height_m).contains(&(from.z + side * ray.z));
        let lid = (self.height_m - from.z) / ray.z;
        let on_lid = (from + lid * ray).truncate();
        let is_on_lid = lid > 0.0 && on_lid.distance(self.center_m) <= self.radius_m;
        let lid = is_on_lid.then_some(lid);
        is_on_side.then_some(side).into_iter().chain(lid).reduce(f64::min)
    }
}

/// Two that stand still, and one that walks through the middle.
fn things(time: usize) -> Vec<Thing> {
    let thing =
        |x, y, radius_m, height_m, color| Thing { center_m: DVec2::new(x, y), radius_m, height_m, color };
    let along = -1.5 + 3.0 * time as f64 / PICTURES as f64;
    vec![
        thing(0.9, 0.9, 0.15, 0.6, [40.0, 110.0, 130.0]),
        thing(-1.2, -0.5, 0.07, 0.13, [230.0, 120.0, 20.0]),
        thing(along, 0.4, 0.12, 0.8, [60.0, 60.0, 70.0]),
    ]
}

/// Returns the colour of the carpet and the walls.
fn paint(field: &FieldDimensions, end: DVec3) -> [f64; 3] {
    if end.z > 1e-9 {
        return [end.x, end.y, end.z].map(|at| 120.0 + 25.0 * (0.9 * at).sin());
    }
    let point = end.truncate();
    if point.abs().cmpgt(field.carpet_half_extent_m()).any() {
        return [110.0, 100.0, 95.0];
    }
    let on_line = field.curves().iter().any(|curve| curve.distance_m(point) < field.line_width_m / 2.0);
    let on_mark = field.marks().iter().any(|mark| (point - mark).abs().max_element() < MARK_HALF_SIDE_M);
    if on_line || on_mark {
        return [235.0; 3];
    }
    let texture = (2.3 * point.x).sin() * (3.1 * point.y).cos() + 0.5 * (7.0 * (point.x + point.y)).sin();
    [55.0 + 4.0 * texture, 140.0 + 9.0 * texture, 75.0 + 5.0 * texture]
}

fn noise(seed: usize, u: u32, v: u32) -> f64 {
    let hash = (seed as u32).wrapping_mul(0x9e37_79b9) ^ (u * 40_503 + v).wrapping_mul(2_654_435_761);
    f64::from((hash ^ hash >> 15).wrapping_mul(0x2c1b_3c6d) >> 24) / 255.0 - 0.5
}

/// Photographs the hall with these things; exposures differ a little.
fn photograph(pose: CameraPose, things: &[Thing], seed: usize) -> RgbImage {
    let (field, camera) = (field(), camera());
    let (from, rotation) = (pose.position_in_world(), pose.rotation_world_from_camera());
    let [min, max] = [DVec3::new(-5.0, -4.0, 0.0), DVec3::new(5.0, 4.0, 3.0)];
    let exposure = 0.92 + 0.16 * noise(seed, 1, 1).abs();
    RgbImage::from_fn(camera.width, camera.height, |u, v| {
        let ray = rotation * camera.unproject(DVec2::new(f64::from(u), f64::from(v))).unwrap();
        let mut end_m = f64::INFINITY;
        for axis in 0..3 {
            let wall = if ray[axis] < 0.0 { min[axis] } else { max[axis] };
            end_m = end_m.min((wall - from[axis]) / ray[axis]);
        }
        let end = from + end_m * ray;
        let mut color = paint(&field, if end.z < 1e-6 { end.with_z(0.0) } else { end });
        for thing in things {
            if let Some(distance_m) = thing.distance_m(from, ray).filter(|distance_m| *distance_m < end_m) {
                (end_m, color) = (distance_m, thing.color);
            }
        }
        Rgb(color.map(|value| (exposure * value + 8.0 * noise(seed + 7, u, v)).clamp(0.0, 255.0) as u8))
    })
}

/// Returns poses that fill a part of the field evenly (Roberts' sequence).
fn pose(number: usize) -> CameraPose {
    let part = |step: f64| (0.5 + number as f64 * step).fract();
    let place = Pose2::new(4.6 * part(0.819_173) - 2.3, 3.0 * part(0.671_044) - 1.5, TAU * part(0.549_7));
    CameraPose::new(place, 0.5, 0.45, 0.0)
}

/// Returns whether a pose is not inside a thing.
fn is_free(pose: CameraPose, things: &[Thing]) -> bool {
    let eye = pose.planar().position_in_world();
    things.iter().all(|thing| thing.center_m.distance(eye) > thing.radius_m + 0.3)
}

/// Records the hall into a database.
fn recorded(with_things: bool) -> (TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hall.db");
    let setup = CameraSetup { camera: camera(), ..setup() };
    let recording = Recording::new("hall", &setup, &field(), PoseSource::GroundTruth).unwrap();
    let mut database = Database::create_or_open(&path).unwrap();
    for number in 0..PICTURES {
        let there = things(number);
        if !is_free(pose(number), &there) {
            continue;
        }
        let picture = photograph(pose(number), if with_things { &there } else { &[] }, number);
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        let image = NewImage {
            frame_index: number,
            timestamp_s: number as f64,
            file_name: "drawn.png",
            estimate: &PoseEstimate::from(pose(number)),
            bytes: &bytes.into_inner(),
        };
        database.insert(&recording, &image).unwrap();
    }
    (folder, path)
}

fn setup() -> CameraSetup {
    let walk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk");
    Sequence::open(&walk).unwrap().setup
}

fn found(path: &Path) -> FoundCleanStage {
    find_clean_stage(&Archive::open(path, 0).unwrap(), &|_, _| true).unwrap().unwrap()
}

/// Stores the clean stage, and opens the database for pictures with it.
fn clean(path: &Path) -> Synthesizer {
    let found = found(path);
    let mut database = Database::create_or_open(path).unwrap();
    let field_id = *database.fields().unwrap().keys().next().unwrap();
    database.set_clean_stage(field_id, &found.ground, &found.masks).unwrap();
    drop(database);
    Synthesizer::new(Arc::new(Archive::open(path, 64 << 20).unwrap())).with_clean(true)
}

#[test]
fn clean_pictures_are_nearer_to_the_empty_hall_and_plain_ones_stay_as_they_are() {
    let (_folder, path) = recorded(true);
    let before = Synthesizer::new(Arc::new(Archive::open(&path, 64 << 20).unwrap()));
    let clean = clean(&path);
    let plain = Synthesizer::new(clean.archive().clone());
    let (mut gained_db, mut probes) = (0.0, 0);
    for number in 200..216 {
        let pose = pose(number);
        let standing = things(PICTURES / 2);
        let Ok(as_recorded) = plain.image_at(pose, &Blend) else { continue };
        if !is_free(pose, &standing) {
            continue;
        }
        assert_eq!(as_recorded, before.image_at(pose, &Blend).unwrap());
        let cleaned = clean.image_at(pose, &Blend).unwrap();
        let empty = photograph(pose, &[], 1000 + number);
        let carpet = Mask::carpet(&camera(), pose, &field());
        let of = |picture: &RgbImage| psnr_db(picture, &empty, Some(&carpet)).unwrap();
        gained_db += of(&cleaned.picture) - of(&as_recorded.picture);
        probes += 1;
    }
    assert!(probes >= 8, "{probes}");
    let mean_db = gained_db / f64::from(probes);
    assert!(mean_db > 1.0, "{mean_db} dB nearer to the empty hall");
}

/// Where nothing stands, hardly anything is masked, however much pictures differ in brightness and noise. What is masked lies on
/// lines: these pictures have jagged edges, without any blur (0.4 % was measured).
#[test]
fn nothing_is_found_in_an_empty_hall() {
    let (_folder, path) = recorded(false);
    let found = found(&path);
    let hidden: f64 = found.masks.values().map(reality_sim_db::ImageMask::hidden_share).sum();
    assert!(hidden / (PICTURES as f64) < 6e-3, "{hidden} of {PICTURES} pictures");
    assert!(found.ground.unknown_share() < 0.25, "{}", found.ground.unknown_share());
}

/// The masks are compared with what the ray caster knows: pixels of the carpet at which a thing stands in front.
#[test]
fn masks_cover_the_things_and_little_else() {
    let (_folder, path) = recorded(true);
    let found = found(&path);
    let archive = Archive::open(&path, 0).unwrap();
    let (mut covered, mut shown, mut wrong, mut empty) = (0.0, 0.0, 0.0, 0.0);
    for image in archive.images() {
        let there = things(image.frame_index);
        let (from, rotation) = (image.pose.position_in_world(), image.pose.rotation_world_from_camera());
        let carpet = Mask::carpet(&camera(), image.pose, &field());
        let mask = found.masks.get(&image.id);
        for (u, v) in (0..320).step_by(2).flat_map(|u| (0..240).step_by(2).map(move |v| (u, v))) {
            let ray = rotation * camera().unproject(DVec2::new(f64::from(u), f64::from(v))).unwrap();
            // Far things are a few pixels large.
            let distance_m = there.iter().filter_map(|thing| thing.distance_m(from, ray)).reduce(f64::min);
            let is_hidden = mask.is_some_and(|mask| mask.hides([u, v], [320, 240]));
            match distance_m {
                Some(distance_m) if distance_m < 2.0 && carpet.holds((320 * v + u) as usize) => {
                    shown += 1.0;
                    covered += f64::from(is_hidden);
                }
                None => {
                    empty += 1.0;
                    wrong += f64::from(is_hidden);
                }
                Some(_) => {}
            }
        }
    }
    assert!(covered / shown > 0.8, "{} of the things are covered", covered / shown);
    assert!(wrong / empty < 0.02, "{} of the rest is covered", wrong / empty);
}

#[test]
fn the_ground_that_somebody_walked_over_is_known() {
    let (_folder, path) = recorded(true);
    let ground = found(&path).ground;
    let views = |x: f64, y: f64| {
        let cell = ((DVec2::new(x, y) - ground.min_m) / ground.cell_m).floor();
        ground.views.get_pixel(cell.x as u32, cell.y as u32).0[0]
    };
    for place in [[0.0, 0.4], [0.9, 0.5], [-1.2, -0.2], [0.3, -0.8], [1.5, 0.4]] {
        assert!(views(place[0], place[1]) >= 2, "{place:?}");
    }
    let color = |x: f64, y: f64| {
        let cell = ((DVec2::new(x, y) - ground.min_m) / ground.cell_m).floor();
        ground.colors.get_pixel(cell.x as u32, cell.y as u32).0
    };
    let [red, green, blue] = color(0.3, 0.4);
    assert!(green > red + 40 && green > blue + 30, "carpet where somebody walked");
    assert!(color(0.0, 0.6).iter().all(|value| *value > 190), "the centre circle stays white");
}

#[test]
fn without_a_clean_stage_clean_pictures_are_refused_by_name() {
    let (_folder, path) = recorded(false);
    let archive = Arc::new(Archive::open(&path, 64 << 20).unwrap());
    assert!(!archive.has_clean_stage());
    let clean = Synthesizer::new(archive).with_clean(true);
    for method in MethodKind::COMPARED {
        let error = clean.image_at(pose(3), &method).unwrap_err();
        assert!(matches!(error, SynthesisError::NoCleanStage { .. }), "{error}");
        assert!(!error.is_refusal() && error.to_string().contains("build it again"), "{error}");
    }
}

#[test]
fn recorded_pictures_in_which_somebody_stands_are_not_given_as_they_are() {
    let (_folder, path) = recorded(true);
    let clean = clean(&path);
    let archive = clean.archive().clone();
    assert!(archive.has_clean_stage());
    let shows = |image: usize| clean.image_at(archive.images()[image].pose, &Auto).unwrap();
    let methods: Vec<&str> = (0..20).map(|image| shows(image).method).collect();
    let blended = methods.iter().position(|method| *method == "blend").unwrap();
    let pose = archive.images()[blended].pose;
    let plain = Synthesizer::new(archive.clone()).image_at(pose, &Nearest).unwrap().picture;
    assert_ne!(clean.image_at(pose, &Nearest).unwrap().picture, plain);
}

#[test]
fn a_search_that_is_not_wanted_any_more_ends_without_a_result() {
    let (_folder, path) = recorded(true);
    let archive = Archive::open(&path, 0).unwrap();
    assert_eq!(find_clean_stage(&archive, &|_, _| false).unwrap(), None);
}
