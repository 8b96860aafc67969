//! What a picture shows.

use reality_sim::simulator;

/// Class of a pixel or of a thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub enum Class {
    /// Neither field nor object: the hall, its floor beside the carpet, and what the lens leaves black.
    Outside = 0,
    /// Carpet without a line.
    Carpet = 1,
    /// White line or mark.
    Line = 2,
    /// Post, crossbar or net of a goal.
    Goal = 3,
    /// Ball.
    Ball = 4,
    /// Robot.
    Robot = 5,
}

/// Ball or robot as the camera saw it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct SeenObject {
    /// Class.
    pub class: Class,
    /// Whether a pixel shows it. The box is empty where none does.
    pub is_visible: bool,
    /// First column of the pixels that show it.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// Column after the last one.
    pub right: u32,
    /// Row after the last one.
    pub bottom: u32,
    /// Share of its pixels in the picture that show it, 0 to 1: what is left is behind something.
    pub visibility: f64,
    /// Share of it that lies outside the picture, 0 to 1.
    pub truncation: f64,
}

impl From<simulator::Class> for Class {
    fn from(class: simulator::Class) -> Self {
        match class {
            simulator::Class::Outside => Self::Outside,
            simulator::Class::Carpet => Self::Carpet,
            simulator::Class::Line => Self::Line,
            simulator::Class::Goal => Self::Goal,
            simulator::Class::Ball => Self::Ball,
            simulator::Class::Robot => Self::Robot,
        }
    }
}

impl From<&simulator::SeenObject> for SeenObject {
    fn from(object: &simulator::SeenObject) -> Self {
        let [left, top, right, bottom] =
            object.visible.map_or([0; 4], |area| [area.left, area.top, area.right, area.bottom]);
        Self {
            class: object.class.into(),
            is_visible: object.visible.is_some(),
            left,
            top,
            right,
            bottom,
            visibility: object.visibility(),
            truncation: object.truncation.into(),
        }
    }
}
