//! Where points are seen in one picture, row by row as it is exposed.

use glam::{DMat3, DVec2, DVec3};
use reality_sim_core::pose::CameraPose;

use crate::{Chain, Trajectory};

/// [`Frame::project`] follows points so far out of the picture, pixels.
const MARGIN_PX: f64 = 40.0;

/// Of a picture in which a row passes by as fast as rows are read, or faster, no row could be told for a point.
const LARGEST_ROW_SLOPE: f64 = 0.9;

/// One picture of a [`Chain`] on its way. Make it once for all points of a picture.
#[derive(Debug, Clone)]
pub struct Frame<'a> {
    chain: &'a Chain,
    trajectory: &'a Trajectory,
    time_s: f64,
    has_row_times: bool,
    /// The camera in the middle row's exposure.
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
    /// The picture with this time stamp, for many points.
    pub fn frame<'a>(&'a self, trajectory: &'a Trajectory, time_s: f64) -> Frame<'a> {
        Frame::new(self, trajectory, time_s)
    }

    /// Where a point of the world, metres, is seen in red (0), green (1) or blue (2) of the frame with this time stamp:
    /// [`Frame::project`] for one point.
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

    /// Where a point of the world, metres, is seen in red (0), green (1) or blue (2), in the middle of its row's exposure.
    /// The pixel may lie up to 40 pixels outside the picture, and outside the image circle; `None` farther out, beyond
    /// the camera's valid angle and for a channel that there is not.
    pub fn project(&self, point_in_world: DVec3, channel: usize) -> Option<DVec2> {
        let magnification = *self.chain.magnification().get(channel)?;
        let seen = |camera: CameraFromWorld| self.seen(camera, point_in_world, magnification);
        let first = seen(self.middle)?;
        let pixel = if self.has_row_times { self.settled(first, seen)? } else { first };
        self.is_near_picture(pixel).then_some(pixel)
    }

    /// Where a point is seen depends on when its row is exposed, and that on where it is seen. The row in which it is seen
    /// is all but linear in the row that is assumed: two guesses give the third (Steffensen's method).
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
        let pixel = lens.project_unbounded(point_in_camera).ok()?;
        Some(pixel + (magnification - 1.0) * (pixel - DVec2::new(lens.cx, lens.cy)))
    }

    /// From 0, the top one, to 1; a point far outside the picture is taken as not so far.
    fn row(&self, pixel: DVec2) -> f64 {
        (pixel.y / f64::from(self.chain.camera().height.max(2) - 1)).clamp(-1.0, 2.0)
    }

    fn is_near_picture(&self, pixel: DVec2) -> bool {
        let camera = self.chain.camera();
        let last = DVec2::new(f64::from(camera.width), f64::from(camera.height)) - 1.0;
        pixel.cmpge(DVec2::splat(-MARGIN_PX)).all() && pixel.cmple(last + MARGIN_PX).all()
    }
}
