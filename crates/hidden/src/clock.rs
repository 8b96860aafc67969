//! Times of a recording: when pictures are taken, and what is written down about it.

use crate::truth::Truth;

/// Every so many pictures, one may be stored twice.
const DOUBLED_EVERY: usize = 5;

/// Clocks of a recording. A take is a picture as it is taken; a frame is a line of the files with its picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    rate_hz: f64,
    frames: usize,
    /// Time by which the pictures are taken later than they would be with nothing hidden, seconds.
    lead_s: f64,
    /// Offset of the robot's clock from that of the reference poses, seconds.
    offset_s: f64,
    /// Jump of the pictures' clock in the middle of the recording, seconds.
    jump_s: f64,
    lost: usize,
    doubled: usize,
}

impl Clock {
    /// Makes the clock of pictures that are taken for these effects: an offset of the clock shifts them.
    pub fn of_pictures(rate_hz: f64, frames: usize, truth: &Truth) -> Self {
        Self { lead_s: truth.offset_s, ..Self::of_files(rate_hz, frames, truth) }
    }

    /// Makes the clock of pictures that are there already: an offset of the clock shifts the reference poses.
    pub fn of_files(rate_hz: f64, frames: usize, truth: &Truth) -> Self {
        let Truth { offset_s, jump_s, lost, doubled, .. } = *truth;
        Self { rate_hz, frames, lead_s: 0.0, offset_s, jump_s, lost, doubled }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Number of takes that the frames need.
    pub fn takes(&self) -> usize {
        self.frames + self.lost
    }

    /// Time between takes, seconds.
    pub fn period_s(&self) -> f64 {
        1.0 / self.rate_hz
    }

    /// Returns the time of a take with nothing hidden, seconds.
    pub fn nominal_s(&self, take: usize) -> f64 {
        (take + 1) as f64 / self.rate_hz
    }

    /// Returns the take whose picture is stored with a frame.
    pub fn take_of(&self, frame: usize) -> usize {
        let repeats = frame % DOUBLED_EVERY == DOUBLED_EVERY - 1 && frame / DOUBLED_EVERY < self.doubled;
        let take = if repeats { frame - 1 } else { frame };
        if take < self.frames / 2 { take } else { take + self.lost }
    }

    /// Returns the time on the trajectory at which a take is exposed, seconds.
    pub fn exposed_s(&self, take: usize) -> f64 {
        self.nominal_s(take) + self.lead_s
    }

    /// Returns the timestamp that is written for a frame, seconds.
    pub fn stamp_s(&self, frame: usize) -> f64 {
        self.nominal_s(frame) + self.jump_s(frame)
    }

    /// Returns the time on the trajectory at which the robot's odometry and IMU would be read without delays of their own,
    /// seconds.
    pub fn logged_s(&self, frame: usize) -> f64 {
        self.stamp_s(frame) + self.lead_s
    }

    /// Returns the time on the trajectory of a reference pose with this timestamp, seconds.
    pub fn reference_s(&self, stamp_s: f64) -> f64 {
        stamp_s - (self.offset_s - self.lead_s)
    }

    fn jump_s(&self, frame: usize) -> f64 {
        if frame < self.frames / 2 { 0.0 } else { self.jump_s }
    }
}
