//! Where the ball is and whereto it rolls, by all that was seen of it.

use reality_sim::glam::DVec2;

/// Share of a difference between what is seen and what was expected by which the place follows.
const PLACE_GAIN: f64 = 0.5;
/// Share of it by which the velocity follows: for that of the place, the one with the least error (Benedict and Bordner,
/// "Synthesis of an optimal set of radar track-while-scan smoothing equations", 1962).
const VELOCITY_GAIN: f64 = PLACE_GAIN * PLACE_GAIN / (2.0 - PLACE_GAIN);
/// Difference from which a new ball is seen rather than the old one, metres: somebody has taken it elsewhere.
const OTHER_BALL_M: f64 = 0.5;
/// Time without a sight after which the ball is thought to lie still, seconds.
const FORGOTTEN_S: f64 = 1.0;

/// Track of a ball: an α-β filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallTrack {
    /// Place on the ground, metres.
    pub place_in_world: DVec2,
    /// Velocity, metres per second.
    pub velocity_in_world: DVec2,
    time_s: f64,
    seen_s: f64,
}

impl BallTrack {
    /// Starts with a ball that is seen at a place.
    pub fn new(place_in_world: DVec2, time_s: f64) -> Self {
        Self { place_in_world, velocity_in_world: DVec2::ZERO, time_s, seen_s: time_s }
    }

    /// Returns the track at a later time, seconds, at which the ball is seen at a place or not.
    pub fn followed(self, time_s: f64, seen: Option<DVec2>) -> Self {
        let seconds = time_s - self.time_s;
        let expected = self.place_in_world + seconds * self.velocity_in_world;
        let Some(seen) = seen else {
            let is_forgotten = time_s - self.seen_s > FORGOTTEN_S;
            let velocity_in_world = if is_forgotten { DVec2::ZERO } else { self.velocity_in_world };
            return Self { place_in_world: expected, velocity_in_world, time_s, ..self };
        };
        let difference = seen - expected;
        if difference.length() > OTHER_BALL_M || seconds <= 0.0 {
            return Self::new(seen, time_s);
        }
        Self {
            place_in_world: expected + PLACE_GAIN * difference,
            velocity_in_world: self.velocity_in_world + VELOCITY_GAIN / seconds * difference,
            time_s,
            seen_s: time_s,
        }
    }
}
