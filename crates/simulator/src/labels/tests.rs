//! Labels against the renderer of the sensor, which draws outlines and shares no code with them, and against the lens.

use std::{path::Path, sync::OnceLock};

use glam::{DVec2, Vec3};
use image::RgbImage;
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv},
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
    sequence::{CameraSetup, Sequence},
    warp::{Hall, Origin, ProxyGeometry},
};
use reality_sim_sensor::{Renderer, SceneColors};

use super::*;
use crate::{
    class::Class,
    seen_object::{NO_OBJECT, SeenObject},
};

/// Share of the pixels of one colour that must have its class. All 3.0 million of the pictures below do; the rest is room for what
/// single precision makes of other processors' rays.
const LEAST_AGREEMENT: f64 = 0.9999;

fn setup() -> CameraSetup {
    Sequence::open(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/walk"))).unwrap().setup
}

/// Cameras with a fisheye lens and with a perspective one.
fn setups() -> [CameraSetup; 2] {
    let lens = Distortion::Opencv(Opencv { k1: -0.3, k2: 0.08, p1: 0.001, p2: -0.002, k3: 0.0 });
    let webcam = Camera::new([640, 480], [420.0, 425.0, 310.0, 250.0], lens).unwrap();
    [setup(), CameraSetup { camera: webcam, ..setup() }]
}

fn fields() -> [FieldDimensions; 2] {
    ["humanoid-kidsize-2010", "spl"].map(|name| FieldDimensions::preset(name).unwrap())
}

fn poses(field: &FieldDimensions) -> Vec<CameraPose> {
    let pose = |x: f64, y: f64, yaw_rad, height_m, pitch_rad, roll_rad| {
        let place = DVec2::new(x * field.length_m, y * field.width_m) / 2.0;
        CameraPose::new(Pose2::new(place.x, place.y, yaw_rad), height_m, pitch_rad, roll_rad)
    };
    vec![
        pose(0.3, 0.2, 3.0, 0.5, 0.4, 0.02),
        pose(0.85, 0.3, -0.8, 0.52, 0.3, -0.1),
        pose(-0.9, -0.4, 2.2, 1.6, 0.7, 0.3),
        pose(1.1, 0.1, 3.3, 0.45, 0.1, 0.0),
        pose(0.0, 0.0, 0.4, 0.5, 1.3, 0.0),
    ]
}

/// Returns the scene's geometry without the backs of the goals, which the renderer does not draw.
fn without_backs(field: &FieldDimensions) -> ProxyGeometry {
    let mut proxy = ProxyGeometry::new(&Hall::usual(field), field);
    for back in [1, 3] {
        proxy.billboards[back].height_m = -1.0;
    }
    proxy
}

/// Returns the cameras, each on one of the fields, with their labelers, which the tests share.
fn stages() -> &'static [(CameraSetup, FieldDimensions, Labeler)] {
    static MADE: OnceLock<Vec<(CameraSetup, FieldDimensions, Labeler)>> = OnceLock::new();
    MADE.get_or_init(|| {
        let stage = |(setup, field): (CameraSetup, FieldDimensions)| {
            let labeler = Labeler::new(&setup.camera, &field, &without_backs(&field));
            (setup, field, labeler)
        };
        setups().into_iter().zip(fields()).map(stage).collect()
    })
}

fn labels_at(labeler: &Labeler, pose: CameraPose) -> Labels {
    let mut labels = Labels::default();
    labeler.label(pose, &[], Overlay::default(), &mut labels);
    labels
}

/// Draws every class in a colour of its own.
fn drawn(setup: &CameraSetup, field: &FieldDimensions, pose: CameraPose) -> RgbImage {
    let colors = SceneColors {
        line_linear_rgb: Vec3::X,
        carpet_linear_rgb: Vec3::Y,
        goal_negative_x_linear_rgb: Vec3::Z,
        goal_positive_x_linear_rgb: Vec3::Z,
        floor_linear_rgb: Vec3::ONE,
        wall_linear_rgb: Vec3::ONE,
        ceiling_linear_rgb: Vec3::ONE,
    };
    Renderer::new(setup, field, colors).draw(pose).unwrap()
}

fn class_of(color: [u8; 3]) -> Option<Class> {
    match color {
        [255, 0, 0] => Some(Class::Line),
        [0, 255, 0] => Some(Class::Carpet),
        [0, 0, 255] => Some(Class::Goal),
        [255, 255, 255] | [0, 0, 0] => Some(Class::Outside),
        _ => None,
    }
}

#[test]
fn every_pixel_of_one_colour_has_the_class_that_the_renderer_draws_there() {
    let mut seen = [0_usize; 4];
    for (setup, field, labeler) in stages() {
        for pose in poses(field) {
            let (labels, picture) = (labels_at(labeler, pose), drawn(setup, field, pose));
            let (mut same, mut pure) = (0, 0);
            for (pixel, class) in picture.pixels().zip(&labels.classes) {
                let Some(expected) = class_of(pixel.0) else { continue };
                pure += 1;
                same += usize::from(expected == *class);
                seen[usize::from(expected.number())] += 1;
            }
            let agreement = f64::from(same as u32) / f64::from(pure as u32);
            assert!(agreement >= LEAST_AGREEMENT, "{}, {pose:?}: {agreement}", field.name);
            assert!(2 * pure > labels.classes.len(), "{}, {pose:?}: {pure} pixels of one colour", field.name);
        }
    }
    assert!(seen.iter().all(|count| *count > 1000), "every class is seen: {seen:?}");
}

