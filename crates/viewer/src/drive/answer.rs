//! Answers to requests for pictures.

use std::sync::Arc;

use eframe::egui::ColorImage;
use reality_sim_core::pose::CameraPose;
use reality_sim_db::index::Neighbour;
use reality_sim_synthesis::UsedImage;

use super::{
    edges::Edges, kind::Pane, overlay::Marks, source::NearProbe, staging::SeenThing, things::PlacedThing,
};

/// Data around a pose.
#[derive(Debug, Clone)]
pub struct Around {
    /// The nearest recorded image.
    pub nearest: Option<Neighbour>,
    /// The natural neighbours with their weights.
    pub natural: Vec<Neighbour>,
    /// Edges of the triangulation, if they were requested.
    pub edges: Vec<Edges>,
    /// The nearest true picture.
    pub probe: Option<NearProbe>,
}

/// Drawn picture.
#[derive(Debug, Clone)]
pub struct Drawn {
    pub picture: Arc<ColorImage>,
    pub facts: Facts,
    /// Things in the picture.
    pub things: Vec<SeenThing>,
    /// Labels, if they were asked for.
    pub marks: Option<Arc<Marks>>,
}

/// Times of the parts of a picture, milliseconds; none for parts that it does not have.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Times {
    /// Drawing of the scene, with decoding; none where the scene was there already and only the things have changed.
    pub drawing_ms: Option<f64>,
    pub things_ms: Option<f64>,
    pub labels_ms: Option<f64>,
}

impl Times {
    /// Returns the time of the whole picture, milliseconds.
    pub fn whole_ms(&self) -> f64 {
        [self.drawing_ms, self.things_ms, self.labels_ms].into_iter().flatten().sum()
    }
}

/// Facts about a picture.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Method that was actually used.
    pub method: &'static str,
    pub times: Times,
    /// Pictures of this pane in the second before, per second; `None` where this one is alone.
    pub frames_per_s: Option<f64>,
    /// Fraction of the pixels that some recorded image covers; `None` for pictures not made from such images.
    pub covered: Option<f64>,
    /// Images from which the picture was made.
    pub used: Vec<UsedImage>,
    /// PSNR in dB of the scene over the carpet against the true picture, if there is one at the pose.
    pub likeness_db: Option<f64>,
    /// The frame shown, for a true picture.
    pub probe: Option<NearProbe>,
}

/// Picture of a pane at a pose with things, or the reason why there is none.
#[derive(Debug, Clone)]
pub struct Painted {
    pub pose: CameraPose,
    pub things: Vec<PlacedThing>,
    pub result: Result<Drawn, String>,
}

/// Answer of the drawing thread.
pub enum Answer {
    Around(Around),
    Painted(Pane, Painted),
    /// Problem to show to the user.
    Problem(String),
}
