//! Composition of all layers with each other and with the recorded scene, by depth.

mod over;
mod pixel;
mod tile;

pub(crate) use self::{
    over::{Composed, Scene, Tally, compose},
    tile::areas,
};