#[test]
fn distances_of_the_ground_are_those_of_the_rays() {
    for (setup, field, labeler) in stages() {
        for pose in poses(field) {
            let labels = labels_at(labeler, pose);
            let mut count = 0;
            for index in (0..labels.classes.len()).step_by(97) {
                let pixel = DVec2::new((index % 640) as f64, (index / 640) as f64);
                if !matches!(labels.classes[index], Class::Carpet | Class::Line) {
                    continue;
                }
                let ground = setup.camera.unproject_to_ground(pose, pixel).unwrap();
                let expected_m = ground.extend(0.0).distance(pose.position_in_world());
                let error_m = (f64::from(labels.distance_m[index]) - expected_m).abs();
                assert!(error_m < 1e-4 * expected_m * expected_m / pose.height_m, "{pixel}: {error_m} m");
                count += 1;
            }
            assert!(count > 100, "{pose:?}: {count}");
        }
    }
}

#[test]
fn crossings_and_lines_lie_where_their_pixels_meet_the_ground() {
    for (setup, field, labeler) in stages() {
        for pose in poses(field) {
            let labels = labels_at(labeler, pose);
            assert_eq!(labels.crossings.len(), field.crossings().len());
            for seen in &labels.crossings {
                let Some(pixel) = seen.pixel else { continue };
                let ground = setup.camera.unproject_to_ground(pose, pixel).unwrap();
                let distance_m = ground.distance(pose.planar().position_in_world());
                assert!(ground.distance(seen.crossing.point_in_world) < 1e-6 * (1.0 + distance_m.powi(2)));
            }
            for seen in &labels.lines {
                let (kind, curve) = field.lines()[seen.line];
                assert_eq!(kind, seen.kind);
                for pixel in &seen.pixels {
                    let ground = setup.camera.unproject_to_ground(pose, *pixel).unwrap();
                    assert!(curve.distance_m(ground) < 1e-3, "{kind:?} at {pixel}");
                }
            }
        }
    }
}

/// Returns the distance of a pixel from lines in view, pixels.
fn distance_px(lines: &[SeenLine], line: usize, pixel: DVec2) -> f64 {
    use reality_sim_core::field::Curve;
    let of_line = lines.iter().filter(|seen| seen.line == line);
    let pieces = of_line.flat_map(|seen| seen.pixels.windows(2));
    pieces
        .map(|ends| Curve::Segment { from: ends[0], to: ends[1] }.distance_m(pixel))
        .fold(f64::INFINITY, f64::min)
}

/// Whether a goal is seen near a pixel. Parts of a line that come into view for less than 5 cm beside a post are lost.
fn is_near_a_goal(labels: &Labels, index: usize) -> bool {
    const NEAR_PX: i64 = 8;
    let offsets = (-NEAR_PX..=NEAR_PX).flat_map(|v| (-NEAR_PX..=NEAR_PX).map(move |u| 640 * v + u));
    let places = offsets.filter_map(|offset| usize::try_from(index as i64 + offset).ok());
    places.filter_map(|place| labels.classes.get(place)).any(|class| *class == Class::Goal)
}

#[test]
fn lines_hold_all_that_is_in_view_and_nothing_else() {
    for (setup, field, labeler) in stages() {
        for pose in poses(field) {
            let labels = labels_at(labeler, pose);
            for (line, (_, curve)) in field.lines().iter().enumerate() {
                for step in 0..400 {
                    let ground = curve.at((f64::from(step) + 0.3) / 400.0).0;
                    let point = pose.camera_from_world(ground.extend(0.0));
                    let Ok(pixel) = setup.camera.project(point) else { continue };
                    let index = pixel.y.round() as usize * 640 + pixel.x.round() as usize;
                    let found_px = distance_px(&labels.lines, line, pixel);
                    if !is_near_a_goal(&labels, index) {
                        assert!(found_px < 0.1, "{pose:?}: line {line} at {pixel}: {found_px} px");
                    }
                }
            }
            let points = labels.lines.iter().flat_map(|seen| &seen.pixels);
            for pixel in points {
                let index = pixel.y.round() as usize * 640 + pixel.x.round() as usize;
                assert!(labels.classes[index] < Class::Goal, "{pixel} is hidden");
            }
        }
    }
}

