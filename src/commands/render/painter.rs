//! Source of the pictures: recorded ones, or the model of the field.

use std::{path::Path, time::Instant};

use image::RgbImage;

use reality_sim::{
    FieldDimensions, Reconstruction, StampedPose, Synthesizer,
    sensor::{Model, Renderer, SceneColors, Trajectory},
    sequence::CameraSetup,
    synthesis::MethodKind,
};

use super::options::PictureMethod;

/// Pictures at different times have different noise.
const NOISE_SEED: u64 = 0;

/// Source of the pictures.
pub enum Painter<'a> {
    Recorded(&'a Synthesizer, MethodKind),
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
        model: &Path,
        trajectory: Trajectory,
        field: &FieldDimensions,
        setup: &CameraSetup,
    ) -> anyhow::Result<Self> {
        let colors = SceneColors::new(setup, field);
        let renderer = Renderer::with_model(setup, field, colors, &Model::read(model)?);
        Ok(Self::Modelled(Box::new(renderer.map_err(|error| error.in_file(model))?), trajectory))
    }

    /// Returns the name of the method.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Recorded(_, method) => method.name(),
            Self::Simulated(_) | Self::Modelled(..) => Renderer::NAME,
        }
    }

    /// Draws the picture at a pose.
    pub fn paint(&self, StampedPose { timestamp_s, pose }: StampedPose) -> anyhow::Result<Painted> {
        let start = Instant::now();
        let work = match self {
            Self::Recorded(synthesizer, method) => Work::Reconstructed(synthesizer.image_at(pose, method)?),
            Self::Simulated(renderer) => Work::Drawn(renderer.draw(pose)?),
            Self::Modelled(renderer, trajectory) => {
                Work::Drawn(renderer.draw_at(trajectory, timestamp_s, Some(NOISE_SEED))?)
            }
        };
        Ok(Painted { work, milliseconds: 1e3 * start.elapsed().as_secs_f64() })
    }
}
