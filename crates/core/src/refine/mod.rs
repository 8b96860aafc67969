//! From a pose that is nearly right to one that fits the picture to a fraction of a pixel, and from single pictures to
//! a whole trajectory.

mod measure;
mod picture;
mod trajectory;

pub use self::{
    measure::{LineOffset, MeasureConfig, measure_offsets},
    picture::{PoseFit, Reach, RefineConfig, Refiner},
    trajectory::{SmoothedPose, TrajectoryFrame, smooth_trajectory},
};
