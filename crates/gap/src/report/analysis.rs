//! Outcome of the whole workflow.

use reality_sim_sensor::Model;

use super::data::Report;

/// Result of the workflow for a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Report of everything that was found.
    pub report: Report,
    /// Extended model.
    pub model: Model,
}
