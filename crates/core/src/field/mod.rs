//! Soccer field: its dimensions, its lines as curves on the ground, and samples along them.

mod crossings;
mod curves;
mod dimensions;
mod presets;
mod projected;
mod sampling;

pub use self::{
    crossings::{Crossing, CrossingKind},
    curves::{Curve, Goal, GoalPost, LineKind, MARK_HALF_SIDE_M},
    dimensions::{FieldDimensions, InvalidField},
    presets::preset_names,
    projected::{project_lines, project_polygon},
    sampling::{LineSample, VisibleSample, sample_lines, visible_samples},
};

#[cfg(test)]
mod tests;
