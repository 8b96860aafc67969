//! What is remembered of the panel from one start to the next.

use reality_sim_gap::Channel;
use serde::{Deserialize, Serialize};

use super::side::Side;

/// Choices that are kept from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GapSettings {
    /// Which model's pictures and residuals are shown.
    pub side: Side,
    /// The difference between the pictures in place of the wipe.
    pub is_difference: bool,
    /// Where the line of the wipe is, 0 to 1 from the left.
    pub wipe_share: f32,
    /// The comparison whose residuals are shown; where the report does not have it, the one with the most to see.
    pub channel: Option<Channel>,
}

impl Default for GapSettings {
    fn default() -> Self {
        Self { side: Side::default(), is_difference: false, wipe_share: 0.5, channel: None }
    }
}
