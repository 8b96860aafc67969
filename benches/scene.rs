//! Input of all benchmarks: the first pictures of the demonstration walk, and particles around its true poses.

use std::{path::Path, sync::Arc};

use image::RgbImage;
use reality_sim::{
    CameraPose, Pose2, Sequence,
    filter::{Purpose, Stream},
    localization::{Observation, mount_of_frame},
    mount::MountPose,
    preprocess::{Prepared, Preprocessor},
};

/// Number of pictures used.
const PICTURES: usize = 12;
/// Picture on which single stages are measured: field border, goal and robots are in view.
const MIDDLE: usize = 6;
/// Standard deviations of the particles around the true pose: place (metres) and heading (radians).
const SPREAD: [f64; 2] = [0.03, 0.03];

/// Decoded pictures with their poses.
pub struct Scene {
    /// First frames of the walk.
    pub walk: Sequence,
    pictures: Vec<Arc<RgbImage>>,
    prepared: Prepared,
}

impl Scene {
    /// Reads the demonstration walk.
    pub fn load() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/walk");
        let mut walk = Sequence::open(&folder).expect("the demonstration walk is part of the repository");
        walk.frames.truncate(PICTURES);
        let picture = |index| Arc::new(walk.load_image(index).expect("a picture of the demonstration walk"));
        let pictures: Vec<Arc<RgbImage>> = (0..PICTURES).map(picture).collect();
        let mount = mount_of_frame(&walk, MIDDLE);
        let preprocessor = Preprocessor::new(&walk.setup.camera, walk.field.line_width_m);
        let prepared = preprocessor.prepare(pictures[MIDDLE].clone(), mount);
        Self { walk, pictures, prepared }
    }

    /// Returns all pictures as the localizer takes them.
    pub fn observations(&self) -> impl Iterator<Item = Observation> {
        let pictures = self.pictures.iter().enumerate();
        pictures.map(|(index, picture)| Observation::of_frame(&self.walk, index, picture))
    }

    /// Returns this many pictures around the middle one, which is left out, with their poses.
    #[cfg(feature = "gpu")]
    pub fn neighbours(&self, count: usize) -> impl Iterator<Item = (CameraPose, &RgbImage)> {
        let first = MIDDLE - count / 2;
        let frames = (first..).filter(|&frame| frame != MIDDLE).take(count);
        frames.map(|frame| (self.true_pose(frame), &*self.pictures[frame]))
    }

    /// Returns the pose at which a picture was taken.
    fn true_pose(&self, frame: usize) -> CameraPose {
        self.walk.frames[frame].reference_pose.expect("the demonstration walk has ground truth")
    }

    /// Returns the picture on which single stages are measured.
    pub fn picture(&self) -> &Arc<RgbImage> {
        &self.pictures[MIDDLE]
    }

    /// Returns this picture, preprocessed.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Returns its mount pose from joints and IMU.
    pub fn mount(&self) -> MountPose {
        mount_of_frame(&self.walk, MIDDLE)
    }

    /// Returns the pose at which it was taken.
    pub fn pose(&self) -> Pose2 {
        self.true_pose(MIDDLE).planar()
    }

    /// Returns particles around that pose.
    pub fn particles(&self, count: usize) -> Vec<CameraPose> {
        let stream = Stream::new(0, Purpose::Initialise, 0, 0);
        let pose = self.pose();
        let particle = |index| {
            let n = stream.normals(index);
            let [place, heading] = SPREAD;
            let planar =
                Pose2::new(pose.x_m + place * n[0], pose.y_m + place * n[1], pose.yaw_rad + heading * n[2]);
            self.mount().at(planar)
        };
        (0..count as u32).map(particle).collect()
    }
}
