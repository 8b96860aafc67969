//! The two models that are compared: as it was given, and with what was found.

use eframe::egui::Color32;
use reality_sim_gap::report::{Course, Map};
use serde::{Deserialize, Serialize};

use crate::colors;

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    #[default]
    Without,
    With,
}

impl Side {
    /// Both, the one that comes first before.
    pub const ALL: [Self; 2] = [Self::Without, Self::With];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Without => "without the effect",
            Self::With => "with the effect",
        }
    }

    /// What it is, in a sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Without => "As the given model draws it",
            Self::With => "As the model draws it that has the effects that were found",
        }
    }

    /// The colour of its curve.
    pub fn color(self) -> Color32 {
        match self {
            Self::Without => colors::GIVEN,
            Self::With => colors::EXTENDED,
        }
    }

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Without => Self::With,
            Self::With => Self::Without,
        }
    }

    /// Its part of a pair.
    pub fn of<T>(self, pair: &[T; 2]) -> &T {
        &pair[usize::from(self == Self::With)]
    }

    /// Its values in a map.
    pub fn of_map(self, map: &Map) -> &[Option<f64>] {
        match self {
            Self::Without => &map.before,
            Self::With => &map.after,
        }
    }

    /// Its values over time.
    pub fn of_course(self, course: &Course) -> &[Option<f64>] {
        match self {
            Self::Without => &course.before,
            Self::With => &course.after,
        }
    }
}
