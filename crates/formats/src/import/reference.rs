//! Reference poses of the camera, from those that a log holds.

use reality_sim_core::{sequence::StampedPose, statistics};

use super::{
    axes::Axes,
    gather::Gathered,
    mount::CameraMount,
    series::{Sample, Series},
    shot::Shot,
};
use crate::message::{Rigid, seconds};

/// Frames of robots whose poses are told, the likeliest first.
const BASE_FRAMES: [&str; 2] = ["base_footprint", "base_link"];

/// Reference poses of the camera.
#[derive(Debug, Default)]
pub struct Reference {
    /// Poses of the camera in its own axes.
    poses: Series<Rigid>,
    /// What the poses were, in a few words.
    pub words: Option<String>,
}

impl Reference {
    /// Turns the reference poses of a log into those of the camera. `height_m` is the camera's height, where tf tells it.
    pub fn of_topic(gathered: &Gathered, mount: &CameraMount<'_>, height_m: Option<f64>) -> Self {
        let samples = gathered.reference.samples();
        let Some(axes) = Axes::by_data(samples.iter().map(|sample| sample.value.rotation)) else {
            return Self::default();
        };
        let base = base_of(gathered, mount, axes, height_m);
        let camera = |sample: &Sample<Rigid>| {
            let value = match &base {
                Some(base) => sample.value.then(mount.frame_transform(base, sample.time_ns)?),
                None => sample.value.then(Rigid::new(axes.rotation_from_optical(), glam::DVec3::ZERO)),
            };
            Some(Sample { value, ..*sample })
        };
        let words = match &base {
            Some(base) => format!("of {base}, moved to the camera by tf"),
            None => format!("of the camera, in {} axes", axes.name()),
        };
        Self::new(samples.iter().filter_map(camera), Some(words))
    }

    /// Takes the pose that tf gives a frame, at the times of pictures.
    pub fn of_frame(gathered: &Gathered, mount: &CameraMount<'_>, frame: &str, shots: &[Shot]) -> Self {
        let root = gathered.frames.chain(frame).last().copied().unwrap_or(frame).to_owned();
        let pose = |shot: &Shot| {
            let root_from_frame = gathered.frames.transform(&root, frame, shot.time_ns, 0)?;
            let value = if frame == mount.camera {
                mount.frame_transform(&root, shot.time_ns)?
            } else {
                root_from_frame
                    .then(Rigid::new(Axes::by_name(frame).rotation_from_optical(), glam::DVec3::ZERO))
            };
            Some(Sample { time_ns: shot.time_ns, log_time_ns: shot.log_time_ns, value })
        };
        Self::new(shots.iter().filter_map(pose), Some(format!("of {frame} in {root}, by tf")))
    }

    fn new(samples: impl Iterator<Item = Sample<Rigid>>, words: Option<String>) -> Self {
        let mut poses = Series::default();
        samples.for_each(|sample| poses.push(sample));
        poses.finish(&super::clock::Clock::default());
        Self { poses, words }
    }

    /// Returns the camera's pose at a time.
    pub fn at(&self, time_ns: i64, tolerance_ns: i64) -> Option<Rigid> {
        self.poses.at(time_ns, tolerance_ns)
    }

    /// Returns the poses that are at none of these times, which are in order.
    pub fn between(&self, times_ns: &[i64]) -> Vec<StampedPose> {
        let is_at_frame = |time_ns: i64| {
            // What is so near is matched by the reader of a sequence.
            let after = times_ns.partition_point(|time| *time < time_ns);
            let near = times_ns[after.saturating_sub(1)..times_ns.len().min(after + 1)].iter();
            near.into_iter().any(|time| (time - time_ns).abs() <= 600_000)
        };
        let samples = self.poses.samples().iter().filter(|sample| !is_at_frame(sample.time_ns));
        let stamped = samples.map(|sample| StampedPose {
            timestamp_s: seconds(sample.time_ns),
            pose: Axes::Optical.camera_pose(sample.value),
        });
        stamped.collect()
    }

    /// Returns the median height of the camera, metres.
    pub fn height_m(&self) -> Option<f64> {
        median(self.poses.samples().iter().map(|sample| sample.value.translation.z))
    }
}

/// Returns the middle one of some values.
pub fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    (!values.is_empty()).then(|| statistics::median(values))
}

/// Returns the frame whose poses the reference tells, if it is not the camera's.
fn base_of(
    gathered: &Gathered,
    mount: &CameraMount<'_>,
    axes: Axes,
    height_m: Option<f64>,
) -> Option<String> {
    let child = gathered.reference_child.as_str();
    if child == mount.camera || axes == Axes::Optical {
        return None;
    }
    if !child.is_empty() {
        return gathered.frames.connects(child, &mount.camera).then(|| child.to_owned());
    }
    // The message does not say whose pose it is: the camera's is as high as the camera.
    let height_m = height_m?;
    let pose_m = median(gathered.reference.samples().iter().map(|sample| sample.value.translation.z))?;
    if (pose_m - height_m).abs() <= 0.5 * height_m {
        return None;
    }
    let chain = gathered.frames.chain(&mount.camera);
    let named = BASE_FRAMES.iter().find_map(|name| chain.iter().find(|frame| frame.ends_with(name)));
    named.map(|frame| (*frame).to_owned()).or_else(|| mount.level.clone())
}
