//! Workflow from a recording and a model to the report: coarse alignment, selection of effects, and analysis of the result.

pub(crate) mod analysis;
pub(crate) mod coarse_alignment;
pub(crate) mod selection;
pub(crate) mod verdict;
