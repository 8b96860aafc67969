use std::sync::atomic::{AtomicBool, Ordering};

use super::*;
use crate::{
    observation::Scorer,
    test_scene,
    warp::{CpuWarper, Warper},
};

/// The processor until a picture, from which on everything is worth nothing.
struct Failing {
    at_picture: u32,
    has_failed: Arc<AtomicBool>,
}

impl Backend for Failing {
    fn scorer(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        config: ObservationConfig,
    ) -> Result<Box<dyn Scorer>, BackendError> {
        CpuBackend.scorer(camera, field, config)
    }

    fn filter(
        &self,
        camera: &Camera,
        field: &FieldDimensions,
        observation: ObservationConfig,
        config: FilterConfig,
    ) -> Result<Box<dyn Filter>, BackendError> {
        let filter = CpuBackend.filter(camera, field, observation, config)?;
        Ok(Box::new(FailingFilter { filter, left: self.at_picture, has_failed: self.has_failed.clone() }))
    }

    fn warper(&self) -> Result<Arc<dyn Warper>, BackendError> {
        Ok(Arc::new(CpuWarper))
    }

    fn status(&self) -> Result<(), BackendError> {
        if self.has_failed.load(Ordering::Relaxed) {
            return Err(BackendError("the device is on fire".to_owned()));
        }
        Ok(())
    }
}

struct FailingFilter {
    filter: Box<dyn Filter>,
    /// Pictures until it fails.
    left: u32,
    has_failed: Arc<AtomicBool>,
}

impl Filter for FailingFilter {
    fn load(&mut self, picture: &Prepared) {
        self.filter.load(picture);
    }
    fn place(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) {
        self.filter.place(modes, sigma);
    }
    fn predict(&mut self, motion: Option<Motion2>) {
        self.filter.predict(motion);
    }
    fn update(&mut self, attitude: Attitude, sigma: PlanarSigma) -> FilterEstimate {
        self.has_failed.store(self.left == 0, Ordering::Relaxed);
        self.left = self.left.saturating_sub(1);
        self.filter.update(attitude, sigma)
    }
    fn mirror(&mut self) {
        self.filter.mirror();
    }
    fn particles(&self) -> Vec<CameraPose> {
        self.filter.particles()
    }
    fn rivals(&self) -> Vec<CameraPose> {
        self.filter.rivals()
    }
}

#[test]
fn a_device_that_fails_at_a_picture_is_an_error_of_that_picture() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let pose = test_scene::poses()[0];
    let recorded = Recorded {
        picture: Arc::new(test_scene::render(&camera, pose, &field)),
        odometry: None,
        attitude: Attitude::of(pose),
    };
    let backend = Arc::new(Failing { at_picture: 3, has_failed: Arc::default() });
    let mut config = TagConfig::new(ObservationKind::Contrast);
    config.recovery = false;
    let mut tagger = Tagger::with_backend(&camera, &field, Some(pose.planar()), config, backend).unwrap();
    let tagged: Vec<_> = (0..4).map(|_| tagger.tag(&recorded)).collect();
    for frame in &tagged[..3] {
        assert!(frame.as_ref().is_ok_and(|frame| frame.settled), "{frame:?}");
    }
    let error = tagged[3].as_ref().unwrap_err();
    assert_eq!(*error, BackendError("the device is on fire".to_owned()));
}
