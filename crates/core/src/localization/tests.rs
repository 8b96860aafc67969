//! Tests of the whole localizer, on small pictures and on a device that fails.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use image::{GrayImage, RgbImage};

use super::*;
use crate::{
    backend::{Backend, BackendError, CpuBackend},
    camera::Camera,
    field::FieldDimensions,
    filter::{Filter, FilterConfig, FilterEstimate, PlanarSigma},
    mount::MountPose,
    observation::{ObservationConfig, ObservationKind},
    pose::{CameraPose, Motion2, Pose2},
    preprocess::{Prepared, luma},
    test_scene,
};

fn observation(picture: impl Into<Picture>) -> Observation {
    Observation::new(0.0, picture, MountPose::of(pose()))
}

fn pose() -> CameraPose {
    test_scene::poses()[0]
}

fn picture() -> RgbImage {
    test_scene::render(&test_scene::fisheye(), pose(), &test_scene::field())
}

fn is_right(found: CameraPose) -> bool {
    (found.x_m - pose().x_m).hypot(found.y_m - pose().y_m) < 0.03
}

#[test]
fn a_grey_picture_gives_the_pose_and_never_the_half() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    assert!(field.goal_srgb_positive_x.is_some(), "a field that colours could tell the halves of");
    let grey: GrayImage = luma(&picture());
    let mut localizer = Localizer::builder(&camera, &field).start(pose().planar()).build().unwrap();
    let frame = localizer.update(&observation(&grey)).unwrap();
    assert!(frame.settled && is_right(frame.pose), "{frame:?}");

    localizer.reset(None);
    let frame = localizer.update(&observation(&grey)).unwrap();
    assert!(is_right(frame.pose) || is_right(frame.pose.mirrored()), "{frame:?}");
    assert!(!frame.sure && frame.mirrored_probability == 0.5);
}

/// Covers a part of a picture, as somebody who stands there in dark clothes does.
fn hidden(mut picture: RgbImage, columns: std::ops::Range<u32>) -> RgbImage {
    for u in columns {
        for v in 0..picture.height() {
            picture.put_pixel(u, v, image::Rgb([50, 40, 45]));
        }
    }
    picture
}

/// A part of the lines fits at a wrong place, and the particles stay there for a while.
#[test]
fn a_wrong_place_at_which_some_lines_fit_is_not_sure() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let (mut stayed, mut fitted) = (0, 0);
    for kind in ObservationKind::ALL {
        for pose in test_scene::poses() {
            let picture = test_scene::render(&camera, pose, &field);
            for away in [[1.0, 0.0], [0.0, -1.0], [0.6, 0.6]] {
                let wrong = Pose2::new(pose.x_m + away[0], pose.y_m + away[1], pose.yaw_rad);
                let config = LocalizerConfig::new(kind);
                let builder = Localizer::builder(&camera, &field).config(config).start(wrong);
                let mut localizer = builder.build().unwrap();
                let observation = Observation::new(0.0, picture.clone(), MountPose::of(pose))
                    .with_odometry(Pose2::default());
                for _ in 0..3 {
                    let frame = localizer.update(&observation).unwrap();
                    let off_m = (frame.pose.x_m - pose.x_m).hypot(frame.pose.y_m - pose.y_m);
                    if off_m > 0.4 {
                        stayed += 1;
                        fitted += u32::from(frame.line_fraction > 0.25);
                        assert!(!frame.sure, "{kind}, {off_m} m off: {frame:?}");
                    }
                }
            }
        }
    }
    assert!(
        stayed > 10 && fitted > 0,
        "{stayed} pictures at wrong places, {fitted} of them with lines that fit"
    );
}

/// Without a start, a picture of which much is hidden fits at several places; the next ones decide.
#[test]
fn several_places_are_followed_until_pictures_decide() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let mut ambiguous = 0;
    for pose in test_scene::poses() {
        let whole = test_scene::render(&camera, pose, &field);
        let mut localizer = Localizer::builder(&camera, &field).build().unwrap();
        let see = |picture: RgbImage| {
            Observation::new(0.0, picture, MountPose::of(pose)).with_odometry(Pose2::default())
        };
        let first = localizer.update(&see(hidden(whole.clone(), 0..230))).unwrap();
        ambiguous += u32::from(!first.settled);
        let last = (0..6).map(|_| localizer.update(&see(whole.clone())).unwrap()).last().unwrap();
        let is_right = |found: CameraPose| (found.x_m - pose.x_m).hypot(found.y_m - pose.y_m) < 0.05;
        assert!(is_right(last.pose) || is_right(last.pose.mirrored()), "{last:?} instead of {pose:?}");
        assert!(last.settled, "{last:?}");
    }
    assert!(ambiguous > 0, "some picture of which much is hidden fits at several places");
}

#[test]
fn a_picture_of_another_size_is_refused_and_the_next_one_goes_on() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let mut localizer = Localizer::builder(&camera, &field).start(pose().planar()).build().unwrap();
    let error = localizer.update(&observation(RgbImage::new(4, 3))).unwrap_err();
    assert!(matches!(error, LocalizationError::PictureSize { found: [4, 3], expected: [320, 240] }));
    assert!(localizer.update(&observation(picture())).is_ok());
}

