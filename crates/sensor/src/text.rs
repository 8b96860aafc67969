//! Numbers in words: with the digits that their uncertainty justifies, in units that are easy to imagine.

mod number;
mod unit;

pub use self::{
    number::{Uncertain, digits, percent, rounded, with_interval, with_sigma},
    unit::{Amount, Unit},
};
