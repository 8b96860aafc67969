//! Detectors of deviations that no effect of the library explains, one in each file.

mod carpet;
pub(crate) mod detector;
mod dynamic_objects;
pub(crate) mod finding;
mod flicker;
pub(crate) mod input_mistake;
mod missing_lines;
mod nominal_consistency;
mod occluders;
mod odometry;
mod residual_patterns;
mod scatter;

use self::detector::Detector;

/// All detectors, in the order in which their findings are reported.
pub(crate) const DETECTORS: [&dyn Detector; 8] = [
    &residual_patterns::ResidualPatterns,
    &flicker::Flicker,
    &occluders::Occluders,
    &dynamic_objects::DynamicObjects,
    &odometry::Odometry,
    &nominal_consistency::NominalConsistency,
    &missing_lines::MissingLines,
    &scatter::Scatter,
];
