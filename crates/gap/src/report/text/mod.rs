//! Report in words, all of which are made here from the report's numbers.

mod channel;
mod effect;
mod finding;
mod input_mistake;
mod number;
mod object;
mod place;
mod poses;
mod summary;
mod unobservable;
mod verdict;

pub(crate) use reality_sim_sensor::text::rounded;
pub use reality_sim_sensor::text::{digits, percent, with_sigma};

pub(crate) use self::number::closed;
pub use self::{
    channel::{channel_meaning, channel_scale, channel_title},
    effect::{deciding_recordings, effect_because, effect_name, effect_size, estimate, library_name, limit},
    finding::{finding_place, finding_size},
    number::{amount, plain_probability, probability},
    object::{hidden_carpet, object_place, object_share},
    poses::{absorbed, reference_source},
    summary::summary,
    unobservable::{unobservable_reason, unobservable_remedy},
    verdict::{verdict_meaning, verdict_word},
};

/// Unit of the whole gap.
pub const GAP_UNIT: &str = "noise floors";