#[test]
fn after_a_reset_everything_is_as_if_it_had_just_been_built() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let observation = observation(picture());
    let three = |localizer: &mut Localizer| -> Vec<LocalizedFrame> {
        let frames = (0..3).map(|_| localizer.update(&observation).unwrap());
        frames.map(|frame| LocalizedFrame { seconds: 0.0, ..frame }).collect()
    };
    let build = |start: Option<Pose2>, seed| {
        let config = LocalizerConfig::default().with_seed(seed);
        Localizer::builder(&camera, &field).config(config).start(start).build().unwrap()
    };
    let mut localizer = build(None, 0);
    let from_nowhere = three(&mut localizer);
    localizer.reset(Some(pose().planar()));
    assert_eq!(three(&mut localizer), three(&mut build(Some(pose().planar()), 0)));
    localizer.reset_with_seed(Some(pose().planar()), 9);
    assert_eq!(three(&mut localizer), three(&mut build(Some(pose().planar()), 9)));
    localizer.reset_with_seed(None, 0);
    assert_eq!(three(&mut localizer), from_nowhere);
}

/// CPU backend whose filter fails after a given number of updates: `left` is how many still succeed.
#[derive(Clone)]
struct Failing {
    left: Arc<AtomicU32>,
}

impl Failing {
    fn after(updates: u32) -> Arc<Self> {
        Arc::new(Self { left: Arc::new(updates.into()) })
    }
}

#[derive(Debug, thiserror::Error)]
#[error("the device is gone")]
struct Gone(#[source] io::Error);

impl Backend for Failing {
    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError> {
        let filter = CpuBackend.filter(camera, field, observation, config)?;
        Ok(Box::new(FailingFilter { filter, left: self.left.clone() }))
    }
}

struct FailingFilter {
    filter: Box<dyn Filter>,
    left: Arc<AtomicU32>,
}

impl Filter for FailingFilter {
    fn load(&mut self, picture: &Prepared) -> Result<(), BackendError> {
        self.filter.load(picture)
    }
    fn reset(&mut self, seed: u64) {
        self.filter.reset(seed);
    }
    fn initialize(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) -> Result<(), BackendError> {
        self.filter.initialize(modes, sigma)
    }
    fn predict(&mut self, motion: Option<Motion2>) -> Result<(), BackendError> {
        self.filter.predict(motion)
    }
    fn update(&mut self, mount: MountPose, sigma: PlanarSigma) -> Result<FilterEstimate, BackendError> {
        let left = self.left.load(Ordering::Relaxed);
        self.left.store(left.wrapping_sub(1), Ordering::Relaxed);
        if left == 0 {
            return Err(BackendError::new(Gone(io::ErrorKind::BrokenPipe.into())));
        }
        self.filter.update(mount, sigma)
    }
    fn mirror(&mut self) -> Result<(), BackendError> {
        self.filter.mirror()
    }
    fn particles(&self) -> Result<Vec<CameraPose>, BackendError> {
        self.filter.particles()
    }
    fn alternatives(&self) -> &[CameraPose] {
        self.filter.alternatives()
    }
}

#[test]
fn a_device_that_fails_at_a_picture_is_an_error_of_that_picture_and_a_reset_begins_again() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let observation = observation(picture());
    let config = LocalizerConfig::default().with_relocalization(false);
    let start = pose().planar();
    let builder = Localizer::builder(&camera, &field).config(config).start(start);
    let mut localizer = builder.backend(Failing::after(3)).build().unwrap();
    for _ in 0..3 {
        assert!(localizer.update(&observation).unwrap().settled);
    }
    let Err(LocalizationError::Backend(error)) = localizer.update(&observation) else {
        panic!("the device has failed");
    };
    assert!(error.get_ref().is::<Gone>(), "the device's own error is kept");

    localizer.reset(Some(start));
    assert!(localizer.update(&observation).unwrap().settled);
}

#[test]
fn a_recording_ends_with_the_error_of_the_frame_at_which_the_device_fails() {
    let walk = crate::sequence::Sequence::open(std::path::Path::new("../../assets/walk")).unwrap();
    let builder = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start);
    let mut localizer = builder.backend(Failing::after(2)).build().unwrap();
    let frames: Vec<_> = localizer.run(&walk).collect();
    assert_eq!(frames.len(), 3);
    assert!(frames[..2].iter().all(Result::is_ok));
    assert!(matches!(frames[2], Err(LocalizationError::Backend(_))));
}

#[test]
fn a_recording_that_is_dropped_before_its_end_stops_decoding() {
    let walk = crate::sequence::Sequence::open(std::path::Path::new("../../assets/walk")).unwrap();
    let mut localizer =
        Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build().unwrap();
    let shared = Arc::new(walk);
    let mut run = Run::new(&mut localizer, shared.clone());
    assert!(run.next().unwrap().is_ok());
    assert!(run.observation().is_some());
    drop(run);
    assert_eq!(Arc::strong_count(&shared), 1, "the thread that decodes has ended");
}
