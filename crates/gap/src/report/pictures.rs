//! Pictures of one frame: as recorded, and as drawn by the given and the extended model.

use glam::DVec2;
use image::{GrayImage, Luma, RgbImage};
use reality_sim_core::sequence::SequenceError;
use reality_sim_sensor::{Chain, Model, ModelError, RenderError, Renderer, SceneColors};

use crate::{
    measurement::camera::FrameCamera, measurement::visibility::Visibility, recording::Recording,
    report::analysis::Analysis,
};

/// Frame in three versions, with a mask of the field.
#[derive(Debug, Clone, PartialEq)]
pub struct Pictures {
    /// Frame as recorded.
    pub measured: RgbImage,
    /// Frame as the given model draws it.
    pub before: RgbImage,
    /// Frame as the extended model draws it.
    pub after: RgbImage,
    /// Mask that is 255 where the extended model sees the field, where everything compared lies, and 0 elsewhere.
    pub field: GrayImage,
}

/// Reason why the pictures cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PicturesError {
    /// The recorded picture cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The model does not describe a valid camera.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The frame cannot be drawn at its reference pose.
    #[error("frame {index} cannot be drawn")]
    Pose {
        /// Index of the frame in the recording.
        index: usize,
        /// Fault of the pose.
        source: RenderError,
    },
}

impl Pictures {
    /// Makes the pictures of the frame that the report shows.
    pub fn new(recording: &Recording<'_>, given: &Model, analysis: &Analysis) -> Result<Self, PicturesError> {
        let sequence = recording.sequence;
        let index = analysis.report.shown_frame;
        let time_s = sequence.frames.get(index).map_or(0.0, |frame| frame.timestamp_s);
        let measured = sequence.load_image(index)?;
        let (width, height) = measured.dimensions();
        let colors = SceneColors::new(&sequence.setup, &sequence.field);
        let drawn = |model: &Model| -> Result<RgbImage, PicturesError> {
            let renderer = Renderer::with_model(&sequence.setup, &sequence.field, colors, model)?;
            match renderer.draw_at(&recording.trajectory, time_s, None) {
                // A camera under the ground sees nothing; why it is there is in the report.
                Err(RenderError::NotAboveGround { .. } | RenderError::TooFar(_)) => {
                    Ok(RgbImage::new(width, height))
                }
                drawn => drawn.map_err(|source| PicturesError::Pose { index, source }),
            }
        };
        let chain = Chain::new(&sequence.setup, &sequence.field, &analysis.model)?;
        let view = FrameCamera::new(&chain, &recording.trajectory, time_s);
        let visibility = Visibility::new(&view);
        let field = GrayImage::from_fn(measured.width(), measured.height(), |x, y| {
            let shows_field = visibility.shows_field(DVec2::new(f64::from(x), f64::from(y)));
            Luma([if shows_field { u8::MAX } else { 0 }])
        });
        Ok(Self { measured, before: drawn(given)?, after: drawn(&analysis.model)?, field })
    }
}
