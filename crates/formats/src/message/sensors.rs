//! IMU and joints.

use glam::{DQuat, DVec3};

use super::{
    Header,
    rigid::{quaternion, vector},
};
use crate::schema::View;

/// Acceleration by gravity, m/s².
const GRAVITY: f64 = 9.81;

/// Largest difference of a measured acceleration from gravity at which its direction is taken for that of gravity, as a
/// fraction.
const GRAVITY_TOLERANCE: f64 = 0.1;

/// How a body is turned against the vertical. Its heading means nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// Rotation to axes of which the third points up.
    pub level_from_body: DQuat,
}

/// What an IMU measured.
#[derive(Debug, Clone, PartialEq)]
pub struct ImuSample {
    /// Time and frame.
    pub header: Header,
    /// Orientation, if the IMU estimates one.
    pub orientation: Option<Attitude>,
    /// Orientation by the accelerometer, if it measures little else than gravity.
    pub gravity: Option<Attitude>,
}

/// Reads a message of an IMU.
pub fn imu(message: &View<'_>) -> Option<ImuSample> {
    let header = Header::of(message);
    // A covariance that begins with −1 says that there is no orientation (sensor_msgs/Imu).
    let covariance = message.field("orientation_covariance").and_then(|view| view.numbers());
    let is_missing = covariance.is_some_and(|covariance| covariance.first() == Some(&-1.0));
    let rotation = quaternion(&message.field("orientation")?).filter(|_| !is_missing);
    let orientation = rotation.map(|level_from_body| Attitude { level_from_body });
    let acceleration = message.field("linear_acceleration").as_ref().and_then(vector);
    Some(ImuSample { header, orientation, gravity: acceleration.and_then(by_gravity) })
}

/// Returns the orientation in which gravity is felt like this: at rest, the acceleration points up.
fn by_gravity(acceleration: DVec3) -> Option<Attitude> {
    let is_gravity = (acceleration.length() / GRAVITY - 1.0).abs() < GRAVITY_TOLERANCE;
    let up_in_body = acceleration.try_normalize().filter(|_| is_gravity)?;
    Some(Attitude { level_from_body: DQuat::from_rotation_arc(up_in_body, DVec3::Z) })
}

/// Angle (or length) of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name of the joint.
    pub name: String,
    /// Angle in radians, or length in metres.
    pub position: f64,
}

/// Reads a message of joints.
pub fn joints(message: &View<'_>) -> Option<(Header, Vec<Joint>)> {
    let positions = message.field("position")?.numbers()?;
    let mut joints = Vec::new();
    message.field("name")?.each(&mut |name| {
        if let (Some(name), Some(position)) = (name.text(), positions.get(joints.len())) {
            joints.push(Joint { name: name.into_owned(), position: *position });
        }
    })?;
    joints.retain(|joint| joint.position.is_finite());
    Some((Header::of(message), joints))
}
