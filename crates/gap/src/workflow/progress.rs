//! What the workflow is doing, for who waits.

/// What the workflow is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Measuring lines and carpet in the pictures.
    Measuring,
    /// Testing every effect.
    Testing,
    /// Fitting all effects of the extended model together.
    Fitting,
    /// Judging on frames that no fit has seen.
    Judging,
}
