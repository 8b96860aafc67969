//! Settings of the panel that are kept from one start to the next.

use reality_sim_gap::Channel;
use serde::{Deserialize, Serialize};

use super::side::Side;

/// Settings that are kept from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GapSettings {
    /// Model whose pictures and residuals are shown.
    pub side: Side,
    /// Whether the difference between the pictures is shown in place of the wipe.
    pub is_difference: bool,
    /// Position of the line of the wipe, 0 to 1 from the left.
    pub wipe_share: f32,
    /// Channel whose residuals are shown; if the report lacks it, the one with the largest gap relative to its floor.
    pub channel: Option<Channel>,
}

impl Default for GapSettings {
    fn default() -> Self {
        Self { side: Side::default(), is_difference: false, wipe_share: 0.5, channel: None }
    }
}
