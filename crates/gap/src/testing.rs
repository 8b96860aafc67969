//! What tests of several modules make their data of.

use std::collections::BTreeMap;

use glam::DVec2;
use nalgebra::{DMatrix, DVector};

use crate::{
    linear_model::normal_equations::NormalEquations,
    linear_model::system::LinearSystem,
    measurement::quantity::{ColorChannel, Quantity},
    measurement::scalar::Measurement,
};

/// Numbers from a fixed linear congruential generator, summed to be nearly normal.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// A measurement of a quantity, seen from straight above.
pub(crate) fn measurement(quantity: Quantity) -> Measurement {
    Measurement {
        quantity,
        measured: 0.0,
        sigma: 0.0,
        pixel: DVec2::ZERO,
        ground: DVec2::ZERO,
        normal: DVec2::X,
        speed_px_s: 0.0,
        half_width_px: 2.0,
        cos_incidence: 1.0,
    }
}

/// The green of a block of carpet.
pub(crate) fn carpet_measurement(pixel: DVec2, ground: DVec2) -> Measurement {
    Measurement {
        pixel,
        ground,
        normal: DVec2::ZERO,
        half_width_px: 0.0,
        ..measurement(Quantity::CarpetLevel(ColorChannel::Green))
    }
}

/// A system of frames with these normal equations; each is a view and a place on the field of its own.
pub(crate) fn system_of(frames: Vec<(DMatrix<f64>, DVector<f64>)>) -> LinearSystem {
    let size = frames[0].1.len();
    let frames: Vec<NormalEquations> =
        frames.into_iter().map(|(a, g)| NormalEquations::whole(a, g)).collect();
    LinearSystem {
        size,
        cells: frames.clone(),
        views: frames.clone(),
        frames,
        sigmas: BTreeMap::new(),
        pose_sigmas: [1.0; 6],
        weights: Vec::new(),
    }
}
