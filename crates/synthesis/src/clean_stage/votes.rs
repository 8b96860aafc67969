//! Votes on the colours of cells of the ground: what pictures show there, one vote a direction and part of the time.
//!
//! A thing hides another part of the ground from every direction, so that directions are counted and not pictures: a camera that
//! stands still takes many pictures of the same thing in front of the same cells. A thing that moves is gone at another time.

use rayon::prelude::*;
use reality_sim_core::{
    camera::{LANES, Lanes},
    warp::{Placement, ground_colors},
};

use super::{goal_volumes::GoalVolumes, grid::Grid};
use crate::shrunk::ShrunkPicture;

/// Number of directions from which a cell is seen.
pub(super) const DIRECTIONS: usize = 24;
/// Number of parts of the time of all recordings.
const TIMES: usize = 2;
/// Largest depth on the ground of a pixel that votes, metres: coarser ones show carpet and lines mixed.
const DEEPEST_PIXEL_M: f32 = 1.0;
/// Cells that are voted on together: the votes stay in the processor's nearest memory.
const CELLS: usize = 4 * LANES;

/// What a picture shows of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vote {
    pub color: [u8; 3],
    /// Depth of the picture's pixel on the ground, metres; infinite where nobody votes.
    pub depth_m: f32,
}

impl Vote {
    const NONE: Self = Self { color: [0; 3], depth_m: f32::INFINITY };

    /// Returns the colour, as numbers.
    pub fn color(&self) -> [f32; 3] {
        self.color.map(f32::from)
    }
}

/// Votes on a cell: [`DIRECTIONS`] times the parts of the time.
#[derive(Clone, Copy)]
pub(super) struct Votes([Vote; DIRECTIONS * TIMES]);

impl Votes {
    /// Returns the votes with the numbers of their directions.
    pub fn by_direction(&self) -> impl Iterator<Item = (usize, &Vote)> {
        let votes = self.0.iter().enumerate().map(|(slot, vote)| (slot / TIMES, vote));
        votes.filter(|(_, vote)| vote.depth_m.is_finite())
    }
}

/// Lets pictures vote on every cell, and judges the votes; `judge` gets the cell and its votes. Pictures' masks count.
pub(super) fn judged<T: Send>(
    grid: &Grid,
    pictures: &[ShrunkPicture],
    goals: &GoalVolumes,
    judge: impl Fn(usize, &Votes) -> T + Sync,
) -> Vec<T> {
    let runs_in_row = grid.width.div_ceil(CELLS);
    let runs = (0..grid.height * runs_in_row).into_par_iter();
    runs.flat_map_iter(|run| {
        let (row, first) = (run / runs_in_row, run % runs_in_row * CELLS);
        let cells = first..grid.width.min(first + CELLS);
        let run = CellRun { grid, row, first };
        let mut votes = [Votes([Vote::NONE; DIRECTIONS * TIMES]); CELLS];
        for (number, picture) in pictures.iter().enumerate() {
            run.let_vote(picture, number * TIMES / pictures.len(), goals, &mut votes);
        }
        let judged: Vec<T> =
            cells.map(|column| judge(row * grid.width + column, &votes[column - first])).collect();
        judged
    })
    .collect()
}

/// Neighbouring cells of a row.
struct CellRun<'a> {
    grid: &'a Grid,
    row: usize,
    /// First column.
    first: usize,
}

impl CellRun<'_> {
    /// Adds the votes of a picture.
    fn let_vote(
        &self,
        picture: &ShrunkPicture,
        time: usize,
        goals: &GoalVolumes,
        votes: &mut [Votes; CELLS],
    ) {
        let Placement { position_in_world, .. } = picture.placement;
        let [x, y, height_m] = position_in_world;
        let focal_px = picture.camera.kernel.fy;
        let middle = self.place_m(CELLS / 2);
        let away_m2 = (middle[0] - x).powi(2) + (middle[1] - y).powi(2);
        if away_m2 > DEEPEST_PIXEL_M * height_m * focal_px
            || goals.hide(position_in_world.into(), [middle[0], middle[1], 0.0].into())
        {
            return;
        }
        for (block, votes) in votes.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let places: [Lanes; 2] =
                [0, 1].map(|axis| std::array::from_fn(|lane| self.place_m(block * LANES + lane)[axis]));
            let Some(seen) = ground_colors(&picture.source(), &places) else { continue };
            for (lane, votes) in votes.iter_mut().enumerate() {
                if seen.shown[lane] > 0.0 {
                    let depth_m = 1.0 / (seen.nearness[lane] * seen.nearness[lane] * height_m * focal_px);
                    let slot = TIMES * direction(x - places[0][lane], y - places[1][lane]) + time;
                    if depth_m < votes.0[slot].depth_m.min(DEEPEST_PIXEL_M) {
                        let value = |channel: usize| seen.color[channel][lane] * picture.gain[channel] + 0.5;
                        votes.0[slot] =
                            Vote { color: [0, 1, 2].map(|channel| value(channel) as u8), depth_m };
                    }
                }
            }
        }
    }

    /// Returns the centre of the run's n-th cell, metres.
    fn place_m(&self, number: usize) -> [f32; 2] {
        let column = (self.first + number) as f64 + 0.5;
        let place = self.grid.min_m + self.grid.cell_m * glam::DVec2::new(column, self.row as f64 + 0.5);
        place.as_vec2().to_array()
    }
}

/// Returns the number of a direction. Sectors differ a little in width: |x| + |y| takes the place of the distance.
fn direction(x: f32, y: f32) -> usize {
    let part = y / (x.abs() + y.abs()).max(f32::MIN_POSITIVE);
    let quarters = if x >= 0.0 { 1.0 + part } else { 3.0 - part };
    (quarters * (DIRECTIONS as f32 / 4.0)) as usize % DIRECTIONS
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    #[test]
    fn directions_are_sectors_in_order_around_the_cell() {
        let around: Vec<usize> = (0..3600)
            .map(|step| {
                let (y, x) = (TAU * step as f32 / 3600.0).sin_cos();
                direction(x, y)
            })
            .collect();
        let next = around.iter().cycle().skip(1);
        let changes: Vec<_> = around.iter().zip(next).filter(|(before, after)| before != after).collect();
        assert_eq!(changes.len(), DIRECTIONS);
        assert!(changes.iter().all(|(before, after)| (*before + 1) % DIRECTIONS == **after));
        for number in 0..DIRECTIONS {
            let share = around.iter().filter(|direction| **direction == number).count();
            assert!((80..=230).contains(&share), "{number}: {share}");
        }
        assert!(direction(0.0, 0.0) < DIRECTIONS);
    }
}
