//! A camera for tests of what is drawn.

use glam::{DVec3, Vec3};
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
    sequence::CameraSetup,
};
use reality_sim_sensor::{Chain, Development, Twist};

use crate::{
    field_surfaces::FieldSurfaces, light_reference::LightReference, scene_light::SceneLight, view::View,
};

/// Everything that a view refers to.
pub(crate) struct TestCamera {
    pub(crate) chain: Chain,
    development: Development,
    reference: LightReference,
    surfaces: FieldSurfaces,
}

impl TestCamera {
    pub(crate) fn new(distortion: Distortion) -> Self {
        let camera = Camera::new([160, 120], [54.0, 53.0, 79.5, 60.3], distortion).unwrap();
        let setup = CameraSetup { camera, mount_height_m: 0.5, photometry: None };
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let chain = Chain::nominal(&setup, &field);
        let reference = LightReference {
            line_linear_rgb: Vec3::splat(0.4),
            carpet_linear_rgb: Vec3::new(0.04, 0.1, 0.05),
        };
        Self { development: Development::new(&chain), chain, reference, surfaces: FieldSurfaces::new(&field) }
    }

    /// Makes cameras of all lens models.
    pub(crate) fn of_all_lenses() -> [Self; 3] {
        let fisheye = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
        let brown = Opencv { k1: -0.05, k2: 0.003, p1: 0.001, p2: -0.001, k3: 0.0 };
        [Distortion::Pinhole, Distortion::Opencv(brown), Distortion::OpencvFisheye(fisheye)].map(Self::new)
    }

    pub(crate) fn view(&self, pose: CameraPose) -> View<'_> {
        View {
            chain: &self.chain,
            pose,
            world_from_camera: pose.rotation_world_from_camera(),
            twist: Twist::default(),
            time_s: 0.0,
            magnification: 1.0,
            light: SceneLight {
                reference: &self.reference,
                development: &self.development,
                surfaces: &self.surfaces,
                picture: None,
                pose,
                gain: [1.0; 3],
            },
        }
    }
}

/// Returns a pose from which tests look.
pub(crate) fn usual_pose() -> CameraPose {
    CameraPose::new(Pose2::new(0.3, -0.2, 0.6), 0.5, 0.4, 0.05)
}

/// Returns the place at this distance from the camera in the direction of a pixel.
pub(crate) fn place_at(view: &View<'_>, pixel: [f64; 2], distance_m: f64) -> DVec3 {
    view.pose().position_in_world() + distance_m * view.ray(pixel.into()).unwrap()
}
