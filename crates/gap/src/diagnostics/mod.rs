//! What no effect of the library explains: one file a detector.

pub(crate) mod dynamic_objects;
pub(crate) mod missing_lines;
pub(crate) mod nominal_consistency;
pub(crate) mod odometry;
pub(crate) mod passing;
pub(crate) mod residual_patterns;
