//! Refinement of approximate poses: of single pictures to a fraction of a pixel, and of whole trajectories.

mod measure;
mod picture;
mod trajectory;

pub use self::{
    measure::{LineOffset, MeasureConfig, measure_offsets},
    picture::{PoseFit, Reach, RefineConfig, Refiner},
    trajectory::{SmoothedPose, TrajectoryFrame, smooth_trajectory},
};
