//! What was found, as a person says it.

mod number;
mod place;
mod summary;

pub(crate) use reality_sim_sensor::text::{digits, percent, rounded, with_sigma};

pub(crate) use self::{
    number::{amount, closed, has_moved, in_channel, probability},
    place::{field_place, picture_place},
    summary::{Findings, summary},
};
