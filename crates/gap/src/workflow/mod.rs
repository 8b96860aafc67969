//! Workflow from a recording and a model to the report: coarse alignment, selection of effects, and analysis of the result.

pub(crate) mod analysis;
pub(crate) mod coarse_alignment;
mod fixed_values;
pub(crate) mod input_mistakes;
pub(crate) mod selection;
pub(crate) mod shown_photometry;
mod simpler_selection;
mod stopped;
pub(crate) mod verdict;
