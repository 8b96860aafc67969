//! Where a camera's simulation and its pictures disagree, which effect is missing, and how much it explains.
//!
//! recording → [`measurement`] (lines and carpet in each picture) → [`linear_model`] (residuals and normal equations by
//! frame) → [`inference`] (tests of effects, limits) → [`diagnostics`] (what no effect explains) → [`workflow`] → [`report`].

mod diagnostics;
mod inference;
mod linear_model;
mod measurement;
mod recording;
pub mod report;
#[cfg(test)]
mod testing;
mod thresholds;
mod workflow;

pub use self::{
    inference::held_out::ChannelGap,
    linear_model::linearization::MeasureError,
    measurement::quantity::Channel,
    recording::{LEAST_FRAMES, Recording, RecordingError, ReferenceSource},
    report::{Pictures, PicturesError, ReportError, ReportFault, html},
    workflow::{
        analysis::{Analysis, analyse, gap_of},
        progress::Progress,
        selection::Options,
    },
};
