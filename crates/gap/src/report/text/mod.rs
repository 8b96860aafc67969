//! What was found, as a person says it.

mod names;
mod number;
mod place;
mod size;
mod summary;

pub(crate) use self::{
    names::{directed, limit_in_words},
    number::{amount, closed, digits, has_moved, in_channel, percent, probability, rounded, with_sigma},
    place::{field_place, picture_place},
    size::size_in_words,
    summary::{Findings, summary},
};
