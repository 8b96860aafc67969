//! Poses of a recording with their uncertainty.

use nalgebra::Matrix6;
use reality_sim_core::{
    localization::{LocalizedFrame, Localizer, Picture},
    pose::CameraPose,
    refine::SmoothedPose,
    sequence::{Sequence, SequenceError},
};

/// Pose of a picture with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TaggedPose {
    /// Pose of the camera.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch and roll, metres and radians; `None` where the picture was not fitted.
    pub covariance: Option<Matrix6<f64>>,
}

impl TaggedPose {
    /// Returns the standard deviations of x, y, yaw, height, pitch and roll, metres and radians.
    pub fn sigmas(&self) -> Option<[f64; 6]> {
        self.covariance.map(|covariance| covariance.diagonal().map(f64::sqrt).into())
    }

    /// Returns the filter's pose of every picture, from this and earlier pictures only.
    pub fn filtered(frames: &[LocalizedFrame]) -> Vec<Self> {
        let covariance = |frame: &LocalizedFrame| frame.fit.map(|fit| fit.covariance);
        frames.iter().map(|frame| Self { pose: frame.pose, covariance: covariance(frame) }).collect()
    }

    /// Returns the most probable poses of the whole recording; `None` where no picture shows enough of the lines.
    pub fn smoothed(
        sequence: &Sequence,
        localizer: &Localizer,
        frames: &[LocalizedFrame],
    ) -> Result<Option<Vec<Self>>, SequenceError> {
        let picture = |index| sequence.load_image(index).map(Picture::from);
        let smoothed = localizer.smoother().smooth(frames, picture)?;
        let tagged = |pose: &SmoothedPose| Self { pose: pose.pose, covariance: Some(pose.covariance) };
        Ok(smoothed.map(|poses| poses.iter().map(tagged).collect()))
    }
}

/// Returns the rows of a covariance.
pub fn covariance_rows(covariance: &Matrix6<f64>) -> [[f64; 6]; 6] {
    std::array::from_fn(|row| std::array::from_fn(|column| covariance[(row, column)]))
}
