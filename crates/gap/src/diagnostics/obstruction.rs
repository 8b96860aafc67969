//! Something in front of the lens, or on it: the same part of every picture shows no carpet, wherever the camera looks.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::{
    diagnostics::{
        carpet,
        detector::{Detector, FitResiduals, FrameResiduals},
        finding::Finding,
    },
    thresholds::{ObstructionThresholds, Thresholds},
};

const THRESHOLDS: ObstructionThresholds = Thresholds::DEFAULT.diagnostics.obstruction;
const GRID: [usize; 2] = Thresholds::DEFAULT.diagnostics.patterns.picture_grid;

/// Detector of what hides the same part of every picture.
pub(crate) struct Obstruction;

impl Detector for Obstruction {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        Vec::from_iter(obstruction(&fit.frames, carpet::sigma(fit.sigmas)))
    }
}

/// What the pictures show in one block.
#[derive(Debug, Clone, Default)]
struct BlockSeen {
    /// Number of pictures in which the block is carpet or hidden carpet.
    pictures: usize,
    /// Points of the ground where it is hidden, world axes, metres.
    hidden_at: Vec<DVec2>,
}

impl BlockSeen {
    /// Whether the block is hidden in nearly every picture, at places so far apart that no single thing hides them all.
    fn is_obstructed(&self) -> bool {
        let hidden = self.hidden_at.len();
        let low = self.hidden_at.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = self.hidden_at.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        hidden >= THRESHOLDS.least_pictures
            && hidden as f64 >= THRESHOLDS.least_hidden * self.pictures as f64
            && (high - low).max_element() > THRESHOLDS.least_extent_m
    }
}

/// Returns the share of the carpet that is hidden wherever the camera looks, if it is large enough. `sigma` is the standard
/// deviation of a block's residual.
fn obstruction(frames: &[FrameResiduals<'_>], sigma: f64) -> Option<Finding> {
    let mut seen: BTreeMap<[i32; 2], BlockSeen> = BTreeMap::new();
    for frame in frames {
        for (measurement, residual) in carpet::blocks(frame) {
            let block = seen.entry(measurement.pixel.floor().as_ivec2().to_array()).or_default();
            block.pictures += 1;
            if carpet::is_hidden(residual, sigma) {
                block.hidden_at.push(measurement.ground);
            }
        }
    }
    let all: usize = seen.values().map(|block| block.pictures).sum();
    let obstructed = || seen.iter().filter(|(_, block)| block.is_obstructed());
    let hidden: usize = obstructed().map(|(_, block)| block.hidden_at.len()).sum();
    let share = hidden as f64 / all.max(1) as f64;
    let size = frames.first()?.size;
    let middle = obstructed().fold(DVec2::ZERO, |sum, (&[x, y], block)| {
        sum + block.hidden_at.len() as f64 * DVec2::new(f64::from(x), f64::from(y))
    }) / hidden.max(1) as f64;
    let cell = |value: f64, size: u32, cells: usize| {
        ((value / f64::from(size) * cells as f64).max(0.0) as usize).min(cells - 1)
    };
    let [column, row] = [cell(middle.x, size[0], GRID[0]), cell(middle.y, size[1], GRID[1])];
    (share > THRESHOLDS.least_share).then_some(Finding::Obstruction { share, column, row, grid: GRID })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::carpet::pictures::{SIGMA, with_walk};

    fn found(frames: &[FrameResiduals<'_>]) -> Option<Finding> {
        obstruction(frames, SIGMA)
    }

    #[test]
    fn dirt_that_hides_the_same_part_of_every_picture_is_found_with_its_share_and_place() {
        let dirt = |_: u32, place: DVec2, _: DVec2| {
            if place.distance(DVec2::new(0.2, 0.7)) < 0.1 { -1.0 } else { 0.0 }
        };
        let Some(Finding::Obstruction { share, column, row, grid }) = with_walk(dirt, found) else {
            panic!()
        };
        assert!((share - 0.0314).abs() < 0.005, "{share}");
        assert_eq!(([column, row], grid), ([1, 4], GRID));
    }

    #[test]
    fn what_stands_on_the_field_and_what_hides_a_part_in_some_pictures_is_no_obstruction() {
        let stands = |_: u32, _: DVec2, ground: DVec2| {
            if ground.distance(DVec2::new(3.0, 1.5)) < 1.0 { -1.0 } else { 0.0 }
        };
        assert_eq!(with_walk(stands, found), None);
        let passes = |picture: u32, place: DVec2, _: DVec2| {
            if picture < 16 && place.x < 0.2 { -1.0 } else { 0.0 }
        };
        assert_eq!(with_walk(passes, found), None);
        assert_eq!(obstruction(&[], SIGMA), None);
    }
}
