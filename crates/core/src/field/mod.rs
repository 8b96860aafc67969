//! The soccer field: its dimensions, its lines as curves on the ground, and samples along them.

mod curves;
mod dimensions;
mod sampling;

pub use self::{
    curves::{Curve, Goal, GoalPost},
    dimensions::{FieldDimensions, InvalidField},
    sampling::{LineSample, VisibleSample, sample_lines, visible_samples},
};
