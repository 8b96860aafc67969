//! Inference of the effects that a recording supports: effect tests, the search for a set of effects, detection limits, and
//! the gap on held-out frames.
//!
//! ```text
//! cluster_covariance ─┬─ evidence ─┬─ effect_fit ─┐
//! hypothesis_test ────┘            │              ├─ effect_test ─ effect_selection ─ model_search
//!                                  │              └─ power (by effect_test) ─ detection_limit
//! split, gain ─────────────────────┴─ cross_validation ─┘
//! held_out ── confirmation (of model_search)
//! ```

pub(crate) mod cluster_covariance;
pub(crate) mod confirmation;
pub(crate) mod cross_validation;
pub(crate) mod detection_limit;
pub(crate) mod effect_fit;
pub(crate) mod effect_selection;
pub(crate) mod effect_test;
pub(crate) mod evidence;
pub(crate) mod gain;
pub(crate) mod held_out;
pub(crate) mod hypothesis_test;
pub(crate) mod light_pattern;
pub(crate) mod linearized_recording;
pub(crate) mod model_comparison;
pub(crate) mod model_error;
pub(crate) mod model_search;
pub(crate) mod power;
pub(crate) mod recording_source;
pub(crate) mod selected_model;
pub(crate) mod shown_brightness;
pub(crate) mod split;
#[cfg(test)]
mod tests;