#[test]
fn boxes_bound_the_pixels_of_their_things() {
    let (setup, field) = (setup(), FieldDimensions::preset("humanoid-kidsize-2010").unwrap());
    for pose in poses(&field) {
        let mut labels = Labels::default();
        let proxy = ProxyGeometry::new(&Hall::usual(&field), &field);
        Labeler::new(&setup.camera, &field, &proxy).label(pose, &[], Overlay::default(), &mut labels);
        assert_eq!(labels.things.len(), 2);
        for (number, thing) in labels.things.iter().enumerate() {
            let mut extent = Extent::default();
            for (index, instance) in labels.instances.iter().enumerate() {
                if usize::from(*instance) == number + 1 {
                    assert_eq!(labels.classes[index], Class::Goal);
                    extent.add(index as u32 % 640, index as u32 / 640);
                }
            }
            assert_eq!((extent.count, extent.around()), (thing.visible_pixels, thing.visible), "{pose:?}");
            assert!(thing.visible_pixels <= thing.whole_pixels && (0.0..=1.0).contains(&thing.truncation));
        }
    }
}

#[test]
fn what_a_goal_hides_is_hidden_and_what_is_behind_the_camera_is_outside() {
    let (setup, field) = (setup(), FieldDimensions::preset("humanoid-kidsize-2010").unwrap());
    // Behind the goal at +x, looking at its back from close by: nothing of the field's middle is seen through it.
    let behind =
        CameraPose::new(Pose2::new(field.length_m / 2.0 + 0.8, 0.0, std::f64::consts::PI), 0.4, 0.1, 0.0);
    let mut labels = Labels::default();
    let proxy = ProxyGeometry::new(&Hall::usual(&field), &field);
    Labeler::new(&setup.camera, &field, &proxy).label(behind, &[], Overlay::default(), &mut labels);
    let [far, near] = [&labels.things[0], &labels.things[1]];
    assert!(far.whole_pixels > 100 && far.visibility() == 0.0, "{far:?}");
    assert!(near.visibility() == 1.0);
    let center = labels.crossings.iter().find(|seen| seen.crossing.point_in_world == DVec2::ZERO).unwrap();
    assert!(center.pixel.is_some() && !center.is_visible);
    // Looking away from the field, only the goal beside the camera may be in view.
    let away = CameraPose { yaw_rad: 0.0, pitch_rad: -0.5, ..behind };
    Labeler::new(&setup.camera, &field, &proxy).label(away, &[], Overlay::default(), &mut labels);
    assert_eq!(labels.things[0].truncation, 1.0);
    assert_eq!(labels.things[0].whole_pixels, 0);
}

#[test]
fn objects_are_labelled_over_the_scene_and_hide_what_is_behind_them() {
    let (setup, field) = (setup(), FieldDimensions::preset("humanoid-kidsize-2010").unwrap());
    let pose = CameraPose::new(Pose2::new(1.0, 0.3, 0.1), 0.5, 0.2, 0.0);
    let labeler = Labeler::new(&setup.camera, &field, &without_backs(&field));
    let (mut empty, mut full) = (Labels::default(), Labels::default());
    let trust = 7;
    let origins = vec![Origin { source: 0, trust }; 640 * 480];
    labeler.label(pose, &origins, Overlay::default(), &mut empty);
    let goal = empty.things[1].visible.unwrap();
    // An object before the left half of the goal, and one that is out of view.
    let middle = u32::midpoint(goal.left, goal.right);
    let is_hidden = |index: usize| goal.left <= index as u32 % 640 && (index as u32 % 640) < middle;
    let object_of: Vec<u16> =
        (0..640 * 480).map(|index| if is_hidden(index) { 1 } else { NO_OBJECT }).collect();
    let object = SeenObject {
        class: Class::Robot,
        name: "robot".to_owned(),
        visible: None,
        whole: None,
        visible_pixels: 0,
        whole_pixels: 0,
        truncation: 0.0,
    };
    let objects = [object.clone(), SeenObject { whole_pixels: 480 * (middle - goal.left), ..object }];
    let distance_m = vec![1.5; 640 * 480];
    let overlay = Overlay { objects: &objects, object_of: &object_of, distance_m: &distance_m };
    labeler.label(pose, &origins, overlay, &mut full);
    for index in 0..640 * 480 {
        let labels = (full.classes[index], full.instances[index], full.distance_m[index], full.trust[index]);
        let beside = (empty.classes[index], empty.instances[index], empty.distance_m[index], trust);
        assert_eq!(labels, if is_hidden(index) { (Class::Robot, 4, 1.5, u8::MAX) } else { beside });
    }
    assert_eq!((full.things[2].visibility(), full.things[3].visibility()), (0.0, 1.0));
    let visibility = full.things[1].visibility();
    assert!(visibility > 0.2 && visibility < 0.8 && empty.things[1].visibility() == 1.0, "{visibility}");
    for (seen, before) in full.crossings.iter().zip(&empty.crossings) {
        let behind = seen
            .pixel
            .is_some_and(|pixel| is_hidden(pixel.y.round() as usize * 640 + pixel.x.round() as usize));
        assert_eq!(seen.is_visible, before.is_visible && !behind);
    }
    assert!(full.crossings.iter().filter(|seen| seen.is_visible).count() < full.crossings.len());
}
