//! Mistakes that people make in the files beside the pictures.

use glam::DVec3;
use reality_sim_core::{pose::CameraPose, sequence::FrameRecord};

use crate::{effect::Mistake, log::pose_of, rig::Station, rotation};

/// Makes a mistake in the lines of `frames.csv` or in the reference poses. Those in other places are left to others.
pub fn make(mistake: Mistake, frames: &mut [FrameRecord]) {
    for frame in frames {
        match mistake {
            Mistake::DegreesForRadians => {
                frame.pitch_rad = frame.pitch_rad.to_degrees();
                frame.roll_rad = frame.roll_rad.to_degrees();
            }
            Mistake::SwappedAxes => change(frame, |pose| (pose.x_m, pose.y_m) = (pose.y_m, pose.x_m)),
            Mistake::NegatedAxis => change(frame, |pose| pose.y_m = -pose.y_m),
            Mistake::MillimetresForMetres => change(frame, |pose| {
                pose.x_m *= 1000.0;
                pose.y_m *= 1000.0;
                pose.height_m *= 1000.0;
            }),
            Mistake::InvertedPoses => change(frame, |pose| *pose = inverted(pose)),
            Mistake::MirroredPictures | Mistake::AnotherLeaguesField => {}
        }
    }
}

fn change(frame: &mut FrameRecord, mut make: impl FnMut(&mut CameraPose)) {
    if let Some(pose) = &mut frame.reference_pose {
        make(pose);
    }
}

/// Returns the world's pose in the camera frame.
fn inverted(pose: &CameraPose) -> CameraPose {
    let turn = rotation::from_angles(pose.yaw_rad, pose.pitch_rad, pose.roll_rad).transpose();
    let position = DVec3::new(pose.x_m, pose.y_m, pose.height_m);
    pose_of(Station { position: -(turn * position), world_from_camera: turn })
}
