//! Comparison of a simulated camera with real pictures: where they disagree, which effect the model lacks, and how much of
//! the gap that effect explains.
//!
//! A recording with reference poses is compared with what a camera model predicts for the same poses: the positions,
//! brightness and sharpness of lines, the noise of the carpet, and the steps of the odometry. Effects from a library that
//! explain the differences are added to the model one by one. The improvement is measured on held-out frames, which no fit
//! has seen.
//!
//! | | |
//! |---|---|
//! | [`Recording`] | frames of a sequence that are compared, with their reference poses |
//! | [`Options`] | seed that chooses the held-out frames, and effects that are left out of the library |
//! | [`inject`] | hides an effect in a recording, as a control |
//! | [`shown_photometry`] | brightness and blur that a recording shows |
//! | [`analyse`] | runs the whole workflow; returns an [`Analysis`] with the report and the extended model |
//! | [`report::Report`] | everything that was found: effects with sizes, unexplained findings, detection limits, the gap |
//! | [`ChannelGap`] | size of one [`Channel`]'s residuals before and after, beside the noise floor |
//! | [`gap_of`] | returns the gap of a model as it is |
//! | [`html`], [`Pictures`] | report as a page, and the pictures in it |
//!
//! ```
//! use reality_sim_core::sequence::Sequence;
//! use reality_sim_gap::{Options, Recording, ReferenceSource, analyse};
//! use reality_sim_sensor::Model;
//!
//! # let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/pitch");
//! let sequence = Sequence::open(&folder)?;
//! let poses: Vec<_> = sequence.reference_poses().collect();
//! let recording = Recording::new(&sequence, &poses, ReferenceSource::Measured, Some(0..30))?;
//!
//! let analysis = analyse(&recording, &Model::default(), &Options::default(), &|_| ())?;
//! assert!(analysis.model.values("mount_pitch").is_some(), "the mount is pitched otherwise than its files say");
//! assert!(analysis.report.gap.after < analysis.report.gap.before);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Data flow through the crate in one direction:
//!
//! ```text
//! recording → measurement (lines and carpet of each picture) → linear_model (residuals and normal equations)
//!   → inference (tests of effects, model search, limits) → diagnostics (what no effect explains) → report
//! ```
//!
//! `docs/gap.md` describes the method, its sources and how it was tested.

mod diagnostics;
mod frame_index;
mod inference;
mod injection;
mod linear_model;
mod measurement;
mod progress;
mod recording;
pub mod report;
mod simplification;
#[cfg(test)]
mod testing;
mod thresholds;
mod workflow;

pub use self::{
    inference::held_out::ChannelGap,
    injection::{InjectedRecording, InjectionError, inject, injected_parameter},
    linear_model::linearization::MeasureError,
    measurement::quantity::Channel,
    progress::Progress,
    recording::{LEAST_FRAMES, Recording, RecordingError, ReferenceSource},
    report::{Analysis, Pictures, PicturesError, ReportError, ReportFault, html},
    simplification::Simplification,
    workflow::{
        analysis::{analyse, gap_of},
        input_mistakes::shows_lines,
        selection::Options,
        shown_photometry::shown_photometry,
    },
};
