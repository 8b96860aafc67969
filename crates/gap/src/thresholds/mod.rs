//! All numbers that decide something, each with what it is, its unit, and where it comes from.
//!
//! "Chosen" means that nothing was measured for it. "Set on the study" means that it was chosen with the results of the study
//! in `docs/gap.md` in view, on its draws 0 to 2; the figures of that page are from a draw that no number was set on.

mod diagnostics;
mod inference;
mod linear_model;
mod measurement;
mod recording;
mod report;
mod workflow;

pub(crate) use self::{
    diagnostics::{
        DiagnosticThresholds, DynamicObjectThresholds, FlickerThresholds, MissingLineThresholds,
        OdometryThresholds, PatternThresholds,
    },
    inference::InferenceThresholds,
    linear_model::{LinearModelThresholds, NuisanceThresholds, PoseErrorThresholds},
    measurement::{
        CarpetThresholds, LineThresholds, MeasurementThresholds, ProfileThresholds, VisibilityThresholds,
    },
    recording::RecordingThresholds,
    report::ReportThresholds,
    workflow::WorkflowThresholds,
};

/// Every number that decides something, by the layer that it decides in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thresholds {
    pub(crate) recording: RecordingThresholds,
    pub(crate) measurement: MeasurementThresholds,
    pub(crate) linear_model: LinearModelThresholds,
    pub(crate) inference: InferenceThresholds,
    pub(crate) diagnostics: DiagnosticThresholds,
    pub(crate) workflow: WorkflowThresholds,
    pub(crate) report: ReportThresholds,
}

impl Thresholds {
    /// The values that everything is decided with.
    pub(crate) const DEFAULT: Self = Self {
        recording: RecordingThresholds::DEFAULT,
        measurement: MeasurementThresholds::DEFAULT,
        linear_model: LinearModelThresholds::DEFAULT,
        inference: InferenceThresholds::DEFAULT,
        diagnostics: DiagnosticThresholds::DEFAULT,
        workflow: WorkflowThresholds::DEFAULT,
        report: ReportThresholds::DEFAULT,
    };
}
