//! Soccer field: its dimensions, its lines as curves on the ground, and samples along them.

mod curves;
mod dimensions;
mod presets;
mod projected;
mod sampling;

pub use self::{
    curves::{Curve, Goal, GoalPost},
    dimensions::{FieldDimensions, InvalidField},
    presets::preset_names,
    projected::{project_lines, project_polygon},
    sampling::{LineSample, VisibleSample, sample_lines, visible_samples},
};

#[cfg(test)]
mod tests;
