//! What tests of several modules make their data of.

use glam::DVec2;

use crate::rows::{Channel, Group, Row};

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

/// A row of a channel, seen from straight above.
pub(crate) fn row(channel: Channel, part: u8) -> Row {
    Row {
        group: Group { channel, part },
        measured: 0.0,
        sigma: 0.0,
        pixel: DVec2::ZERO,
        ground: DVec2::ZERO,
        normal: DVec2::X,
        half_width_px: 2.0,
        cos_incidence: 1.0,
    }
}

/// The green of a block of carpet.
pub(crate) fn carpet_row(pixel: DVec2, ground: DVec2) -> Row {
    Row { pixel, ground, normal: DVec2::ZERO, half_width_px: 0.0, ..row(Channel::Photometry, 4) }
}
