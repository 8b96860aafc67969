//! Light of a picture: every ray is followed into the hall, row by row and moment by moment.

use glam::{Mat3, Vec3};

use crate::{
    blur::{self, PointSpread},
    rays::{CONE_PX, Frame, PER_PIXEL, Rays},
    scene::{Moment, Ray, Scene},
    solid::Thing,
    trajectory::Trajectory,
    truth::Truth,
};

/// Time between the moments averaged for a moving picture, seconds; their number stays within the limits below.
const MOMENT_S: f64 = 0.003;
const FEWEST_MOMENTS: f64 = 8.0;
const MOST_MOMENTS: f64 = 24.0;

/// Camera that is ready to take pictures.
pub struct Exposer {
    truth: Truth,
    frame: Frame,
    psf: PointSpread,
    rays: Vec<Rays>,
    /// Whether one ray stands for a pixel in which there is nothing but plain carpet.
    has_plain_pixels: bool,
}

/// True camera pose in the precision of the rays.
struct WorldFromCamera {
    origin: Vec3,
    rotation: Mat3,
}

impl Exposer {
    /// Prepares pictures of this size, pixels.
    pub fn new(truth: &Truth, size: [u32; 2], psf: PointSpread) -> Self {
        let margin = blur::margin_px(psf.sigma_px, truth.defocus_px);
        let frame = Frame { size: size.map(|side| side as usize), margin };
        let rays = crate::rays::cast(truth, frame);
        Self { rays, truth: truth.clone(), frame, psf, has_plain_pixels: false }
    }

    /// Takes one ray for a pixel in which there is nothing but plain carpet: several times as fast.
    pub fn with_plain_pixels(self) -> Self {
        Self { has_plain_pixels: true, ..self }
    }

    /// Returns linear red, green and blue of every pixel, row by row, of a picture taken at a time of the robot's clock,
    /// seconds.
    pub fn expose(&self, scene: &Scene, trajectory: &Trajectory, time_s: f64) -> [Vec<f32>; 3] {
        let things = scene.moment(time_s);
        let mut planes = [const { Vec::new() }; 3];
        for rays in &self.rays {
            let light = self.follow(rays, scene, &things, trajectory, time_s);
            for (channel, light) in rays.channels.iter().zip(light) {
                planes[*channel] = self.blurred(&light);
            }
        }
        planes
    }

    fn blurred(&self, light: &[f32]) -> Vec<f32> {
        if self.truth.defocus_px > 0.0 {
            let light = blur::defocus(light, self.frame, self.truth.defocus_px);
            return self.psf.reduce(&light, self.frame);
        }
        self.psf.reduce(light, self.frame)
    }

    /// Returns the light of each of the set's channels along each of its rays.
    fn follow(
        &self,
        rays: &Rays,
        scene: &Scene,
        things: &Moment,
        trajectory: &Trajectory,
        time_s: f64,
    ) -> Vec<Vec<f32>> {
        let mut light = vec![vec![0.0; rays.directions.len()]; rays.channels.len()];
        let moments = self.moments();
        for row in 0..self.frame.rows() {
            for moment in &moments {
                let pose = self.true_pose(trajectory, time_s + self.row_delay_s(row) + moment);
                for cone in 0..self.frame.cones_per_row() {
                    self.follow_cone(rays, scene, things, &pose, [row, cone], &mut |ray, rgb| {
                        for (plane, channel) in light.iter_mut().zip(&rays.channels) {
                            plane[ray] += rgb[*channel] / moments.len() as f32;
                        }
                    });
                }
            }
        }
        light
    }

    /// Passes the light of every ray of one cone to `put`, with the ray's index.
    fn follow_cone(
        &self,
        rays: &Rays,
        scene: &Scene,
        things: &Moment,
        pose: &WorldFromCamera,
        [row, cone]: [usize; 2],
        put: &mut impl FnMut(usize, Vec3),
    ) {
        let width = self.frame.rays_per_row();
        let around = rays.cones[row * self.frame.cones_per_row() + cone];
        let axis = pose.rotation * around.axis;
        let near: Vec<&Thing> = things
            .things
            .iter()
            .filter(|thing| is_in_cone(thing, pose.origin, axis, around.half_angle_rad))
            .collect();
        let ray = |index: usize, reach: usize| Ray {
            origin: pose.origin,
            direction: pose.rotation * rays.directions[index],
            steps_in_camera: [1, width].map(|step| step_between(&rays.directions, index, step * reach)),
            world_from_camera: &pose.rotation,
        };
        for pixel in cone * CONE_PX..((cone + 1) * CONE_PX).min(self.frame.columns()) {
            let indices = |line: usize| {
                let first = (row * PER_PIXEL + line) * width + pixel * PER_PIXEL;
                first..first + PER_PIXEL
            };
            let middle = indices(PER_PIXEL / 2).start + PER_PIXEL / 2;
            let plain = (self.has_plain_pixels && near.is_empty() && rays.directions[middle] != Vec3::ZERO)
                .then(|| scene.plain_light(&ray(middle, PER_PIXEL), &things.shadows))
                .flatten();
            for index in (0..PER_PIXEL).flat_map(indices) {
                if rays.directions[index] == Vec3::ZERO {
                    continue;
                }
                let light = plain
                    .unwrap_or_else(|| scene.light(&ray(index, 1), near.iter().copied(), &things.shadows));
                put(index, light);
            }
        }
    }

    /// Returns the true camera pose at a time on the believed trajectory, seconds.
    fn true_pose(&self, trajectory: &Trajectory, time_s: f64) -> WorldFromCamera {
        let rig = self.truth.rig(trajectory.gait_phase_rad(time_s));
        let truly = rig.true_of(trajectory.station(time_s));
        WorldFromCamera { origin: truly.position.as_vec3(), rotation: truly.world_from_camera.as_mat3() }
    }

    /// Returns when a row of pixels, margins included, is exposed, relative to the picture's time, seconds.
    fn row_delay_s(&self, row: usize) -> f64 {
        let row = row as f64 - self.frame.margin as f64;
        let last = (self.frame.size[1] as f64 - 1.0).max(1.0);
        self.truth.readout_s * (row / last - 0.5)
    }

    /// Returns the times at which light is collected, relative to a row's time, seconds.
    fn moments(&self) -> Vec<f64> {
        let exposure_s = self.truth.exposure_s;
        if exposure_s == 0.0 {
            return vec![0.0];
        }
        let count = (exposure_s / MOMENT_S).ceil().clamp(FEWEST_MOMENTS, MOST_MOMENTS);
        (0..count as u32).map(|index| exposure_s * ((f64::from(index) + 0.5) / count - 0.5)).collect()
    }
}

/// Returns the difference from a ray to the one that many places further on, or from the one before.
fn step_between(directions: &[Vec3], index: usize, places: usize) -> Vec3 {
    match directions.get(index + places) {
        Some(next) if *next != Vec3::ZERO => *next - directions[index],
        _ => directions[index] - directions[index.saturating_sub(places)],
    }
}

/// Whether a ray of a cone can meet a thing.
fn is_in_cone(thing: &Thing, origin: Vec3, axis: Vec3, half_angle_rad: f32) -> bool {
    let to_center = thing.center - origin;
    let distance = to_center.length();
    if distance <= thing.radius {
        return true;
    }
    let half_angle_rad = half_angle_rad + (thing.radius / distance).asin() + 1e-3;
    half_angle_rad > 3.0 || to_center.dot(axis) >= distance * half_angle_rad.cos()
}
