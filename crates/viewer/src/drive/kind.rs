//! Kinds of pictures at a pose, and the panes that show them.

use reality_sim_sensor::Renderer;
use reality_sim_synthesis::MethodKind;
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
        match self.made_by() {
            MadeBy::Method(method) => method.name(),
            MadeBy::Renderer => Renderer::NAME,
            MadeBy::Camera => "true picture",
        }
    }

    /// Returns a description in one sentence.
    pub fn meaning(self) -> &'static str {
        match self.made_by() {
            MadeBy::Method(method) => method.description(),
            MadeBy::Renderer => "Drawn from the model of the field: no recorded picture is in it",
            MadeBy::Camera => {
                "The picture that was really taken here, where one was held back or a recording is compared with"
            }
        }
    }

    /// Returns what makes the picture.
    pub fn made_by(self) -> MadeBy {
        match self {
            Self::Auto => MadeBy::Method(MethodKind::Auto),
            Self::Nearest => MadeBy::Method(MethodKind::Nearest),
            Self::Quadratic => MadeBy::Method(MethodKind::Quadratic),
            Self::Plane => MadeBy::Method(MethodKind::Plane),
            Self::Blend => MadeBy::Method(MethodKind::Blend),
            Self::Simulated => MadeBy::Renderer,
            Self::Truth => MadeBy::Camera,
        }
    }
}

/// Maker of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MadeBy {
    /// A method, from recorded pictures.
    Method(MethodKind),
    /// The renderer of the field's model.
    Renderer,
    /// The camera that stood there.
    Camera,
}

/// Aspect of a picture to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Aspect {
    /// The picture.
    #[default]
    Picture,
    /// The recorded image from which each pixel came.
    Origins,
    /// The trust of each pixel.
    Trust,
}

/// Pane on the screen: the kind of picture that it shows, and which aspect of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pane {
    pub kind: PictureKind,
    pub aspect: Aspect,
}

impl Pane {
    /// Shows the picture of a kind.
    pub fn picture(kind: PictureKind) -> Self {
        Self { kind, aspect: Aspect::Picture }
    }
}
