//! The residuals of a recording linearised in every parameter, as normal equations with the pose errors marginalised.

mod assembly;
pub(crate) mod column;
pub(crate) mod fitted_residuals;
pub(crate) mod fixed_values;
pub(crate) mod initial_values;
pub(crate) mod linearization;
pub(crate) mod linearized_frame;
pub(crate) mod mean_reflectance;
pub(crate) mod normal_equations;
pub(crate) mod nuisance;
pub(crate) mod odometry_steps;
pub(crate) mod parameters;
mod perturbed_model;
mod pose_error;
pub(crate) mod pose_gradient;
mod pose_projection;
pub(crate) mod prediction;
pub(crate) mod reduced_equations;
pub(crate) mod reference_drift;
pub(crate) mod reflectance;
pub(crate) mod robust_weights;
mod rounding;
pub(crate) mod system;
#[cfg(test)]
mod tests;
pub(crate) mod texture;
