//! Patches of the field, from the smallest to those that contain them.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use reality_sim_sensor::Surface;

use crate::{
    measurement::quantity::Quantity,
    thresholds::{ReflectanceThresholds, Thresholds},
};

const THRESHOLDS: ReflectanceThresholds = Thresholds::DEFAULT.linear_model.reflectance;
/// Number of sizes of patches.
pub(super) const SCALES: usize = 5;

/// Returns the side of the smallest patches of a surface, whose level this is, metres.
fn smallest_m(level: Quantity) -> f64 {
    match level.surface() {
        Some(Surface::Line) => THRESHOLDS.smallest_line_patch_m,
        _ => THRESHOLDS.smallest_carpet_patch_m,
    }
}

/// Size of patches of one surface in one colour. Patches have `2^power` times the side of the smallest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Scale {
    /// Level that the reflectance changes.
    pub(crate) level: Quantity,
    pub(crate) power: usize,
}

impl Scale {
    /// Iterates over all scales, from the smallest patches to the largest.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        (0..SCALES).flat_map(|power| Quantity::levels().map(move |level| Self { level, power }))
    }
}

/// Index of a patch of a [`Tree`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct PatchIndex(pub(crate) usize);

/// Patch of the field.
#[derive(Debug, Clone, Copy)]
struct Patch {
    scale: Scale,
    /// Patch twice as large that contains it. None for the largest.
    parent: Option<PatchIndex>,
}

/// Patches in which a recording shows a colour of carpet or of lines, with all larger patches that contain them. A patch stands before the one
/// that contains it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    patches: Vec<Patch>,
    smallest: BTreeMap<(Quantity, [i32; 2]), PatchIndex>,
}

impl Tree {
    /// Creates the patches that contain these places on the ground, world axes, metres.
    pub(crate) fn new(places: impl Iterator<Item = (Quantity, DVec2)>) -> Self {
        let mut squares: BTreeSet<(Quantity, [i32; 2])> =
            places.map(|(level, ground)| (level, square(level, ground))).collect();
        let mut tree = Self::default();
        let mut inside: BTreeMap<(Quantity, [i32; 2]), PatchIndex> = BTreeMap::new();
        for power in 0..SCALES {
            let first = tree.patches.len();
            let patch = |level| Patch { scale: Scale { level, power }, parent: None };
            tree.patches.extend(squares.iter().map(|(level, _)| patch(*level)));
            let of_scale: BTreeMap<_, _> = squares.iter().copied().zip((first..).map(PatchIndex)).collect();
            for (key, smaller) in &inside {
                tree.patches[smaller.0].parent = of_scale.get(&larger(*key)).copied();
            }
            if power == 0 {
                tree.smallest.clone_from(&of_scale);
            }
            squares = squares.into_iter().map(larger).collect();
            inside = of_scale;
        }
        tree
    }

    /// Returns the number of patches.
    pub(crate) fn len(&self) -> usize {
        self.patches.len()
    }

    /// Iterates over all patches; each stands before the one that contains it.
    pub(crate) fn patches(&self) -> impl DoubleEndedIterator<Item = PatchIndex> + use<> {
        (0..self.patches.len()).map(PatchIndex)
    }

    pub(crate) fn scale(&self, patch: PatchIndex) -> Scale {
        self.patches[patch.0].scale
    }

    /// Returns the patch that contains a patch. None for the largest.
    pub(crate) fn parent(&self, patch: PatchIndex) -> Option<PatchIndex> {
        self.patches[patch.0].parent
    }

    /// Returns the smallest patch of a level that contains a place on the ground, world axes, metres.
    pub(crate) fn smallest_at(&self, level: Quantity, ground: DVec2) -> Option<PatchIndex> {
        self.smallest.get(&(level, square(level, ground))).copied()
    }
}

/// Returns the square of the smallest patches' grid that contains a place.
fn square(level: Quantity, ground: DVec2) -> [i32; 2] {
    let place = (ground / smallest_m(level)).floor();
    [place.x as i32, place.y as i32]
}

/// Returns the square twice as large that contains a square.
fn larger((level, square): (Quantity, [i32; 2])) -> (Quantity, [i32; 2]) {
    (level, square.map(|place| place.div_euclid(2)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::quantity::ColorChannel;

    const LEVELS: [Quantity; 3] = [
        Quantity::LineLevel(ColorChannel::Green),
        Quantity::CarpetLevel(ColorChannel::Green),
        Quantity::CarpetLevel(ColorChannel::Blue),
    ];

    /// Returns the side of the smallest patch that contains two places, metres.
    fn common_m(tree: &Tree, level: Quantity, places: [DVec2; 2]) -> Option<f64> {
        let [mut a, mut b] = places.map(|place| tree.smallest_at(level, place).unwrap());
        while a != b {
            (a, b) = (tree.parent(a)?, tree.parent(b)?);
        }
        Some(smallest_m(level) * f64::from(1_u32 << tree.scale(a).power))
    }

    #[test]
    fn places_share_the_patches_that_contain_both() {
        let places = [[0.1, 0.1], [0.2, 0.1], [0.7, 0.1], [-0.1, 0.1], [3.9, 3.9]].map(DVec2::from);
        let tree = Tree::new(places.into_iter().map(|place| (LEVELS[1], place)));
        let side_m = |a: usize, b: usize| common_m(&tree, LEVELS[1], [places[a], places[b]]);
        assert_eq!(side_m(0, 1), Some(0.25));
        assert_eq!(side_m(0, 2), Some(1.0));
        assert_eq!(side_m(0, 4), Some(4.0));
        assert_eq!(side_m(0, 3), None, "patches on both sides of an axis have nothing in common");
    }

    #[test]
    fn levels_share_no_patch_and_each_patch_stands_before_the_one_that_contains_it() {
        let place = DVec2::new(0.3, -1.2);
        let tree = Tree::new(LEVELS.into_iter().map(|level| (level, place)));
        assert_eq!(tree.len(), 3 * SCALES);
        for patch in tree.patches() {
            let Some(parent) = tree.parent(patch) else { continue };
            assert!(parent > patch);
            assert_eq!(tree.scale(parent).level, tree.scale(patch).level);
            assert_eq!(tree.scale(parent).power, tree.scale(patch).power + 1);
        }
        assert_eq!(tree.patches().filter(|patch| tree.parent(*patch).is_none()).count(), 3);
        assert!(tree.smallest_at(LEVELS[0], DVec2::new(2.0, 2.0)).is_none());
    }
}
