//! Source of the pictures: recorded ones, or the model of the field.

use std::time::Instant;

use image::RgbImage;

use reality_sim::{
    Archive, Reconstruction, StampedPose, Synthesizer,
    sensor::{Renderer, SceneColors, Trajectory},
    sequence::CameraSetup,
    synthesis::MethodKind,
};

use super::{balls::BallComposer, options::PictureMethod};
use crate::commands::model_file::ModelFile;

/// Pictures at different times have different noise.
const NOISE_SEED: u64 = 0;

/// Source of the pictures.
pub enum Painter<'a> {
    Recorded(&'a Synthesizer, MethodKind),
    /// Recorded pictures to which balls are added.
    Composed(&'a Synthesizer, MethodKind, Box<BallComposer>),
    Simulated(Box<Renderer>),
    /// Simulated camera with effects, moving along its trajectory.
    Modelled(Box<Renderer>, Trajectory),
}

/// Picture with the time that it took.
pub struct Painted {
    pub work: Work,
    pub milliseconds: f64,
}

/// Picture with or without the origins of its pixels.
pub enum Work {
    Reconstructed(Reconstruction),
    Drawn(RgbImage),
}

impl Work {
    /// Returns the picture.
    pub fn picture(&self) -> &RgbImage {
        match self {
            Self::Reconstructed(reconstruction) => &reconstruction.picture,
            Self::Drawn(picture) => picture,
        }
    }

    /// Share of the pixels that some recorded picture shows, if the picture is made from such.
    pub fn covered(&self) -> Option<f64> {
        match self {
            Self::Reconstructed(reconstruction) => Some(reconstruction.covered()),
            Self::Drawn(_) => None,
        }
    }
}

impl<'a> Painter<'a> {
    /// Makes a painter for this method; `setup` is the camera whose pictures are made.
    pub fn new(method: PictureMethod, synthesizer: &'a Synthesizer, setup: &CameraSetup) -> Self {
        let field = synthesizer.archive().field();
        match method {
            PictureMethod::Recorded(kind) => Self::Recorded(synthesizer, kind),
            PictureMethod::Simulated => {
                let renderer = Renderer::new(setup, field, SceneColors::new(setup, field));
                Self::Simulated(Box::new(renderer))
            }
        }
    }

    /// Makes a painter for the simulated camera with the effects of a model file, moving along its trajectory.
    pub fn with_model(
        model: &ModelFile,
        archive: &Archive,
        trajectory: Trajectory,
        setup: &CameraSetup,
    ) -> anyhow::Result<Self> {
        let field = archive.field();
        let renderer = Renderer::with_model(
            setup,
            field,
            SceneColors::new(setup, field),
            &archive.missing_of(&model.model),
        );
        Ok(Self::Modelled(Box::new(renderer.map_err(|error| error.in_file(model.path()))?), trajectory))
    }

    /// Returns the name of the method.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Recorded(_, method) | Self::Composed(_, method, _) => method.name(),
            Self::Simulated(_) | Self::Modelled(..) => Renderer::NAME,
        }
    }

    /// Draws the picture at a pose.
    pub fn paint(&self, StampedPose { timestamp_s, pose }: StampedPose) -> anyhow::Result<Painted> {
        let start = Instant::now();
        let work = match self {
            Self::Recorded(synthesizer, method) => Work::Reconstructed(synthesizer.image_at(pose, method)?),
            Self::Composed(synthesizer, method, balls) => {
                let mut made = synthesizer.image_at(pose, method)?;
                made.picture = balls.add(StampedPose { timestamp_s, pose }, made.picture);
                Work::Reconstructed(made)
            }
            Self::Simulated(renderer) => Work::Drawn(renderer.draw(pose)?),
            Self::Modelled(renderer, trajectory) => {
                Work::Drawn(renderer.draw_at(trajectory, timestamp_s, Some(NOISE_SEED))?)
            }
        };
        Ok(Painted { work, milliseconds: 1e3 * start.elapsed().as_secs_f64() })
    }
}
