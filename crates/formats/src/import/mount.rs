//! Where the camera is on the robot: height, pitch and roll at a time, from tf, IMU and joints.

use glam::DQuat;

use super::{axes::Axes, error::Lack, gather::Gathered, options::ImportOptions, series::Series, shot::Shot};
use crate::message::{Attitude, Rigid};

/// Names of frames on the ground that do not tilt, the best first.
const LEVEL_FRAMES: [&str; 2] = ["base_footprint", "odom"];

/// Source of pitch and roll.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AttitudeSource {
    /// IMU, whose frame tf or joints link to the camera's.
    ImuAndFrames,
    /// IMU alone: it is taken to sit on the camera.
    Imu,
    /// IMU on the base, of whose frame tf knows nothing.
    ImuOnBase,
    /// Reference poses: nothing else tells pitch and roll.
    Reference,
    /// Accelerometer, whose frame tf or joints link to the camera's.
    AccelerometerAndFrames,
    /// Accelerometer alone: it is taken to sit on the camera.
    Accelerometer,
    /// Transforms up to a frame that does not tilt.
    Frames,
    /// Transforms up to the frame whose pose the odometry tells.
    OdometryAndFrames,
}

/// Mount of a camera on a robot, at any time of a log.
pub struct CameraMount<'a> {
    gathered: &'a Gathered,
    tolerance_ns: i64,
    /// Frame of the camera.
    pub camera: String,
    /// Frame that does not tilt, up to which the transforms are known.
    pub level: Option<String>,
    /// Source of pitch and roll.
    pub source: AttitudeSource,
    axes: Axes,
}

impl<'a> CameraMount<'a> {
    /// Finds what tells pitch and roll. Fails if nothing does.
    pub fn find(gathered: &'a Gathered, shots: &[Shot], options: &ImportOptions) -> Result<Self, Lack> {
        let camera = gathered.camera_frame.clone();
        let level = level_frame(gathered, &camera, options.base_frame.as_deref());
        let is_linked =
            gathered.frames.connects(&gathered.imu_frame, &camera) && gathered.imu_frame != camera;
        let is_still = level.as_ref().is_some_and(|level| !gathered.frames.moves(level, &camera));
        let by_odometry = level.as_ref().is_some_and(|level| is_child_of_odometry(gathered, level));
        let source = match (gathered.imu.is_empty(), gathered.gravity.is_empty(), &level) {
            (false, _, _) if is_linked => AttitudeSource::ImuAndFrames,
            (false, _, level) if level.is_none() || gathered.imu_frame == camera => AttitudeSource::Imu,
            (false, _, Some(_)) if is_still && is_camera_s(&gathered.imu_frame) => AttitudeSource::Imu,
            (false, _, Some(_)) if is_still => AttitudeSource::ImuOnBase,
            (_, _, Some(_)) if by_odometry => AttitudeSource::OdometryAndFrames,
            (true, false, Some(_)) if is_linked => AttitudeSource::AccelerometerAndFrames,
            (_, _, Some(_)) => AttitudeSource::Frames,
            (_, false, None) => AttitudeSource::Accelerometer,
            _ if !gathered.reference.is_empty() => AttitudeSource::Reference,
            _ => return Err(Lack::NoAttitude { frame: camera }),
        };
        let tolerance_ns = options.tolerance_ns();
        let mut mount = Self { gathered, tolerance_ns, camera, level, source, axes: Axes::Optical };
        let frame = if mount.is_on_camera() { &gathered.imu_frame } else { &mount.camera };
        let by_name = Axes::by_name(frame);
        let rotations = shots.iter().filter_map(|shot| mount.level_from_frame(shot.time_ns));
        mount.axes = Axes::by_data(rotations).unwrap_or(by_name);
        Ok(mount)
    }

    /// Returns whether the IMU is taken to sit on the camera.
    pub fn is_on_camera(&self) -> bool {
        matches!(self.source, AttitudeSource::Imu | AttitudeSource::Accelerometer)
    }

    /// Returns the axes of the frame by which the camera is turned.
    pub fn axes(&self) -> Axes {
        self.axes
    }

    /// Returns the rotation from the camera's own axes to a frame whose third axis points up, at a time.
    pub fn level_from_camera(&self, time_ns: i64) -> Option<DQuat> {
        Some(self.level_from_frame(time_ns)? * self.axes.rotation_from_optical())
    }

