//! A picture and its pose as Foxglove's messages.
//!
//! Foxglove's camera frame has OpenCV's axes, as ours; its projection matrices are those of ROS, with a pixel's centre at whole
//! coordinates, as ours. The coordinates of annotations begin at the corner of the first pixel: half a pixel is added there.

use foxglove::messages::{
    CameraCalibration, Color, CompressedImage, FrameTransform, ImageAnnotations, LinePrimitive, Point2,
    Point3, PointsAnnotation, Pose, PoseInFrame, PosesInFrame, Quaternion, SceneEntity, SceneUpdate,
    Timestamp, Vector3, line_primitive, points_annotation,
};
use glam::{DQuat, DVec2, DVec3};
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    field::{Curve, FieldDimensions, project_lines},
    pose::CameraPose,
};

use super::shot::Shot;
use crate::pixels::HALF_PIXEL;

/// Frame of the field.
const WORLD: &str = "world";

/// Frame of the camera.
const CAMERA: &str = "camera";

/// Thickness of the lines in the picture, pixels.
const LINE_PX: f64 = 2.0;

/// Pieces in which a circle is drawn.
const CIRCLE_STEPS: u32 = 64;

/// Height at which lines are drawn over the ground, metres: just above a ground that is drawn, too.
const LIFT_M: f64 = 0.001;

const PINK: Color = Color { r: 1.0, g: 0.1, b: 0.7, a: 1.0 };
const WHITE: Color = Color { r: 1.0, g: 1.0, b: 1.0, a: 1.0 };

/// Returns a time of a recording; times before 0 are taken as 0.
pub(super) fn timestamp(timestamp_s: f64) -> Timestamp {
    Timestamp::saturating_from_epoch_secs_f64(timestamp_s)
}

pub(super) fn image(shot: &Shot<'_>, time: Timestamp) -> CompressedImage {
    let is_png = shot.picture.starts_with(b"\x89PNG");
    CompressedImage {
        timestamp: Some(time),
        frame_id: CAMERA.to_owned(),
        data: shot.picture.to_vec().into(),
        format: if is_png { "png" } else { "jpeg" }.to_owned(),
    }
}

pub(super) fn calibration(shot: &Shot<'_>, time: Timestamp) -> CameraCalibration {
    let Camera { fx, fy, cx, cy, width, height, .. } = *shot.camera;
    let (model, terms) = match shot.camera.distortion {
        Distortion::Pinhole => ("plumb_bob", vec![0.0; 5]),
        Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }) => ("plumb_bob", vec![k1, k2, p1, p2, k3]),
        Distortion::OpencvFisheye(OpencvFisheye { k }) => ("kannala_brandt", k.to_vec()),
    };
    CameraCalibration {
        timestamp: Some(time),
        frame_id: CAMERA.to_owned(),
        width,
        height,
        distortion_model: model.to_owned(),
        d: terms,
        k: vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        r: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: vec![fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    }
}

pub(super) fn transform(shot: &Shot<'_>, time: Timestamp) -> FrameTransform {
    let Pose { position, orientation } = camera_axes(shot.pose);
    FrameTransform {
        timestamp: Some(time),
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: CAMERA.to_owned(),
        translation: position,
        rotation: orientation,
    }
}

pub(super) fn pose_in_frame(shot: &Shot<'_>, time: Timestamp) -> PoseInFrame {
    PoseInFrame { timestamp: Some(time), frame_id: WORLD.to_owned(), pose: Some(arrow(shot.pose)) }
}

pub(super) fn particles(shot: &Shot<'_>, time: Timestamp) -> PosesInFrame {
    let poses = shot.particles.iter().map(|particle| arrow(*particle));
    PosesInFrame { timestamp: Some(time), frame_id: WORLD.to_owned(), poses: poses.collect() }
}

pub(super) fn lines(shot: &Shot<'_>, time: Timestamp) -> ImageAnnotations {
    let lines = project_lines(shot.camera, shot.field, shot.pose, 0.0);
    let annotation = |line: &Vec<DVec2>| PointsAnnotation {
        timestamp: Some(time),
        r#type: points_annotation::Type::LineStrip.into(),
        points: line.iter().map(|p| Point2 { x: p.x + HALF_PIXEL, y: p.y + HALF_PIXEL }).collect(),
        outline_color: Some(PINK),
        thickness: LINE_PX,
        ..PointsAnnotation::default()
    };
    ImageAnnotations {
        timestamp: Some(time),
        points: lines.iter().map(annotation).collect(),
        ..ImageAnnotations::default()
    }
}

pub(super) fn field(field: &FieldDimensions, time: Timestamp) -> SceneUpdate {
    let line = |curve: Curve| LinePrimitive {
        r#type: line_primitive::Type::LineStrip.into(),
        pose: Some(placed(DVec3::ZERO, DQuat::IDENTITY)),
        thickness: field.line_width_m,
        points: points(&curve),
        color: Some(WHITE),
        ..LinePrimitive::default()
    };
    let entity = SceneEntity {
        timestamp: Some(time),
        frame_id: WORLD.to_owned(),
        id: "lines".to_owned(),
        lines: field.curves().into_iter().map(line).collect(),
        ..SceneEntity::default()
    };
    SceneUpdate { entities: vec![entity], ..SceneUpdate::default() }
}

fn points(curve: &Curve) -> Vec<Point3> {
    let steps = match curve {
        Curve::Segment { .. } => 1,
        Curve::Circle { .. } => CIRCLE_STEPS,
    };
    let point = |step| {
        let (place, _) = curve.at(f64::from(step) / f64::from(steps));
        Point3 { x: place.x, y: place.y, z: LIFT_M }
    };
    (0..=steps).map(point).collect()
}

/// Returns the pose of a camera's own axes: z points into the scene.
fn camera_axes(pose: CameraPose) -> Pose {
    placed(pose.position_in_world(), pose.quaternion_world_from_camera().normalize())
}

/// Returns the pose of an arrow along the optical axis: Foxglove draws poses as arrows along x.
fn arrow(pose: CameraPose) -> Pose {
    let rotation = DQuat::from_rotation_z(pose.yaw_rad) * DQuat::from_rotation_y(pose.pitch_rad);
    placed(pose.position_in_world(), rotation)
}

fn placed(position: DVec3, rotation: DQuat) -> Pose {
    let DQuat { x, y, z, w } = rotation;
    Pose {
        position: Some(Vector3 { x: position.x, y: position.y, z: position.z }),
        orientation: Some(Quaternion { x, y, z, w }),
    }
}
