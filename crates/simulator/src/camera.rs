//! The camera.

use std::sync::{Arc, OnceLock};

use image::RgbImage;
use reality_sim_core::{pose::CameraPose, sequence::CameraSetup};
use reality_sim_sensor::{Chain, Model, ModelError, Twist};
use reality_sim_synthesis::{Archive, MethodKind, Synthesizer};

use crate::{
    canvas::Canvas,
    drawing::{Drawing, Moment},
    error::LookError,
    frame::Frame,
    labels::{Labeler, Labels, Overlay},
    layer::Layer,
    layer_settings::LayerSettings,
    path::Path,
    seen_object::NO_OBJECT,
};

/// Camera that a simulator moves over a recorded field. Where it moves smoothly, a picture costs less: the neighbours of the
/// last one are kept for some pixels of motion, and those of the next ones are decoded ahead. Clones share everything but their
/// path and their memory for drawing: give each thread one, or use a [`crate::CameraPool`].
#[derive(Debug, Clone)]
pub struct Camera {
    synthesizer: Arc<Synthesizer>,
    method: MethodKind,
    chain: Chain,
    settings: LayerSettings,
    /// Made with the first layer: pictures without one do not need it.
    drawing: Arc<OnceLock<Drawing>>,
    moment: Moment,
    canvases: Vec<Vec<Canvas>>,
    path: Path,
    labeler: Option<Arc<Labeler>>,
}

impl Camera {
    /// Makes a camera like the one that took the archive's images.
    pub fn new(archive: Arc<Archive>) -> Self {
        Self::with(Arc::new(Synthesizer::new(archive)), MethodKind::default())
    }

    /// Makes a camera whose pictures come from a synthesizer, by a method.
    pub fn with(synthesizer: Arc<Synthesizer>, method: MethodKind) -> Self {
        let chain = Chain::nominal(&setup(&synthesizer), synthesizer.archive().field());
        Self {
            synthesizer,
            method,
            chain,
            settings: LayerSettings::default(),
            drawing: Arc::default(),
            moment: Moment::default(),
            canvases: Vec::new(),
            path: Path::new(true),
            labeler: None,
        }
    }

    /// Sends layers through the effects of a model, as `gap` finds them: lens, blur, exposure, noise, tone curve. Recorded
    /// pictures have them already; give [`Archive::with_model`] the same model. Fails where it leaves no valid camera.
    pub fn with_model(self, model: &Model) -> Result<Self, ModelError> {
        let archive = self.synthesizer.archive();
        let chain = Chain::new(&setup(&self.synthesizer), archive.field(), &archive.missing_of(model))?;
        Ok(Self { chain, drawing: Arc::default(), ..self })
    }

    /// Sets whether a thread decodes the pictures that the camera is about to need; it does by default. Pictures are the same
    /// without it.
    pub fn with_decoding_ahead(self, is_wanted: bool) -> Self {
        Self { path: Path::new(is_wanted), ..self }
    }

    /// Sets what is done to layers on their way into the picture.
    pub fn with_layer_settings(self, settings: LayerSettings) -> Self {
        Self { settings, ..self }
    }

    /// Sets whether frames get labels. The first time takes some milliseconds; clones of a camera share the work.
    pub fn with_labels(self, is_wanted: bool) -> Self {
        let archive = self.synthesizer.archive();
        let new = || {
            let lens = self.synthesizer.camera();
            Arc::new(Labeler::new(lens, archive.field(), archive.proxy_geometry()))
        };
        let labeler = is_wanted.then(|| self.labeler.clone().unwrap_or_else(new));
        Self { labeler, ..self }
    }

    /// Returns the synthesizer behind the camera.
    pub fn synthesizer(&self) -> &Arc<Synthesizer> {
        &self.synthesizer
    }

    /// Returns the camera with its effects, through which layers go.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Sets the time of the following pictures, seconds: their noise, and their exposure where that changes over time.
    pub fn set_time_s(&mut self, time_s: f64) {
        self.moment.time_s = time_s;
    }

    /// Sets the camera's velocity in the following pictures. It blurs layers as long as the model's exposure lasts; recorded
    /// pictures have the blur of their own motion.
    pub fn set_twist(&mut self, twist: Twist) {
        self.moment.twist = twist;
    }

    /// Forgets the path so far: the next picture is drawn from neighbours of its own pose, whatever came before.
    pub fn forget_path(&mut self) {
        self.path.forget();
    }

    /// Draws what the camera sees at a pose into a frame: the recorded scene with the layers before it. Fails where nothing was
    /// recorded near the pose, see [`LookError`]; the frame may then hold anything.
    pub fn look(
        &mut self,
        pose: CameraPose,
        layers: &[&dyn Layer],
        frame: &mut Frame,
    ) -> Result<(), LookError> {
        let lens = self.synthesizer.camera();
        if frame.picture.dimensions() != (lens.width, lens.height) {
            frame.picture = RgbImage::new(lens.width, lens.height);
        }
        let memory = &mut self.path.memory;
        let provenance = self.synthesizer.image_along(pose, &self.method, memory, &mut frame.picture)?;
        self.path.go_on(&self.synthesizer);
        frame.pose = pose;
        frame.covered = provenance.covered();
        frame.used = provenance.used;
        frame.origins = provenance.origins;
        self.add(pose, layers, frame);
        self.label(frame);
        Ok(())
    }

    /// Draws layers over a picture that was taken at a pose, such as one that no [`Camera`] made. Layers are left out where the
    /// picture does not have the camera's size or the pose is not above the ground.
    pub fn compose(&mut self, pose: CameraPose, layers: &[&dyn Layer], picture: RgbImage) -> Frame {
        let mut frame = Frame { pose, picture, ..Frame::default() };
        let lens = self.synthesizer.camera();
        if frame.picture.dimensions() == (lens.width, lens.height) && pose.is_possible() {
            self.add(pose, layers, &mut frame);
            self.label(&mut frame);
        }
        frame
    }

    fn label(&self, frame: &mut Frame) {
        let Some(labeler) = &self.labeler else {
            frame.labels = Labels::default();
            return;
        };
        let overlay =
            Overlay { objects: &frame.objects, object_of: &frame.object_of, distance_m: &frame.distance_m };
        labeler.label(frame.pose, &frame.origins, overlay, &mut frame.labels);
    }

    fn add(&mut self, pose: CameraPose, layers: &[&dyn Layer], frame: &mut Frame) {
        let pixels = frame.picture.width() as usize * frame.picture.height() as usize;
        frame.objects.clear();
        frame.object_of.clear();
        frame.object_of.resize(pixels, NO_OBJECT);
        frame.distance_m.clear();
        frame.distance_m.resize(pixels, f32::INFINITY);
        if layers.is_empty() {
            return;
        }
        let archive = self.synthesizer.archive();
        let drawing =
            self.drawing.get_or_init(|| Drawing::new(&self.chain, archive, &setup(&self.synthesizer)));
        drawing.add(archive, (pose, self.moment), layers, self.settings, &mut self.canvases, frame);
    }
}

/// Returns the nominal camera of a synthesizer's pictures.
fn setup(synthesizer: &Synthesizer) -> CameraSetup {
    CameraSetup { camera: synthesizer.camera().clone(), ..synthesizer.archive().setup().clone() }
}