    /// Returns the pose of the camera over the frame that does not tilt, in the camera's own axes, as far as tf tells it.
    pub fn pose_over_level(&self, time_ns: i64) -> Option<Rigid> {
        let level = self.level.as_ref()?;
        let level_from_camera = self.frame_transform(level, time_ns)?;
        if is_child_of_odometry(self.gathered, level) {
            return Some(self.gathered.odometry.at(time_ns, self.tolerance_ns)?.then(level_from_camera));
        }
        Some(level_from_camera)
    }

    /// Returns the transform from the camera, in its own axes, to another frame.
    pub fn frame_transform(&self, frame: &str, time_ns: i64) -> Option<Rigid> {
        let transform = self.gathered.frames.transform(frame, &self.camera, time_ns, self.tolerance_ns)?;
        Some(transform.then(Rigid::new(self.frame_axes().rotation_from_optical(), glam::DVec3::ZERO)))
    }

    /// Returns the axes of the camera's frame in tf.
    fn frame_axes(&self) -> Axes {
        if self.is_on_camera() { Axes::by_name(&self.camera) } else { self.axes }
    }

    fn level_from_frame(&self, time_ns: i64) -> Option<DQuat> {
        let attitude =
            |series: &Series<Attitude>| Some(series.at(time_ns, self.tolerance_ns)?.level_from_body);
        let gathered = self.gathered;
        let transform = |frame: &str| {
            Some(gathered.frames.transform(frame, &self.camera, time_ns, self.tolerance_ns)?.rotation)
        };
        match self.source {
            AttitudeSource::Imu => attitude(&gathered.imu),
            AttitudeSource::Accelerometer => attitude(&gathered.gravity),
            AttitudeSource::ImuAndFrames => Some(attitude(&gathered.imu)? * transform(&gathered.imu_frame)?),
            AttitudeSource::ImuOnBase => Some(attitude(&gathered.imu)? * transform(self.level.as_ref()?)?),
            AttitudeSource::Reference => Some(gathered.reference.at(time_ns, self.tolerance_ns)?.rotation),
            AttitudeSource::AccelerometerAndFrames => {
                Some(attitude(&gathered.gravity)? * transform(&gathered.imu_frame)?)
            }
            AttitudeSource::Frames => transform(self.level.as_ref()?),
            AttitudeSource::OdometryAndFrames => {
                let odometry = gathered.odometry.at(time_ns, self.tolerance_ns)?;
                Some(odometry.rotation * transform(self.level.as_ref()?)?)
            }
        }
    }

    /// Returns the source of pitch and roll in a word.
    pub fn source_name(&self) -> String {
        let from = |frame: &str| {
            if self.gathered.frames.passes_joints(frame, &self.camera) { "joints" } else { "tf" }
        };
        let level = self.level.as_deref().unwrap_or_default();
        match self.source {
            AttitudeSource::Imu => "imu".to_owned(),
            AttitudeSource::Accelerometer => "accelerometer".to_owned(),
            AttitudeSource::Reference => "reference".to_owned(),
            AttitudeSource::ImuOnBase => format!("imu+{}", from(level)),
            AttitudeSource::ImuAndFrames => format!("imu+{}", from(&self.gathered.imu_frame)),
            AttitudeSource::AccelerometerAndFrames => {
                format!("accelerometer+{}", from(&self.gathered.imu_frame))
            }
            AttitudeSource::Frames => from(level).to_owned(),
            AttitudeSource::OdometryAndFrames => format!("odometry+{}", from(level)),
        }
    }
}

/// Returns whether a frame that tf does not know is one of the camera's or the head's, by its name.
fn is_camera_s(frame: &str) -> bool {
    let frame = frame.to_ascii_lowercase();
    frame.is_empty() || ["cam", "head", "optical"].iter().any(|part| frame.contains(part))
}

/// Returns whether the odometry tells a frame's pose.
fn is_child_of_odometry(gathered: &Gathered, frame: &str) -> bool {
    !gathered.odometry.is_empty() && gathered.odometry_frames.1 == frame
}

/// Chooses the frame above which height, pitch and roll are taken from tf: the given one, that of the odometry, one that is known
/// by its name, else the root.
fn level_frame(gathered: &Gathered, camera: &str, given: Option<&str>) -> Option<String> {
    let chain = gathered.frames.chain(camera);
    let above = &chain[1..];
    if let Some(given) = given {
        return above.contains(&given).then(|| given.to_owned());
    }
    let of_odometry = above.iter().find(|frame| is_child_of_odometry(gathered, frame));
    let known = LEVEL_FRAMES.iter().find_map(|name| above.iter().find(|frame| frame.ends_with(name)));
    of_odometry.or(known).or(above.last()).map(|frame| (*frame).to_owned())
}
