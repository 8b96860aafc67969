//! Edges of a billboard, and what of a cell they may cross.

use super::Billboard;

/// Edges of a billboard, metres.
pub(crate) struct Edges {
    half_width: f32,
    top: f32,
    opening_half_width: f32,
    opening_top: f32,
}

/// How much of something a billboard covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meeting {
    None,
    /// Some of it, perhaps.
    Partly,
    Wholly,
}

impl Edges {
    #[inline(always)]
    pub fn new(billboard: &Billboard) -> Self {
        Self {
            half_width: billboard.half_width_m as f32,
            top: billboard.height_m as f32,
            opening_half_width: billboard.opening_half_width_m as f32,
            opening_top: billboard.opening_height_m as f32,
        }
    }

    /// Returns whether a point in the billboard's plane, above the ground, lies on it or at most `margin` beside it,
    /// metres.
    #[inline(always)]
    pub fn hold(&self, across: f32, up: f32, margin: f32) -> bool {
        let across = across.abs();
        let is_opening = (across < self.opening_half_width - margin) & (up < self.opening_top - margin);
        (across <= self.half_width + margin) & (up <= self.top + margin) & !is_opening
    }

    /// Returns how much the billboard, grown by a margin between the two given, covers of a rectangle in its plane, metres.
    #[inline(always)]
    pub fn meeting(&self, across: [f32; 2], up: [f32; 2], [least, most]: [f32; 2]) -> Meeting {
        let [left, right] = across;
        let [bottom, top] = up;
        let largest = self.half_width + most;
        if right < -largest || left > largest || bottom > self.top + most || top < 0.0 {
            return Meeting::None;
        }
        let opening = self.opening_half_width - most;
        if left > -opening && right < opening && top < self.opening_top - most {
            return Meeting::None;
        }
        let smallest = self.half_width + least;
        let is_inside = left >= -smallest && right <= smallest && bottom >= 0.0 && top <= self.top + least;
        let is_solid = self.opening_half_width <= 0.0;
        if is_inside && is_solid { Meeting::Wholly } else { Meeting::Partly }
    }
}

/// Returns the margin by which a post hides more than the flat billboard that stands for it, for a line of sight with this slope
/// against the billboard's normal, metres.
#[inline(always)]
pub(crate) fn post_margin(slope: f32) -> f32 {
    /// Radius of a typical post. Seen obliquely, a round post hides more than the flat one that stands for it, by
    /// an amount that grows with one over the cosine.
    const POST_RADIUS_M: f32 = 0.05;
    /// Less than 1, since pixels and compression spread a post's colour beyond its edge.
    const SHARP_EDGE: f32 = 0.6;
    /// Maximum of one over the cosine: seen nearly edge-on, a billboard would hide everything.
    const MOST_OBLIQUE: f32 = 4.0;
    POST_RADIUS_M * ((1.0 + slope * slope).sqrt().min(MOST_OBLIQUE) - SHARP_EDGE)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Many points of a rectangle say the same as the rectangle does.
        #[test]
        fn what_meets_a_rectangle_meets_its_points(
            left in -2.0f32..2.0, width in 0.0f32..1.0, bottom in -0.5f32..1.5, height in 0.0f32..1.0,
            opening in prop_oneof![Just(0.0f64), 0.3..0.7], margin in 0.0f32..0.1,
        ) {
            let billboard = Billboard {
                x_m: 0.0,
                half_width_m: 0.8,
                height_m: 0.9,
                opening_half_width_m: opening,
                opening_height_m: if opening > 0.0 { 0.8 } else { 0.0 },
            };
            let edges = Edges::new(&billboard);
            let meeting = edges.meeting([left, left + width], [bottom, bottom + height], [margin; 2]);
            for i in 0..=20 {
                for j in 0..=20 {
                    let part = |count: usize| count as f32 / 20.0;
                    let (across, up) = (left + width * part(i), bottom + height * part(j));
                    let is_held = up >= 0.0 && edges.hold(across, up, margin);
                    prop_assert!(meeting != Meeting::None || !is_held, "{across} {up}");
                    prop_assert!(meeting != Meeting::Wholly || is_held, "{across} {up}");
                }
            }
        }
    }
}
