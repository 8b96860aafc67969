//! The residuals of a recording linearised in every parameter, as normal equations with the poses' errors projected out.

pub(crate) mod column;
pub(crate) mod initial_values;
pub(crate) mod linearization;
pub(crate) mod normal_equations;
pub(crate) mod nuisance;
pub(crate) mod odometry_steps;
pub(crate) mod parameters;
pub(crate) mod prediction;
pub(crate) mod reduced_equations;
pub(crate) mod residual;
pub(crate) mod system;
#[cfg(test)]
mod tests;
