//! Sets of measurements whose residuals are binned together.

use std::collections::BTreeMap;

use super::locus::Locus;
use crate::{
    diagnostics::detector::FrameResiduals,
    measurement::quantity::{Channel, Quantity},
    measurement::scalar::Measurement,
};

/// Measurements that are binned together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source {
    pub(super) channel: Channel,
    /// One quantity of the channel; `None` for all of them.
    quantity: Option<Quantity>,
}

impl Source {
    const fn whole(channel: Channel) -> Self {
        Self { channel, quantity: None }
    }

    const fn one(quantity: Quantity) -> Self {
        Self { channel: quantity.channel(), quantity: Some(quantity) }
    }

    /// Returns the coordinates by which the residuals are binned. The offset and the sharpness of lines may depend on the speed
    /// of the picture. Only where lines lie is looked at by their place on the field: worn paint is less sharp, dirt has another
    /// brightness and trodden carpet another texture, and no camera is behind it.
    pub(super) fn loci(&self) -> &'static [Locus] {
        match self.channel {
            Channel::Geometry => &[Locus::Picture, Locus::Field, Locus::Time, Locus::Speed],
            Channel::Sharpness => &[Locus::Picture, Locus::Time, Locus::Speed],
            _ => &[Locus::Picture, Locus::Time],
        }
    }

    /// Whether a measurement is one of these.
    pub(super) fn has(&self, measurement: &Measurement) -> bool {
        measurement.quantity.channel() == self.channel
            && self.quantity.is_none_or(|quantity| measurement.quantity == quantity)
    }

    /// Returns the root mean square over all these measurements of their residuals' standard deviations.
    pub(super) fn usual_sigma(self, frames: &[FrameResiduals<'_>], sigmas: &BTreeMap<Quantity, f64>) -> f64 {
        let measurements = frames.iter().flat_map(|frame| frame.measurements);
        let sigmas = measurements.filter(|one| self.has(one)).filter_map(|one| sigmas.get(&one.quantity));
        let (sum, count) = sigmas.fold((0.0, 0.0), |(sum, count), sigma| (sum + sigma.powi(2), count + 1.0));
        f64::sqrt(sum / f64::max(count, 1.0))
    }
}

/// All sources. A lens displaces red and blue in opposite directions, so that together they would cancel.
pub(super) const SOURCES: [Source; 6] = [
    Source::whole(Channel::Geometry),
    Source::whole(Channel::Photometry),
    Source::whole(Channel::Sharpness),
    Source::one(Quantity::RedOffset),
    Source::one(Quantity::BlueOffset),
    Source::whole(Channel::Noise),
];
