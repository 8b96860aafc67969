//! Cameras for many threads.

use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;
use reality_sim_core::pose::CameraPose;
use reality_sim_sensor::Twist;

use crate::{camera::Camera, error::LookError, frame::Frame, layer::Layer};

/// Cameras alike, of which every thread takes one for the time of a picture. There are as many as ever looked at once; they
/// share the archive, its decoded pictures and the thread that decodes ahead.
#[derive(Debug)]
pub struct CameraPool {
    prototype: Camera,
    /// Cameras that nobody uses now, the one used last at the end.
    idle: Mutex<Vec<Camera>>,
}

/// Picture that is wanted of a pool.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// Pose of the camera.
    pub pose: CameraPose,
    /// What is drawn over the recorded scene.
    pub layers: &'a [&'a dyn Layer],
    /// Time of the picture, seconds, see [`Camera::set_time_s`].
    pub time_s: f64,
    /// Velocity of the camera, see [`Camera::set_twist`].
    pub twist: Twist,
}

impl<'a> Request<'a> {
    /// Asks for the picture of a camera at rest, at time 0.
    pub fn new(pose: CameraPose, layers: &'a [&'a dyn Layer]) -> Self {
        Self { pose, layers, time_s: 0.0, twist: Twist::default() }
    }
}

impl CameraPool {
    /// Makes a pool of cameras like this one.
    pub fn new(prototype: Camera) -> Self {
        Self { prototype, idle: Mutex::default() }
    }

    /// Returns the camera that all others are like.
    pub fn prototype(&self) -> &Camera {
        &self.prototype
    }

    /// Draws what a camera sees, see [`Camera::look`]. Threads may call this at the same time. A picture does not depend on those
    /// before it; for one after the other along a path, a [`Camera`] of one's own is faster.
    pub fn look(&self, request: &Request, frame: &mut Frame) -> Result<(), LookError> {
        let mut camera = self.lock().pop().unwrap_or_else(|| self.prototype.clone());
        camera.forget_path();
        camera.set_time_s(request.time_s);
        camera.set_twist(request.twist);
        let seen = camera.look(request.pose, request.layers, frame);
        self.lock().push(camera);
        seen
    }

    /// Draws many pictures at once, each into the frame at its place; results are in the same order. Requests without a frame
    /// are left out.
    pub fn look_each(&self, requests: &[Request], frames: &mut [Frame]) -> Vec<Result<(), LookError>> {
        let pairs = requests.par_iter().zip(frames);
        pairs.map(|(request, frame)| self.look(request, frame)).collect()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Camera>> {
        // Nothing panics while the lock is held.
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
