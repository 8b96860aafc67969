//! Camera poses while a row is exposed.

use reality_sim_core::pose::CameraPose;

use crate::{Chain, Trajectory};

/// Least number of instants of an exposure; more are used where the picture moves farther.
const INSTANTS: f64 = 8.0;
/// Largest number of instants of an exposure.
const MOST_INSTANTS: f64 = 64.0;

/// Motion of the camera during one frame.
#[derive(Debug)]
pub(crate) struct Motion<'a> {
    chain: &'a Chain,
    trajectory: &'a Trajectory,
    time_s: f64,
    /// Offsets of the instants from the middle of a row's exposure.
    offsets_s: Vec<f64>,
}

impl<'a> Motion<'a> {
    pub(crate) fn new(chain: &'a Chain, trajectory: &'a Trajectory, time_s: f64) -> Self {
        let count = instant_count(chain, trajectory, time_s);
        let share = |instant: u32| (f64::from(instant) + 0.5) / f64::from(count) - 0.5;
        let offsets_s = (0..count).map(|instant| chain.exposure_s() * share(instant)).collect();
        Self { chain, trajectory, time_s, offsets_s }
    }

    /// Whether all rows are exposed from the same poses.
    pub(crate) fn is_same_for_rows(&self) -> bool {
        self.trajectory.is_still() || !self.chain.has_row_times()
    }

    /// Iterates over true poses, evenly spaced over a row's exposure; rows run from 0 at the top to 1 at the bottom.
    pub(crate) fn poses(&self, row: f64) -> impl Iterator<Item = CameraPose> {
        let middle_s = self.chain.exposure_middle_s(self.time_s, row);
        self.offsets_s.iter().map(move |offset_s| self.chain.camera_at(self.trajectory, middle_s + offset_s))
    }
}

/// Returns one instant for each pixel that the picture moves: with fewer, blurred edges would show steps.
fn instant_count(chain: &Chain, trajectory: &Trajectory, time_s: f64) -> u32 {
    if trajectory.is_still() || chain.exposure_s() == 0.0 {
        return 1;
    }
    let middle_s = chain.exposure_middle_s(time_s, 0.5);
    let twist = trajectory.velocity(middle_s);
    // The nearest visible point is the ground directly under the camera.
    let nearest_m = trajectory.at(middle_s).height_m.max(f64::MIN_POSITIVE);
    let rate_rad_per_s =
        twist.angular_velocity_in_camera.length() + twist.velocity_in_world.length() / nearest_m;
    let way_px = rate_rad_per_s * chain.exposure_s() * chain.camera().fx.max(chain.camera().fy);
    INSTANTS.max(way_px.ceil()).min(MOST_INSTANTS) as u32
}
