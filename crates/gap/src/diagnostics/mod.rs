//! Detectors of deviations that no effect of the library explains, one in each file, and the things on the carpet.

mod carpet;
pub(crate) mod detector;
pub(crate) mod finding;
mod flicker;
pub(crate) mod input_mistake;
mod missing_lines;
mod nominal_consistency;
pub(crate) mod object;
pub(crate) mod objects;
mod obstruction;
mod odometry;
mod residual_patterns;
mod scatter;
mod unexplained_lines;

use self::detector::Detector;

/// All detectors, in the order in which their findings are reported.
pub(crate) const DETECTORS: [&dyn Detector; 8] = [
    &residual_patterns::ResidualPatterns,
    &flicker::Flicker,
    &obstruction::Obstruction,
    &odometry::Odometry,
    &nominal_consistency::NominalConsistency,
    &missing_lines::MissingLines,
    &scatter::Scatter,
    &unexplained_lines::UnexplainedLines,
];
