//! Calibration from the lines of the field: lens, mount and all poses of a recording together.

mod adjust;
mod advice;
mod assessment;
mod body_offset;
mod calibration;
mod chart;
mod correlation;
mod covariance;
mod error;
mod noise;
mod parameter;
mod picture;
mod selection;
mod start;
mod state;
mod track;
mod uncertainty;
mod workflow;

pub use self::{
    advice::Advice,
    assessment::{Assessment, Shift, assess, assess_frames},
    body_offset::BodyOffset,
    calibration::{Calibration, Confusable},
    error::CalibrationError,
    noise::Noise,
    parameter::Parameter,
    selection::Choice,
    uncertainty::UncertaintyMap,
    workflow::{LensModel, Stage, Trusted, calibrate},
};
