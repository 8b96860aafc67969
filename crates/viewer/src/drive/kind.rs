//! The pictures there are of a pose, and what can be shown of one.

use reality_sim_synthesis::{Auto, Blend, Method, Nearest, Plane, Quadratic};
use serde::{Deserialize, Serialize};

/// A way to the picture at a pose.
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
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 7] =
        [Self::Auto, Self::Nearest, Self::Quadratic, Self::Plane, Self::Blend, Self::Simulated, Self::Truth];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::Truth => "true picture",
            _ => self.method().map_or("", Method::name),
        }
    }

    /// What it is, in a sentence.
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

    /// The method that makes it of recorded pictures.
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

/// What is shown of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shown {
    /// The picture itself.
    #[default]
    Picture,
    /// Which recorded image each pixel came from.
    Origins,
    /// How far each pixel can be trusted.
    Trust,
}

/// Something to look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct View {
    pub kind: PictureKind,
    pub shown: Shown,
}

impl View {
    /// The picture itself.
    pub fn picture(kind: PictureKind) -> Self {
        Self { kind, shown: Shown::Picture }
    }
}
