//! Projection of points into one picture whose rows may be exposed one after another.

use glam::{DMat3, DVec2, DVec3};
use reality_sim_core::pose::CameraPose;

use crate::{Chain, Trajectory};

/// Margin outside the picture, in pixels, within which [`Frame::project`] still returns points.
const MARGIN_PX: f64 = 40.0;

/// Largest slope of a point's row over the row assumed for its exposure. At a slope of 1, points move as fast as rows are
/// read, and no row can be found.
const LARGEST_ROW_SLOPE: f64 = 0.9;

/// Exposure of one picture of a [`Chain`] along a trajectory. Make it once for all points of a picture.
#[derive(Debug, Clone)]
pub struct Frame<'a> {
    chain: &'a Chain,
    trajectory: &'a Trajectory,
    time_s: f64,
    has_row_times: bool,
    /// Camera pose in the middle row's exposure.
    middle: CameraFromWorld,
}

#[derive(Debug, Clone, Copy)]
struct CameraFromWorld {
    position_in_world: DVec3,
    rotation: DMat3,
}

impl CameraFromWorld {
    fn new(pose: CameraPose) -> Self {
        let rotation = pose.rotation_world_from_camera().transpose();
        Self { position_in_world: pose.position_in_world(), rotation }
    }
}

impl Chain {
    /// Prepares the picture with this timestamp for projecting many points.
    pub fn frame<'a>(&'a self, trajectory: &'a Trajectory, time_s: f64) -> Frame<'a> {
        Frame::new(self, trajectory, time_s)
    }

    /// Projects one point, as [`Frame::project`]: from the world, in metres, to its pixel in red (0), green (1) or blue (2)
    /// of the frame with this timestamp.
    pub fn project(
        &self,
        trajectory: &Trajectory,
        time_s: f64,
        point_in_world: DVec3,
        channel: usize,
    ) -> Option<DVec2> {
        self.frame(trajectory, time_s).project(point_in_world, channel)
    }
}

impl<'a> Frame<'a> {
    fn new(chain: &'a Chain, trajectory: &'a Trajectory, time_s: f64) -> Self {
        let middle = CameraFromWorld::new(chain.pose(trajectory, time_s, 0.5));
        let has_row_times = chain.has_row_times() && !trajectory.is_still();
        Self { chain, trajectory, time_s, has_row_times, middle }
    }

    /// Projects a point in the world, in metres, to its pixel in red (0), green (1) or blue (2), in the middle of its row's
    /// exposure. The pixel may lie up to 40 pixels outside the picture, and outside the image circle. Returns `None` farther
    /// out, beyond the camera's valid angle and for any other channel.
    pub fn project(&self, point_in_world: DVec3, channel: usize) -> Option<DVec2> {
        let magnification = *self.chain.magnification().get(channel)?;
        let seen = |camera: CameraFromWorld| self.seen(camera, point_in_world, magnification);
        let first = seen(self.middle)?;
        let pixel = if self.has_row_times { self.settled(first, seen)? } else { first };
        self.is_near_picture(pixel).then_some(pixel)
    }

    /// Solves for the row in which a point appears: its projection depends on when its row is exposed, and its row on the
    /// projection. The projected row is nearly linear in the assumed one, so that two guesses give the third (Steffensen's
    /// method).
    fn settled(&self, first: DVec2, seen: impl Fn(CameraFromWorld) -> Option<DVec2>) -> Option<DVec2> {
        let at_row =
            |row: f64| seen(CameraFromWorld::new(self.chain.pose(self.trajectory, self.time_s, row)));
        let (middle, first_row) = (0.5, self.row(first));
        if first_row == middle {
            return Some(first);
        }
        let second_row = self.row(at_row(first_row)?);
        let slope = (second_row - first_row) / (first_row - middle);
        let slope = slope.clamp(-LARGEST_ROW_SLOPE, LARGEST_ROW_SLOPE);
        at_row((second_row - slope * first_row) / (1.0 - slope))
    }

    fn seen(&self, camera: CameraFromWorld, point_in_world: DVec3, magnification: f64) -> Option<DVec2> {
        let lens = self.chain.camera();
        let point_in_camera = camera.rotation * (point_in_world - camera.position_in_world);
        let pixel = self.chain.project_from_camera(point_in_camera)?;
        Some(pixel + (magnification - 1.0) * (pixel - DVec2::new(lens.cx, lens.cy)))
    }

    /// Returns the row from 0 at the top to 1 at the bottom, clamped for points far outside the picture.
    fn row(&self, pixel: DVec2) -> f64 {
        (pixel.y / f64::from(self.chain.camera().height.max(2) - 1)).clamp(-1.0, 2.0)
    }

    fn is_near_picture(&self, pixel: DVec2) -> bool {
        let camera = self.chain.camera();
        let last = DVec2::new(f64::from(camera.width), f64::from(camera.height)) - 1.0;
        pixel.cmpge(DVec2::splat(-MARGIN_PX)).all() && pixel.cmple(last + MARGIN_PX).all()
    }
}
