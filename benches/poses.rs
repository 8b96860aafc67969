//! Poses of images that were never taken, for indices of any size.

use std::f64::consts::PI;

use reality_sim::db::metric::PixelMetric;
use reality_sim::{
    CameraPose, Pose2, Sequence,
    filter::{Purpose, Stream},
};

/// Half the extent of the carpet on which the poses lie, metres.
const HALF_CARPET_M: [f64; 2] = [3.7, 2.7];
/// Usual height (metres), pitch and roll (radians) of the camera on a walking robot.
const USUAL: [f64; 3] = [0.52, 0.42, 0.0];
/// Largest deviations from these, metres and radians.
const SPREAD: [f64; 3] = [0.02, 0.04, 0.03];

/// Returns random poses anywhere on the carpet with any heading.
pub fn random_poses(count: usize, seed: u64) -> Vec<CameraPose> {
    let streams: [Stream; 6] =
        std::array::from_fn(|axis| Stream::new(seed, Purpose::Initialise, axis as u32, 0));
    let pose = |index| {
        let [x, y, yaw, height, pitch, roll] = streams.map(|stream| 2.0 * stream.uniform(index) - 1.0);
        let planar = Pose2::new(HALF_CARPET_M[0] * x, HALF_CARPET_M[1] * y, PI * yaw);
        let [height_m, pitch_rad, roll_rad] =
            [(0, height), (1, pitch), (2, roll)].map(|(axis, share)| USUAL[axis] + SPREAD[axis] * share);
        CameraPose::new(planar, height_m, pitch_rad, roll_rad)
    };
    (0..count as u32).map(pose).collect()
}

/// Returns the metric of such poses for a recording's camera.
pub fn metric(walk: &Sequence) -> PixelMetric {
    let [height_m, pitch_rad, roll_rad] = USUAL;
    let usual = CameraPose::new(Pose2::default(), height_m, pitch_rad, roll_rad);
    PixelMetric::new(&walk.setup.camera, usual, &walk.field).expect("a camera that sees the field")
}
