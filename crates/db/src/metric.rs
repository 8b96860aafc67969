//! Distance between two poses: by how many pixels the picture moves between them.
//!
//! A small motion δ = (forward, left, turn, rise, pitch, roll) of the camera moves what is seen at a pixel by J δ pixels,
//! where J is the derivative of the projection of the point seen there. The mean of |J δ|² over the picture is δᵀ M δ with
//! M = mean JᵀJ, and its square root is the distance: root mean square pixels. So there is no arbitrary factor between
//! metres and radians; the lens, height and pitch of the camera decide. The points lie on the ground and, beyond the
//! field, on a background at the distance of the carpet's corner from its centre.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use nalgebra::{Matrix2, Matrix3, Matrix6, Vector3, Vector6};

use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::{CameraPose, wrap_angle},
};

/// Columns and rows of the grid of pixels over which the motion is averaged.
const GRID: [u32; 2] = [32, 24];

/// Step of the numerical derivative, metres and radians.
const STEP: f64 = 1e-5;

/// Distance between poses of one camera, root mean square pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelMetric {
    /// Matrix M of forward, left, turn, rise, pitch and roll, pixels² per metre² and radian².
    matrix: Matrix6<f64>,
    /// Smallest number of pixels by which one metre in the plane moves the picture, whatever else moves as well.
    least_px_per_m: f64,
    /// Smallest number of pixels by which one radian of heading moves the picture, whatever else moves as well.
    least_px_per_rad: f64,
    /// Smallest share of the sum of the squares of these two that remains when place and heading change together.
    least_share: f64,
    /// Diagonal of the picture, pixels.
    diagonal_px: f64,
}

impl PixelMetric {
    /// Builds the metric of a camera that is usually at this height, pitch and roll, on this field. `None` if the camera
    /// sees too little of the field for every motion to change the picture.
    pub fn new(camera: &Camera, usual: CameraPose, field: &FieldDimensions) -> Option<Self> {
        let pose = CameraPose { x_m: 0.0, y_m: 0.0, yaw_rad: 0.0, ..usual };
        let background_m = field.carpet_half_extent_m().length();
        let pixels = pixel_grid(camera);
        let seen = pixels
            .filter_map(|pixel| pixel_motion(camera, pose, point_seen(camera, pose, pixel, background_m)?));
        let (sum, count) = seen.fold((Matrix6::zeros(), 0), |(sum, count), square| (sum + square, count + 1));
        let matrix: Matrix6<f64> = sum / f64::from(count.max(1));
        let diagonal_px = f64::from(camera.width).hypot(f64::from(camera.height));
        let information = matrix.cholesky()?.inverse();
        // A block of the inverse gives what remains of the motion when all others compensate for it (Schur complement).
        let plane: Matrix2<f64> = information.fixed_view::<2, 2>(0, 0).into_owned().try_inverse()?;
        let least_px_per_m = plane.symmetric_eigenvalues().min().max(0.0).sqrt();
        let least_px_per_rad = (1.0 / information[(2, 2)]).sqrt();
        let least_share = least_share(&information, [least_px_per_m, least_px_per_m, least_px_per_rad])?;
        Some(Self { matrix, least_px_per_m, least_px_per_rad, least_share, diagonal_px })
    }

    /// Distance that the picture moves from one pose to the other, root mean square pixels, to first order. The motion is
    /// expressed in the axes of the mean heading, so that the distance is symmetric.
    pub fn distance_px(&self, a: CameraPose, b: CameraPose) -> f64 {
        let turn_rad = shorter_turn(b.yaw_rad - a.yaw_rad);
        let heading_rad = a.yaw_rad + 0.5 * turn_rad;
        let moved = DVec2::from_angle(-heading_rad).rotate(DVec2::new(b.x_m - a.x_m, b.y_m - a.y_m));
        let motion = Vector6::new(
            moved.x,
            moved.y,
            turn_rad,
            b.height_m - a.height_m,
            shorter_turn(b.pitch_rad - a.pitch_rad),
            shorter_turn(b.roll_rad - a.roll_rad),
        );
        (motion.transpose() * self.matrix * motion)[0].max(0.0).sqrt()
    }

    /// Lower bound of the distance, pixels, of two poses this far apart in the plane, metres.
    pub fn least_distance_px(&self, distance_m: f64) -> f64 {
        self.least_px_per_m * distance_m
    }

