//! Which residuals are binned together.

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
    /// One quantity of the channel; all of them where none is given.
    quantity: Option<Quantity>,
}

impl Source {
    const fn whole(channel: Channel) -> Self {
        Self { channel, quantity: None }
    }

    const fn one(quantity: Quantity) -> Self {
        Self { channel: quantity.channel(), quantity: Some(quantity) }
    }

    /// What it is binned by. Where lines are and how sharp they are may change as the picture moves.
    pub(super) fn loci(&self) -> &'static [Locus] {
        match self.channel {
            Channel::Geometry | Channel::Sharpness => {
                &[Locus::Picture, Locus::Field, Locus::Time, Locus::Speed]
            }
            _ => &[Locus::Picture, Locus::Field, Locus::Time],
        }
    }

    pub(super) fn has(&self, row: &Measurement) -> bool {
        row.quantity.channel() == self.channel
            && self.quantity.is_none_or(|quantity| row.quantity == quantity)
    }

    /// Returns the standard deviation of all its measurements together, root mean square over them.
    pub(super) fn usual_sigma(self, frames: &[FrameResiduals<'_>], sigmas: &BTreeMap<Quantity, f64>) -> f64 {
        let rows = frames.iter().flat_map(|frame| frame.measurements).filter(|row| self.has(row));
        let squares = rows.filter_map(|row| Some(sigmas.get(&row.quantity)?.powi(2)));
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        f64::sqrt(sum / f64::max(count, 1.0))
    }
}

/// Red and blue are bent to opposite sides by a lens: together they would cancel.
pub(super) const SOURCES: [Source; 6] = [
    Source::whole(Channel::Geometry),
    Source::whole(Channel::Photometry),
    Source::whole(Channel::Sharpness),
    Source::one(Quantity::RedOffset),
    Source::one(Quantity::BlueOffset),
    Source::whole(Channel::Noise),
];
