//! The two models that are compared: the given one, and the one with the effects found.

use eframe::egui::Color32;
use reality_sim_gap::report::{Course, Map};
use serde::{Deserialize, Serialize};

use crate::colors;

/// One of the two models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    #[default]
    Without,
    With,
}

impl Side {
    /// Both models in order.
    pub const ALL: [Self; 2] = [Self::Without, Self::With];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Without => "without the effect",
            Self::With => "with the effect",
        }
    }

    /// Returns a description in one sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Without => "As the given model draws it",
            Self::With => "As the model draws it that has the effects that were found",
        }
    }

    /// Returns the colour of the model's curve.
    pub fn color(self) -> Color32 {
        match self {
            Self::Without => colors::GIVEN,
            Self::With => colors::EXTENDED,
        }
    }

    /// Returns the other model.
    pub fn other(self) -> Self {
        match self {
            Self::Without => Self::With,
            Self::With => Self::Without,
        }
    }

    /// Returns this model's element of a pair.
    pub fn of<T>(self, pair: &[T; 2]) -> &T {
        &pair[usize::from(self == Self::With)]
    }

    /// Returns this model's values in a map.
    pub fn of_map(self, map: &Map) -> &[Option<f64>] {
        match self {
            Self::Without => &map.before,
            Self::With => &map.after,
        }
    }

    /// Returns this model's values over time.
    pub fn of_course(self, course: &Course) -> &[Option<f64>] {
        match self {
            Self::Without => &course.before,
            Self::With => &course.after,
        }
    }
}
