//! Balls that are added to recorded pictures.

use std::sync::Arc;

use image::RgbImage;

use reality_sim::{
    StampedPose, Synthesizer,
    simulator::{Ball, Camera, Layer},
    synthesis::MethodKind,
};

use crate::commands::{model_file::ModelFile, wanted_ball::WantedBall};

/// Adds balls to pictures.
#[derive(Debug)]
pub struct BallComposer {
    camera: Camera,
    balls: Vec<Ball>,
}

impl BallComposer {
    /// Prepares the camera that took the pictures, with the effects of a model if there is one.
    pub fn new(
        synthesizer: &Arc<Synthesizer>,
        method: MethodKind,
        model: Option<&ModelFile>,
        balls: &[WantedBall],
    ) -> anyhow::Result<Self> {
        let camera = Camera::with(synthesizer.clone(), method);
        let camera = match model {
            Some(model) => camera.with_model(&model.model).map_err(|error| error.in_file(model.path()))?,
            None => camera,
        };
        Ok(Self { camera, balls: balls.iter().map(WantedBall::layer).collect() })
    }

    /// Returns a picture with the balls in it.
    pub fn add(&self, StampedPose { timestamp_s, pose }: StampedPose, picture: RgbImage) -> RgbImage {
        let mut camera = self.camera.clone();
        camera.set_time_s(timestamp_s);
        let layers: Vec<&dyn Layer> = self.balls.iter().map(|ball| ball as &dyn Layer).collect();
        camera.compose(pose, &layers, picture).picture
    }
}
