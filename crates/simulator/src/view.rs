//! What a layer knows of the camera that draws it.

use glam::{DMat3, DQuat, DVec2, DVec3};
use reality_sim_core::{camera::Camera as Lens, pose::CameraPose};
use reality_sim_sensor::{Chain, Twist};

use crate::{canvas::PARTS, light::Light, scene_light::SceneLight};

/// Way of a picture during the exposure below which nothing is blurred by motion, pixels.
const LEAST_WAY_PX: f64 = 0.1;
/// Way up to which a few instants are enough: they are then at most a pixel apart.
const SHORT_WAY_PX: f64 = 4.0;
/// Number of instants of a short way.
const FEW_INSTANTS: usize = 4;
/// Place of each part of a pixel in the order of time: that of Halton's numbers to the base 3, so that parts are spread evenly
/// over columns, rows and time together.
const ORDER_IN_TIME: [usize; PARTS] = [0, 6, 11, 2, 8, 13, 4, 10, 15, 1, 7, 12, 3, 9, 14, 5];
/// Number of steps in which the row, and so the time, of a moving point is found; each leaves a tenth of the error where a
/// picture moves by a tenth of its height while it is read.
const ROW_STEPS: usize = 3;

/// Camera while it takes a picture.
#[derive(Debug)]
pub struct View<'a> {
    pub(crate) chain: &'a Chain,
    /// True pose of the camera in the middle of the exposure.
    pub(crate) pose: CameraPose,
    pub(crate) world_from_camera: DMat3,
    pub(crate) twist: Twist,
    pub(crate) time_s: f64,
    /// Magnification of the colour that is drawn.
    pub(crate) magnification: f64,
    pub(crate) light: SceneLight<'a>,
}

/// Moment of an exposure, with the parts of a pixel that stand for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Time after the middle of a row's exposure, seconds.
    pub offset_s: f64,
    /// Parts of a pixel, a bit each, as in [`crate::Fragment::parts`].
    pub parts: u16,
    position_in_world: DVec3,
    camera_from_world: DMat3,
}

/// Where a point is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenPoint {
    /// Pixel, which may lie outside the picture.
    pub pixel: DVec2,
    /// Distance from the camera, metres.
    pub distance_m: f64,
}

impl View<'_> {
    /// Returns the true pose of the camera in the middle of the exposure.
    pub fn pose(&self) -> CameraPose {
        self.pose
    }

    /// Returns the camera's lens.
    pub fn lens(&self) -> &Lens {
        self.chain.camera()
    }

    /// Returns width and height of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.lens().width, self.lens().height]
    }

    /// Returns the camera with its effects.
    pub fn chain(&self) -> &Chain {
        self.chain
    }

    /// Returns the time of the picture, seconds.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Returns the light at a place on the ground, metres.
    pub fn light_at(&self, point_in_world: DVec2) -> Light {
        self.light.at(point_in_world)
    }

    /// Returns the light of the hall, wherever.
    pub fn light(&self) -> Light {
        self.light.usual()
    }

    /// Projects a point that stands still, in the middle of the exposure. `None` where the lens does not see it; the pixel may
    /// lie outside the picture.
    pub fn project(&self, point_in_world: DVec3) -> Option<SeenPoint> {
        self.seen(self.pose.position_in_world(), self.world_from_camera.transpose(), point_in_world)
    }

    /// Returns the direction in the world that is seen at a pixel, a unit vector; `None` where the lens sees nothing.
    pub fn ray(&self, pixel: DVec2) -> Option<DVec3> {
        let middle = DVec2::new(self.lens().cx, self.lens().cy);
        let pixel = middle + (pixel - middle) / self.magnification;
        self.lens().unproject(pixel).ok().map(|ray| self.world_from_camera * ray)
    }

    /// Returns the moments at which something has to be drawn that moves with this velocity at this distance: one where
    /// nothing moves.
    pub fn instants(&self, velocity_in_world: DVec3, distance_m: f64) -> Vec<Instant> {
        let exposure_s = self.chain.exposure_s();
        let across_m_s = (velocity_in_world - self.twist.velocity_in_world).length();
        let turn_rad_s = self.twist.angular_velocity_in_camera.length();
        let rate_rad_s = turn_rad_s + across_m_s / distance_m.max(f64::MIN_POSITIVE);
        let way_px = rate_rad_s * exposure_s * self.lens().fx.max(self.lens().fy);
        let count = match way_px {
            way_px if way_px <= LEAST_WAY_PX => 1,
            way_px if way_px <= SHORT_WAY_PX => FEW_INSTANTS,
            _ => PARTS,
        };
        let instant = |index: usize| {
            let offset_s = exposure_s * ((index as f64 + 0.5) / count as f64 - 0.5);
            let is_of = |part: &usize| ORDER_IN_TIME[*part] * count / PARTS == index;
            let parts = (0..PARTS).filter(is_of).fold(0, |parts, part| parts | 1 << part);
            self.instant(offset_s, parts)
        };
        (0..count).map(instant).collect()
    }

    fn instant(&self, offset_s: f64, parts: u16) -> Instant {
        let turn = DQuat::from_scaled_axis(offset_s * self.twist.angular_velocity_in_camera);
        Instant {
            offset_s,
            parts,
            position_in_world: self.pose.position_in_world() + offset_s * self.twist.velocity_in_world,
            camera_from_world: (self.world_from_camera * DMat3::from_quat(turn)).transpose(),
        }
    }

    /// Projects a point at an instant; it moves with this velocity, and is given for the middle of the exposure. Rows that are
    /// read later see it later.
    pub fn project_at(&self, instant: &Instant, point: DVec3, velocity: DVec3) -> Option<SeenPoint> {
        let at = |instant: &Instant| {
            let point_in_world = point + instant.offset_s * velocity;
            self.seen(instant.position_in_world, instant.camera_from_world, point_in_world)
        };
        let mut seen = at(instant)?;
        if self.chain.has_row_times() && (velocity != DVec3::ZERO || self.twist != Twist::default()) {
            for _ in 0..ROW_STEPS {
                let later = self.instant(instant.offset_s + self.row_delay_s(seen.pixel), instant.parts);
                seen = at(&later)?;
            }
        }
        Some(seen)
    }

    /// Returns how much later than the middle row a pixel's row is exposed, seconds.
    fn row_delay_s(&self, pixel: DVec2) -> f64 {
        let last = f64::from(self.lens().height.max(2) - 1);
        let row = (pixel.y / last).clamp(-1.0, 2.0);
        let middle_s = |row: f64| self.chain.exposure_middle_s(self.time_s, row);
        middle_s(row) - middle_s(0.5)
    }

    fn seen(&self, position: DVec3, camera_from_world: DMat3, point_in_world: DVec3) -> Option<SeenPoint> {
        let point_in_camera = camera_from_world * (point_in_world - position);
        let pixel = self.chain.project_from_camera(point_in_camera)?;
        let middle = DVec2::new(self.lens().cx, self.lens().cy);
        let pixel = middle + self.magnification * (pixel - middle);
        let distance_m = point_in_camera.length();
        (pixel.is_finite() && distance_m > 0.0).then_some(SeenPoint { pixel, distance_m })
    }
}
