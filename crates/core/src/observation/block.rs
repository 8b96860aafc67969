//! Line samples as other devices take them.

use super::interpolation::{Limits, NODES};

/// Two points of a line sample on the ground, metres: its centre, and its left flank, or for models without flanks its centre again. The right
/// flank is the left one's mirror image about the centre.
pub type SamplePoints = [[f32; 2]; 2];

/// Up to sixteen samples, neighbours of each other on one line.
#[derive(Debug, Clone, PartialEq)]
pub struct LineBlock {
    /// The samples, at least one. The i-th is at t = 2 i/15 − 1 along the line.
    pub samples: Vec<SamplePoints>,
    /// Points on the same line at t = −1, −1/3, 1/3 and 1: a cubic through their places in the picture gives those of the samples. Where the samples
    /// are not even, they are all the first sample, and outside of the limits.
    pub nodes: [SamplePoints; NODES],
    /// Where the cubic is right.
    pub limits: Limits,
    /// Centre of a circle on the ground that contains all points of the samples, metres.
    pub centre: [f32; 2],
    /// Its radius, metres.
    pub radius_m: f32,
}
