//! Camera of a model during one frame: pixels of points on the ground, and their velocities in the picture.

use glam::DVec2;
use reality_sim_core::{field::Curve, pose::CameraPose};
use reality_sim_sensor::{Chain, Frame, Trajectory};

use crate::measurement::{curve_index::CurveIndex, quantity::ColorChannel};

/// Half the interval of the central difference that gives a pixel's velocity, seconds.
const VELOCITY_STEP_S: f64 = 2e-3;

/// Camera of a model during one frame.
#[derive(Debug)]
pub(crate) struct FrameCamera<'a> {
    pub(crate) chain: &'a Chain,
    pub(crate) trajectory: &'a Trajectory,
    pub(crate) time_s: f64,
    /// Curves of the field's lines, in the world.
    pub(crate) curves: Vec<Curve>,
    /// Pose while the middle row is exposed.
    pub(crate) pose: CameraPose,
    frame: Frame<'a>,
}

impl<'a> FrameCamera<'a> {
    pub(crate) fn new(chain: &'a Chain, trajectory: &'a Trajectory, time_s: f64) -> Self {
        Self {
            chain,
            trajectory,
            time_s,
            curves: chain.field().curves(),
            pose: chain.pose(trajectory, time_s, 0.5),
            frame: chain.frame(trajectory, time_s),
        }
    }

    /// Returns the pixel at which a colour channel shows a point on the ground. None outside the picture.
    pub(crate) fn project(&self, ground: DVec2, channel: ColorChannel) -> Option<DVec2> {
        self.frame.project(ground.extend(0.0), channel as usize)
    }

    /// Returns a curve of the model's field, in the world. None if the field has fewer curves.
    pub(crate) fn curve(&self, curve: CurveIndex) -> Option<&Curve> {
        self.curves.get(curve.0)
    }
}

/// Velocities of points on the ground in the picture, by central differences in time.
pub(crate) struct PixelVelocity<'a> {
    /// Cameras shortly before and after the frame. None if the trajectory is still.
    around: Option<[FrameCamera<'a>; 2]>,
}

impl<'a> PixelVelocity<'a> {
    pub(crate) fn new(camera: &FrameCamera<'a>) -> Self {
        let at = |time_s: f64| FrameCamera::new(camera.chain, camera.trajectory, time_s);
        let around = (!camera.trajectory.is_still())
            .then(|| [at(camera.time_s - VELOCITY_STEP_S), at(camera.time_s + VELOCITY_STEP_S)]);
        Self { around }
    }

    /// Returns the component of a point's velocity along a direction in the picture, pixels per second.
    pub(crate) fn along_px_s(&self, ground: DVec2, direction: DVec2) -> f64 {
        let Some([before, after]) = &self.around else { return 0.0 };
        match (before.project(ground, ColorChannel::Green), after.project(ground, ColorChannel::Green)) {
            (Some(before), Some(after)) => direction.dot(after - before) / (2.0 * VELOCITY_STEP_S),
            _ => 0.0,
        }
    }
}
