//! Where a camera's simulation and its pictures disagree, which effect is missing, and how much it explains.
//!
//! recording → looks (what is measured in each picture) → rows (measured against expected) → system (normal equations
//! by frame) → evidence → names → extended model → report.

mod analysis;
mod carpet;
mod columns;
mod evidence;
mod explained;
mod finder;
mod following;
pub mod html;
mod jpeg;
mod judge;
mod limits;
mod look;
mod maps;
mod measure;
mod measured;
mod moving;
mod naming;
mod nominal;
mod passing;
mod pictures;
mod placing;
mod predict;
mod presence;
mod profile;
mod progress;
mod recording;
pub mod report;
mod report_file;
mod rows;
mod search;
mod split;
mod starting;
mod steps;
mod sums;
mod surroundings;
mod system;
#[cfg(test)]
mod testing;
mod tolerance;
mod total;
mod unknown;
mod words;
mod workflow;

pub use self::{
    analysis::{Analysis, analyse, gap_of},
    judge::ChannelGap,
    measure::MeasureError,
    pictures::{Pictures, PicturesError},
    progress::Stage,
    recording::{LEAST_FRAMES, PoseSource, Recording, RecordingError},
    report_file::{ReportError, ReportFault},
    rows::Channel,
    workflow::Options,
};
