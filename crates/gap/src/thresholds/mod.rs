//! All numbers that decide something, each with what it is, its unit, and where it comes from.
//!
//! | word | what stands behind the number |
//! |---|---|
//! | Derived | it follows from the equation, the literature or the other number that is named |
//! | Measured | it is the result of the measurement that is named |
//! | Set on | other values were tried on the recordings that are named, and the results decided |
//! | Chosen: … | a judgement. What follows is the reason that was given, or what the number amounts to; it is no evidence |
//! | Chosen, when … | a judgement, made for a case that is named. No other value is known to have been tried |
//! | Chosen; no measurement | a judgement without a known reason |
//!
//! Draws are those of the study in `docs/gap.md`, draw 0 with the recordings of its first runs. No number was set on draw 3, whose
//! figures that page has.
//! `docs/figures/gap_thresholds.md` shows what halving and doubling each number changes in a few recordings. The numbers with which a
//! verdict, a name or a kind of finding changed point there.
//!
//! Numbers of the arithmetic (steps of differences, ends of iterations, guards against division by zero) stand where they are
//! used; sizes from which on an effect matters stand with the effect, in `reality_sim_sensor`.

mod diagnostics;
mod inference;
mod linear_model;
mod measurement;
mod recording;
mod report;
mod workflow;

pub(crate) use self::{
    diagnostics::{
        DiagnosticThresholds, FlickerThresholds, MissingLineThresholds, ObjectThresholds,
        ObstructionThresholds, OdometryThresholds, PatternThresholds,
    },
    inference::InferenceThresholds,
    linear_model::{
        LinearModelThresholds, NuisanceThresholds, PoseErrorThresholds, ReferenceDriftThresholds,
        ReflectanceThresholds,
    },
    measurement::{
        CarpetThresholds, LineThresholds, MeasurementThresholds, ProfileThresholds, VisibilityThresholds,
    },
    recording::RecordingThresholds,
    report::ReportThresholds,
    workflow::{InputMistakeThresholds, WhiteLineThresholds, WorkflowThresholds},
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
