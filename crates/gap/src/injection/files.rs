//! Files that lack an effect which the pictures show.

use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::Sequence,
};
use reality_sim_sensor::{Chain, Trajectory};

/// Recording with changed files, and its reference poses.
pub(super) struct ChangedFiles {
    pub(super) sequence: Sequence,
    pub(super) poses: Vec<Option<CameraPose>>,
}

/// Returns the recording with the camera, the field and the poses of the opposite effect, so that the effect brings them back to
/// what they are; and with the odometry that the effect makes of the recorded one.
pub(super) fn without(
    sequence: &Sequence,
    poses: &[Option<CameraPose>],
    opposite: &Chain,
    hidden: &Chain,
) -> ChangedFiles {
    let mut changed = sequence.clone();
    changed.setup.camera = opposite.camera().clone();
    changed.field = opposite.field().clone();
    let mount = |height_m, pitch_rad, roll_rad| {
        opposite.mounted(CameraPose::new(Pose2::default(), height_m, pitch_rad, roll_rad))
    };
    changed.setup.mount_height_m = mount(sequence.setup.mount_height_m, 0.0, 0.0).height_m;
    for frame in &mut changed.frames {
        let mounted = mount(sequence.setup.mount_height_m, frame.pitch_rad, frame.roll_rad);
        (frame.pitch_rad, frame.roll_rad) = (mounted.pitch_rad, mounted.roll_rad);
    }
    let poses = changed_poses(sequence, poses, opposite);
    changed.frames.iter_mut().zip(&poses).for_each(|(frame, pose)| {
        frame.reference_pose = frame.reference_pose.and(*pose);
    });
    change_odometry(&mut changed, hidden);
    ChangedFiles { sequence: changed, poses }
}

/// Returns the poses by the opposite effect, on its clock.
fn changed_poses(
    sequence: &Sequence,
    poses: &[Option<CameraPose>],
    opposite: &Chain,
) -> Vec<Option<CameraPose>> {
    let stamped = sequence.frames.iter().zip(poses);
    let stamped: Vec<(f64, CameraPose)> =
        stamped.filter_map(|(frame, pose)| Some((frame.timestamp_s, (*pose)?))).collect();
    let trajectory = Trajectory::new(&stamped).ok();
    let at = |time_s: f64, pose: CameraPose| match &trajectory {
        Some(trajectory) if opposite.clock_s() != 0.0 => opposite.pose(trajectory, time_s, 0.5),
        _ => opposite.mounted(pose),
    };
    let frames = sequence.frames.iter().zip(poses);
    frames.map(|(frame, pose)| pose.map(|pose| at(frame.timestamp_s, pose))).collect()
}

/// Changes every step of the odometry to what the effect makes of it.
fn change_odometry(sequence: &mut Sequence, hidden: &Chain) {
    let mut last: Option<(f64, Pose2, Pose2)> = None;
    for frame in &mut sequence.frames {
        let Some(recorded) = frame.odometry else { continue };
        let reported = last.map_or(recorded, |(time_s, from, to)| {
            let motion = from.motion_to(recorded);
            let reported = hidden.odometry(motion, frame.timestamp_s - time_s);
            // Where nothing changes, no rounding changes the numbers of the file.
            if reported == motion && from == to { recorded } else { to.moved(reported) }
        });
        frame.odometry = Some(reported);
        last = Some((frame.timestamp_s, recorded, reported));
    }
}
