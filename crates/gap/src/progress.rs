//! Progress of the workflow, for display while it runs.

/// Stage of the workflow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Measuring lines and carpet in the pictures.
    Measuring,
    /// Testing every effect.
    Testing,
    /// Fitting all effects of the extended model together.
    Fitting,
    /// Evaluating the model on held-out frames.
    Evaluating,
}
