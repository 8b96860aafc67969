//! The camera.

use std::sync::Arc;

use image::RgbImage;
use reality_sim_core::pose::CameraPose;
use reality_sim_synthesis::{Archive, MethodKind, Synthesizer};

use crate::{Frame, LookError, labels::{Labeler, Labels}};

/// Camera that a simulator moves over a recorded field.
#[derive(Debug, Clone)]
pub struct Camera {
    synthesizer: Arc<Synthesizer>,
    method: MethodKind,
    labeler: Option<Arc<Labeler>>,
}

impl Camera {
    /// Makes a camera like the one that took the archive's images.
    pub fn new(archive: Arc<Archive>) -> Self {
        Self::with(Arc::new(Synthesizer::new(archive)), MethodKind::default())
    }

    /// Makes a camera whose pictures come from a synthesizer, by a method.
    pub fn with(synthesizer: Arc<Synthesizer>, method: MethodKind) -> Self {
        Self { synthesizer, method, labeler: None }
    }

    /// Sets whether frames get labels. The first time takes some milliseconds; clones of a camera share the work.
    pub fn with_labels(self, is_wanted: bool) -> Self {
        let Self { synthesizer, method, labeler } = self;
        let archive = synthesizer.archive();
        let new = || Arc::new(Labeler::new(synthesizer.camera(), archive.field(), archive.proxy_geometry()));
        let labeler = is_wanted.then(|| labeler.unwrap_or_else(new));
        Self { synthesizer, method, labeler }
    }

    /// Returns the synthesizer behind the camera.
    pub fn synthesizer(&self) -> &Arc<Synthesizer> {
        &self.synthesizer
    }

    /// Draws what the camera sees at a pose into a frame.
    pub fn look(&mut self, pose: CameraPose, frame: &mut Frame) -> Result<(), LookError> {
        let lens = self.synthesizer.camera();
        if frame.picture.dimensions() != (lens.width, lens.height) {
            frame.picture = RgbImage::new(lens.width, lens.height);
        }
        let provenance = self.synthesizer.image_into(pose, &self.method, &mut frame.picture)?;
        frame.pose = pose;
        frame.used = provenance.used;
        frame.origins = provenance.origins;
        match &self.labeler {
            Some(labeler) => labeler.label(pose, &frame.origins, &mut frame.labels),
            None => frame.labels = Labels::default(),
        }
        Ok(())
    }
}
