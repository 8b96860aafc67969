//! Kinds of pictures at a pose, and their views.

use reality_sim_synthesis::{Auto, Blend, Method, Nearest, Plane, Quadratic};
use serde::{Deserialize, Serialize};

/// Source of the picture at a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PictureKind {
    Auto,
    Nearest,
    Quadratic,
    Plane,
    Blend,
    Simulated,
    Truth,
}

impl PictureKind {
    /// All kinds, in the order of the list.
    pub const ALL: [Self; 7] =
        [Self::Auto, Self::Nearest, Self::Quadratic, Self::Plane, Self::Blend, Self::Simulated, Self::Truth];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::Truth => "true picture",
            _ => self.method().map_or("", Method::name),
        }
    }

    /// Returns a description in one sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Auto => {
                "The recorded picture where there is one at the pose, else a blend of its neighbours"
            }
            Self::Nearest => "The nearest recorded picture, as it is",
            Self::Quadratic => {
                "The nearest recorded picture, bent by a polynomial of second order: the paper's way"
            }
            Self::Plane => "One recorded picture, seen anew through the ground plane and the lens",
            Self::Blend => "Several recorded pictures, seen anew and mixed pixel by pixel",
            Self::Simulated => "Drawn from the model of the field: no recorded picture is in it",
            Self::Truth => {
                "The picture that was really taken here, where one was held back or a recording is compared with"
            }
        }
    }

    /// Returns the synthesis method, for kinds made from recorded pictures.
    pub fn method(self) -> Option<&'static dyn Method> {
        match self {
            Self::Auto => Some(&Auto),
            Self::Nearest => Some(&Nearest),
            Self::Quadratic => Some(&Quadratic),
            Self::Plane => Some(&Plane),
            Self::Blend => Some(&Blend),
            Self::Simulated | Self::Truth => None,
        }
    }
}

/// Aspect of a picture to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shown {
    /// The picture.
    #[default]
    Picture,
    /// The recorded image from which each pixel came.
    Origins,
    /// The trust of each pixel.
    Trust,
}

/// Kind of picture and the aspect to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct View {
    pub kind: PictureKind,
    pub shown: Shown,
}

impl View {
    /// Shows the picture of a kind.
    pub fn picture(kind: PictureKind) -> Self {
        Self { kind, shown: Shown::Picture }
    }
}
