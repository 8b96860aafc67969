//! A camera of Bevy's world.

use bevy::{
    asset::{Assets, Handle},
    ecs::component::Component,
    image::Image,
    transform::components::Transform,
};
use reality_sim::{
    CameraPose,
    simulator::{Camera, Frame, Layer, LookError},
};

use crate::picture::black_image;

/// Camera that sees the recorded field from the place of its entity, along the entity's forward direction, with the balls and
/// robots of Bevy's world.
#[derive(Debug, Component)]
#[require(Transform)]
pub struct RealityCamera {
    /// Camera of the library: its database, method, effects, and whether it makes labels.
    pub camera: Camera,
    /// Picture with what is known of its pixels, while the status is [`LookStatus::Seen`]; else it may hold anything.
    pub frame: Frame,
    /// Image into which the picture is written: for sprites, user interfaces, materials.
    pub image: Handle<Image>,
    /// Whether the image is what the camera sees.
    pub status: LookStatus,
    /// Whether it looks at all; one that does not keeps its image.
    pub is_active: bool,
}

impl RealityCamera {
    /// Makes a camera with a black image of the size of its pictures.
    pub fn new(camera: Camera, images: &mut Assets<Image>) -> Self {
        let lens = &camera.synthesizer().archive().setup().camera;
        let image = images.add(black_image(lens.width, lens.height));
        Self { camera, frame: Frame::default(), image, status: LookStatus::default(), is_active: true }
    }

    /// Looks from a pose, and sets frame and status.
    pub(crate) fn look(&mut self, pose: CameraPose, layers: &[&dyn Layer], time_s: f64) {
        self.camera.set_time_s(time_s);
        self.status = match self.camera.look(pose, layers, &mut self.frame) {
            Ok(()) => LookStatus::Seen,
            Err(error) if error.is_refusal() => LookStatus::NotRecorded(error),
            Err(error) => LookStatus::Failed(error),
        };
    }
}

/// What the image of a camera is.
#[derive(Debug, Default)]
pub enum LookStatus {
    /// Black: the camera has not looked yet.
    #[default]
    Waiting,
    /// What the camera sees.
    Seen,
    /// The last picture that there was: too little was recorded near the camera's pose.
    NotRecorded(LookError),
    /// The last picture that there was: no camera above a field can have the pose, or there is a fault, such as a database that
    /// cannot be read.
    Failed(LookError),
}

impl LookStatus {
    /// Returns whether the image is what the camera sees.
    pub fn is_seen(&self) -> bool {
        matches!(self, Self::Seen)
    }

    /// Returns why the image is not what the camera sees.
    pub fn error(&self) -> Option<&LookError> {
        match self {
            Self::Waiting | Self::Seen => None,
            Self::NotRecorded(error) | Self::Failed(error) => Some(error),
        }
    }
}
