//! Dead reckoning of the camera.

use reality_sim_core::pose::Pose2;

use super::{axes::Axes, gather::Gathered, mount::CameraMount};

/// Names of frames in which tf tells dead reckoning.
const ODOMETRY_FRAMES: [&str; 2] = ["odom", "odom_combined"];

/// Source of the camera's dead reckoning.
pub enum CameraOdometry<'a> {
    /// Poses of a frame that tf links to the camera.
    Moved(&'a Gathered, String),
    /// Poses taken as they are, with these axes.
    AsItIs(&'a Gathered, Axes),
    /// Transforms up to a frame of dead reckoning.
    Frames(String),
    /// None.
    Missing,
}

impl<'a> CameraOdometry<'a> {
    /// Finds what tells the camera's dead reckoning.
    pub fn find(gathered: &'a Gathered, mount: &CameraMount<'_>) -> Self {
        let child = &gathered.odometry_frames.1;
        if !gathered.odometry.is_empty() {
            if *child != mount.camera && gathered.frames.connects(child, &mount.camera) {
                return Self::Moved(gathered, child.clone());
            }
            let rotations = gathered.odometry.samples().iter().map(|sample| sample.value.rotation);
            return Self::AsItIs(gathered, Axes::by_data(rotations).unwrap_or(Axes::Body));
        }
        let chain = gathered.frames.chain(&mount.camera);
        let odometry = chain.iter().skip(1).find(|frame| ODOMETRY_FRAMES.contains(frame));
        odometry.map_or(Self::Missing, |frame| Self::Frames((*frame).to_owned()))
    }

    /// Returns whether there is dead reckoning.
    pub fn is_there(&self) -> bool {
        !matches!(self, Self::Missing)
    }

    /// Returns the camera's place and heading at a time.
    pub fn at(&self, mount: &CameraMount<'_>, time_ns: i64, tolerance_ns: i64) -> Option<Pose2> {
        match self {
            Self::Moved(gathered, child) => {
                let odometry = gathered.odometry.at(time_ns, tolerance_ns)?;
                let camera = odometry.then(mount.frame_transform(child, time_ns)?);
                Some(Axes::Optical.camera_pose(camera).planar())
            }
            Self::AsItIs(gathered, axes) => {
                Some(axes.camera_pose(gathered.odometry.at(time_ns, tolerance_ns)?).planar())
            }
            Self::Frames(frame) => {
                Some(Axes::Optical.camera_pose(mount.frame_transform(frame, time_ns)?).planar())
            }
            Self::Missing => None,
        }
    }

    /// Returns the source in a few words.
    pub fn words(&self) -> Option<String> {
        match self {
            Self::Moved(_, child) => Some(format!("of {child}, moved to the camera by tf")),
            Self::AsItIs(..) => Some("as it is: no tf from its frame to the camera's".to_owned()),
            Self::Frames(frame) => Some(format!("tf from {frame} to the camera")),
            Self::Missing => None,
        }
    }
}
