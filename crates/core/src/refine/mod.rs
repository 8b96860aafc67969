//! Refinement of approximate poses: of single pictures to a fraction of a pixel, and of whole trajectories.

mod calibration;
mod config;
mod measure;
mod picture;
mod pose_steps;
mod trajectory;

pub use self::{
    calibration::{ByCalibration, CalibrationUncertainty, InvalidCovariance, MOST as MOST_PARAMETERS},
    config::{RefineConfig, SmoothingConfig},
    measure::{LineOffset, MeasureConfig, measure_offsets},
    picture::{PoseFit, Reach, Refiner},
    pose_steps::{moved, pose_difference},
    trajectory::{SmoothedPose, TrajectoryFrame, smooth_trajectory},
};
