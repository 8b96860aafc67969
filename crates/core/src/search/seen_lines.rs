//! Lines that a picture shows, and how much of them a pose explains: the converse of the observation models, which ask how much of
//! what a pose predicts the picture shows. At a wrong place some lines may fit, but others are then where none should be.

use glam::{DMat3, DVec2, DVec3};

use crate::{
    camera::Camera,
    field::{Curve, FieldDimensions},
    pose::CameraPose,
    preprocess::Prepared,
};

/// Number of white pixels that are looked at: a fraction is then known to 3 %, √(p (1 − p) / 300).
const PIXELS: usize = 300;

/// One pixel of so many is looked at where a rough answer will do.
const ROUGHLY_EVERY: usize = 3;

/// Angle by which a pixel may be off its line, radians: the standard deviation of the mount pose, which moves all lines of a
/// picture without making its place wrong.
const TOLERANCE_RAD: f64 = 0.01;

/// Largest distance on the ground by which a pixel may be off its line, metres, however far away it is: a quarter of the depth of the
/// smallest goal area among the presets, whose lines are the closest parallel ones.
const MOST_TOLERANCE_M: f64 = 0.15;

/// White lines of one picture, as rays from the camera through some of their pixels.
#[derive(Debug, Clone, Default)]
pub(crate) struct SeenLines {
    rays_in_camera: Vec<DVec3>,
    curves: Vec<Curve>,
    half_width_m: f64,
}

impl SeenLines {
    /// Finds the lines of a picture.
    pub fn new(camera: &Camera, field: &FieldDimensions, picture: &Prepared) -> Self {
        let every = picture.white_pixels.len().div_ceil(PIXELS).max(1);
        let white = picture.white_pixels.iter().step_by(every);
        let ray = |&[u, v]: &[u32; 2]| camera.unproject(DVec2::new(f64::from(u), f64::from(v))).ok();
        Self {
            rays_in_camera: white.filter_map(ray).collect(),
            curves: field.curves(),
            half_width_m: 0.5 * field.line_width_m,
        }
    }

    /// Returns the fraction of the lines' pixels that lie on lines of the field as seen from a pose; 1 if there are no lines.
    pub fn explained_fraction(&self, pose: CameraPose) -> f64 {
        self.explained_of_every(pose, 1)
    }

    /// Works as [`SeenLines::explained_fraction`], faster and less exactly, for a great number of poses.
    pub fn roughly_explained_fraction(&self, pose: CameraPose) -> f64 {
        self.explained_of_every(pose, ROUGHLY_EVERY)
    }

    fn explained_of_every(&self, pose: CameraPose, every: usize) -> f64 {
        if self.rays_in_camera.is_empty() || pose.height_m <= 0.0 {
            return 1.0;
        }
        let world_from_camera = pose.rotation_world_from_camera();
        let rays = || self.rays_in_camera.iter().step_by(every);
        let explained = rays().filter(|ray| self.explains(pose, world_from_camera, **ray));
        explained.count() as f64 / rays().len() as f64
    }

    fn explains(&self, pose: CameraPose, world_from_camera: DMat3, ray_in_camera: DVec3) -> bool {
        let ray_in_world = world_from_camera * ray_in_camera;
        if ray_in_world.z >= 0.0 {
            return false;
        }
        let distance_m = -pose.height_m / ray_in_world.z;
        let ground = pose.planar().position_in_world() + distance_m * ray_in_world.truncate();
        // A ray that is tilted by an angle meets the ground farther away by the angle times distance² / height.
        let tolerance_m = (TOLERANCE_RAD * distance_m * distance_m / pose.height_m).min(MOST_TOLERANCE_M);
        self.curves.iter().any(|curve| curve.distance_m(ground) <= self.half_width_m + tolerance_m)
    }
}
