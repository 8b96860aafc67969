//! Numbers as a person says them: with as many digits as their uncertainty leaves, in units that are easy to imagine.

mod number;
mod unit;

pub use self::{
    number::{Uncertain, digits, percent, rounded, with_interval, with_sigma},
    unit::{Amount, Unit},
};
