//! Fragments of one pixel, put over each other.

use glam::Vec3;

use crate::canvas::{Fragment, PARTS};

/// Light that gets through fragments below which nothing behind them is seen.
const LEAST_LIGHT: f32 = 1e-3;

/// What the layers show in a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pixel {
    /// Linear red, green and blue, times the covered part.
    pub(crate) color: Vec3,
    /// Covered part, 0 to 1.
    pub(crate) cover: f32,
    /// Object that covers most, if objects cover half of the pixel or more.
    pub(crate) object: Option<u16>,
    /// Its mean distance, metres.
    pub(crate) distance_m: f32,
}

impl Pixel {
    pub(crate) const EMPTY: Self =
        Self { color: Vec3::ZERO, cover: 0.0, object: None, distance_m: f32::INFINITY };
}

/// Memory for the fragments of one pixel.
#[derive(Debug, Default)]
pub(crate) struct Stack {
    pub(crate) fragments: Vec<Fragment>,
    /// Parts of the pixel that are alike, with the share of the light that gets through the fragments so far.
    groups: Vec<(u16, f32)>,
    /// Covered part and sum of the distances of each object.
    shares: Vec<(u16, f32, f32)>,
}

impl Stack {
    /// Puts all fragments over each other, the nearest in front, part by part.
    pub(crate) fn composed(&mut self) -> Pixel {
        if self.fragments.is_empty() {
            return Pixel::EMPTY;
        }
        self.fragments.sort_unstable_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
        self.shares.clear();
        let pixel = if self.fragments.iter().all(|fragment| fragment.alpha >= 1.0) {
            self.opaque()
        } else {
            self.translucent()
        };
        self.labelled(pixel)
    }

    /// Puts fragments over each other that hide all behind them.
    fn opaque(&mut self) -> Pixel {
        let mut pixel = Pixel::EMPTY;
        let mut left = Fragment::ALL;
        for index in 0..self.fragments.len() {
            let fragment = self.fragments[index];
            let share = (left & fragment.parts).count_ones() as f32 / PARTS as f32;
            if share > 0.0 {
                left &= !fragment.parts;
                pixel.color += share * fragment.color;
                pixel.cover += share;
                self.add_share(fragment.object, share, fragment.distance_m);
            }
            if left == 0 {
                break;
            }
        }
        pixel
    }

    fn translucent(&mut self) -> Pixel {
        self.groups.clear();
        self.groups.push((Fragment::ALL, 1.0));
        let mut pixel = Pixel::EMPTY;
        for index in 0..self.fragments.len() {
            let fragment = self.fragments[index];
            let share = self.seen_share(&fragment);
            if share > 0.0 {
                pixel.color += share * fragment.color;
                pixel.cover += share * fragment.alpha;
                self.add_share(fragment.object, share * fragment.alpha, fragment.distance_m);
            }
            if self.groups.is_empty() {
                break;
            }
        }
        pixel
    }

    /// Adds to a pixel which object covers most of it.
    fn labelled(&self, mut pixel: Pixel) -> Pixel {
        pixel.cover = pixel.cover.min(1.0);
        if pixel.cover >= 0.5
            && let Some((object, share, sum)) = self.shares.iter().max_by(|a, b| a.1.total_cmp(&b.1))
        {
            (pixel.object, pixel.distance_m) = (Some(*object), sum / share);
        }
        pixel
    }

    /// Returns the part of the pixel in which a fragment is seen, and lets it hide what follows.
    fn seen_share(&mut self, fragment: &Fragment) -> f32 {
        let mut share = 0.0;
        for index in 0..self.groups.len() {
            let (parts, light) = self.groups[index];
            let hit = parts & fragment.parts;
            if hit == 0 {
                continue;
            }
            share += light * hit.count_ones() as f32 / PARTS as f32;
            self.groups[index].0 = parts & !hit;
            self.groups.push((hit, light * (1.0 - fragment.alpha)));
        }
        self.groups.retain(|(parts, light)| *parts != 0 && *light > LEAST_LIGHT);
        share
    }

    fn add_share(&mut self, object: u16, share: f32, distance_m: f32) {
        match self.shares.iter_mut().find(|(known, ..)| *known == object) {
            Some((_, sum, distances)) => {
                *sum += share;
                *distances += share * distance_m;
            }
            None => self.shares.push((object, share, share * distance_m)),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fragment(distance_m: f32, alpha: f32, parts: u16, object: u16) -> Fragment {
        let shade = 0.1 * f32::from(object + 1);
        Fragment { color: alpha * Vec3::new(shade, 0.5, 1.0 - shade), alpha, distance_m, object, parts }
    }

    fn composed(fragments: &[Fragment]) -> Pixel {
        Stack { fragments: fragments.to_vec(), ..Stack::default() }.composed()
    }

    #[test]
    fn the_nearest_hides_what_is_behind_part_by_part() {
        let near = fragment(1.0, 1.0, 0x00ff, 0);
        let far = fragment(2.0, 1.0, Fragment::ALL, 1);
        let pixel = composed(&[far, near]);
        assert!((pixel.color - 0.5 * (near.color + far.color)).length() < 1e-6);
        assert_eq!(pixel.cover, 1.0);
        let hidden = composed(&[fragment(0.5, 1.0, Fragment::ALL, 2), far, near]);
        assert_eq!((hidden.object, hidden.distance_m), (Some(2), 0.5));
    }

    #[test]
    fn light_through_a_pane_is_that_of_the_over_operator() {
        let (pane, wall) = (fragment(1.0, 0.25, Fragment::ALL, 0), fragment(2.0, 1.0, Fragment::ALL, 1));
        let pixel = composed(&[wall, pane]);
        assert!((pixel.color - (pane.color + 0.75 * wall.color)).length() < 1e-6);
        assert_eq!(pixel.object, Some(1));
        assert!(
            (composed(&[pane, fragment(3.0, 0.5, Fragment::ALL, 1)]).cover - (1.0 - 0.75 * 0.5)).abs() < 1e-6
        );
        assert_eq!(composed(&[]), Pixel::EMPTY);
        assert_eq!(composed(&[fragment(1.0, 0.4, Fragment::ALL, 0)]).object, None);
    }

    proptest! {
        #[test]
        fn the_result_does_not_depend_on_the_order_and_opaque_fragments_are_the_limit_of_translucent_ones(
            parts in prop::collection::vec(any::<u16>(), 1..6),
        ) {
            let fragments: Vec<Fragment> = parts
                .iter()
                .enumerate()
                .map(|(index, parts)| fragment(index as f32 + 1.0, 1.0, *parts, index as u16))
                .collect();
            let pixel = composed(&fragments);
            let reversed: Vec<Fragment> = fragments.iter().rev().copied().collect();
            prop_assert_eq!(pixel, composed(&reversed));
            let all = parts.iter().fold(0, |all, parts| all | parts);
            prop_assert!((pixel.cover - all.count_ones() as f32 / 16.0).abs() < 1e-6);
            let pane: Vec<Fragment> = fragments.iter().map(|f| Fragment { alpha: 0.9999, ..*f }).collect();
            let through = composed(&pane);
            prop_assert!((through.color - pixel.color).length() < 2e-3, "{:?} {:?}", through, pixel);
        }
    }
}