    /// Lower bound of the distance, pixels, of two poses whose headings differ by this much, radians.
    pub fn least_turn_px(&self, turn_rad: f64) -> f64 {
        self.least_px_per_rad * turn_rad
    }

    /// Lower bound of the distance, pixels, of two poses this far apart in the plane, metres, whose headings differ by
    /// this much, radians.
    pub fn least_px(&self, distance_m: f64, turn_rad: f64) -> f64 {
        let (plane_px, turn_px) = (self.least_distance_px(distance_m), self.least_turn_px(turn_rad));
        (self.least_share * (plane_px * plane_px + turn_px * turn_px)).sqrt().max(plane_px).max(turn_px)
    }

    /// Distance that a camera moves in the plane, metres, until the picture has moved by this, pixels, in the direction in
    /// which it moves most.
    pub fn reach_m(&self, distance_px: f64) -> f64 {
        let plane: Matrix2<f64> = self.matrix.fixed_view::<2, 2>(0, 0).into_owned();
        distance_px / plane.symmetric_eigenvalues().max().sqrt()
    }

    /// Returns the diagonal of the picture, pixels: pictures farther apart have nothing in common.
    pub fn diagonal_px(&self) -> f64 {
        self.diagonal_px
    }

    /// Returns M, of forward, left, turn, rise, pitch and roll, pixels² per metre² and radian².
    pub fn matrix(&self) -> &Matrix6<f64> {
        &self.matrix
    }
}

/// Largest c with |J δ|² ≥ c Σ (w δ)² over forward, left and turn, whatever height, pitch and roll do.
fn least_share(information: &Matrix6<f64>, weights: [f64; 3]) -> Option<f64> {
    let left_over: Matrix3<f64> = information.fixed_view::<3, 3>(0, 0).into_owned().try_inverse()?;
    let weights = Vector3::from(weights);
    let shares = left_over.component_div(&(weights * weights.transpose())).symmetric_eigenvalues();
    Some(shares.min().max(0.0))
}

/// Calls [`wrap_angle`], which divides, only if there is something to wrap: this saves a tenth of a search's time.
pub(crate) fn shorter_turn(angle_rad: f64) -> f64 {
    if angle_rad.abs() < PI { angle_rad } else { wrap_angle(angle_rad) }
}

fn pixel_grid(camera: &Camera) -> impl Iterator<Item = DVec2> {
    let place = |index: u32, count: u32, size: u32| {
        (f64::from(index) + 0.5) / f64::from(count) * f64::from(size) - 0.5
    };
    let (width, height) = (camera.width, camera.height);
    (0..GRID[1]).flat_map(move |row| {
        (0..GRID[0]).map(move |column| DVec2::new(place(column, GRID[0], width), place(row, GRID[1], height)))
    })
}

/// Point of the ground that is seen at a pixel, or of the background where that is nearer.
fn point_seen(camera: &Camera, pose: CameraPose, pixel: DVec2, background_m: f64) -> Option<DVec3> {
    camera.check_inside(pixel).ok()?;
    let ray = pose.rotation_world_from_camera() * camera.unproject(pixel).ok()?;
    let to_ground_m = if ray.z < 0.0 { -pose.height_m / ray.z } else { f64::INFINITY };
    Some(pose.position_in_world() + ray * to_ground_m.min(background_m))
}

/// Computes JᵀJ of a point by central differences.
fn pixel_motion(camera: &Camera, pose: CameraPose, point_in_world: DVec3) -> Option<Matrix6<f64>> {
    let mut gradients = [DVec2::ZERO; 6];
    for (axis, gradient) in gradients.iter_mut().enumerate() {
        let pixel = |step: f64| {
            camera.project_unbounded(moved(pose, axis, step).camera_from_world(point_in_world)).ok()
        };
        *gradient = (pixel(STEP)? - pixel(-STEP)?) / (2.0 * STEP);
    }
    Some(Matrix6::from_fn(|row, column| gradients[row].dot(gradients[column])))
}

fn moved(mut pose: CameraPose, axis: usize, step: f64) -> CameraPose {
    let coordinates = [
        &mut pose.x_m,
        &mut pose.y_m,
        &mut pose.yaw_rad,
        &mut pose.height_m,
        &mut pose.pitch_rad,
        &mut pose.roll_rad,
    ];
    *coordinates[axis] += step;
    pose
}
