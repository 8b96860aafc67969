//! From votes to the ground: a colour for every cell, and from how many directions it was seen empty.

use rayon::prelude::*;
use reality_sim_core::field::FieldDimensions;

use super::{
    carpet::Carpet,
    goal_volumes::GoalVolumes,
    grid::Grid,
    votes::{DIRECTIONS, Votes, judged},
};
use crate::shrunk::ShrunkPicture;

/// Weight of a vote for a colour that the carpet does not have: paint that no line explains wins where nobody saw anything else.
const IMPLAUSIBLE: f32 = 0.2;
/// Difference up to which votes agree, grey levels: noise, and the light from different directions.
const AGREEING: f32 = 25.0;
/// Least weight of a vote from a coarse pixel, against that of the finest one.
const COARSEST: f32 = 0.2;
/// Distance within which the ground around a cell is seen from as many directions as the cell itself, metres: the size of a foot.
const AROUND_M: f64 = 0.25;
/// Share of these directions from which paint is seen at least.
const SEEN_AS_OFTEN: f32 = 0.6;

/// Cell of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub color: [f32; 3],
    /// Number of directions from which it was seen with this colour.
    pub views: u8,
    /// Whether the carpet, or paint on it, may have this colour.
    pub is_plausible: bool,
}

/// Mosaic of the ground.
pub(super) struct Mosaic {
    pub grid: Grid,
    /// Cells; `None` where nothing was seen.
    pub cells: Vec<Option<Cell>>,
    /// Cells on which something stood whenever they were seen.
    pub never_empty: Vec<bool>,
}

/// Returns the medians of the votes on coarse cells.
pub(super) fn coarse_colors(
    grid: &Grid,
    pictures: &[ShrunkPicture],
    goals: &GoalVolumes,
) -> Vec<Option<[f32; 3]>> {
    judged(grid, pictures, goals, |_, votes| {
        let weighed: Vec<([f32; 3], f32)> =
            weighed(votes).into_iter().map(|(_, color, weight)| (color, weight)).collect();
        weighted_median(&weighed)
    })
}

impl Mosaic {
    /// Makes the mosaic of what pictures show, their masks excepted.
    pub fn new(
        field: &FieldDimensions,
        cell_m: f64,
        pictures: &[ShrunkPicture],
        goals: &GoalVolumes,
        carpet: &Carpet,
    ) -> Self {
        let grid = Grid::of_carpet(field, cell_m);
        let cells = judged(&grid, pictures, goals, |cell, votes| judge(&grid, carpet, cell, votes));
        let never_empty = never_empty(&grid, &cells);
        Self { grid, cells, never_empty }
    }
}

/// Returns the votes with their directions and weights: all votes from a direction together weigh as much as one.
fn weighed(votes: &Votes) -> Vec<(usize, [f32; 3], f32)> {
    let mut from = [0.0_f32; DIRECTIONS];
    let mut finest_m = f32::INFINITY;
    for (direction, vote) in votes.by_direction() {
        from[direction] += 1.0;
        finest_m = finest_m.min(vote.depth_m);
    }
    votes
        .by_direction()
        .map(|(direction, vote)| {
            let weight = (finest_m / vote.depth_m).max(COARSEST) / from[direction];
            (direction, vote.color(), weight)
        })
        .collect()
}

fn judge(grid: &Grid, carpet: &Carpet, cell: usize, votes: &Votes) -> Option<Cell> {
    let point_m = grid.center_m(cell);
    let may_be_painted = carpet.may_be_painted(point_m);
    let all = weighed(votes);
    let plausible =
        |color| if carpet.is_plausible(point_m, may_be_painted, color) { 1.0 } else { IMPLAUSIBLE };
    let judged: Vec<([f32; 3], f32)> =
        all.iter().map(|(_, color, weight)| (*color, weight * plausible(*color))).collect();
    let middle = weighted_median(&judged)?;
    let (mut sum, mut total) = ([0.0_f32; 3], 0.0);
    let mut agreeing = [false; DIRECTIONS];
    for (direction, color, weight) in &all {
        if (0..3).all(|channel| (color[channel] - middle[channel]).abs() <= AGREEING) {
            agreeing[*direction] = true;
            total += weight;
            sum.iter_mut().zip(color).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    let color = if total > 0.0 { sum.map(|sum| sum / total) } else { middle };
    Some(Cell {
        color,
        views: agreeing.iter().filter(|agrees| **agrees).count() as u8,
        is_plausible: carpet.is_plausible(point_m, may_be_painted, color),
    })
}

/// Returns the channel-wise median of weighted colours, `None` of none.
fn weighted_median(colors: &[([f32; 3], f32)]) -> Option<[f32; 3]> {
    let half = colors.iter().map(|(_, weight)| weight).sum::<f32>() / 2.0;
    let mut values: Vec<(f32, f32)> = Vec::with_capacity(colors.len());
    let mut middle = [0.0; 3];
    for (channel, middle) in middle.iter_mut().enumerate() {
        values.clear();
        values.extend(colors.iter().map(|(color, weight)| (color[channel], *weight)));
        values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut below = 0.0;
        let found = values.iter().find(|(_, weight)| {
            below += weight;
            below >= half
        });
        *middle = found?.0;
    }
    Some(middle)
}

/// Marks the cells on which something stood whenever they were seen: cells of colours that the carpet does not have, seen so from much
/// fewer directions than the ground around them is seen, because things that are higher than the carpet show other sides of themselves
/// elsewhere, or are masked. Paint is seen with its colour from wherever the ground around it is.
fn never_empty(grid: &Grid, cells: &[Option<Cell>]) -> Vec<bool> {
    let reach = (AROUND_M / grid.cell_m).ceil() as usize;
    let views: Vec<u8> = cells.iter().map(|cell| cell.map_or(0, |cell| cell.views)).collect();
    let around = greatest_around(&views, grid.width, reach);
    let is_odd =
        |cell: &Cell, most: u8| !cell.is_plausible && f32::from(cell.views) < SEEN_AS_OFTEN * f32::from(most);
    cells.iter().zip(around).map(|(cell, most)| cell.is_some_and(|cell| is_odd(&cell, most))).collect()
}

/// Returns the greatest number in the square of cells around each: along rows first, then along columns.
fn greatest_around(numbers: &[u8], width: usize, reach: usize) -> Vec<u8> {
    let along = |values: &[u8], at: usize| {
        let near = &values[at.saturating_sub(reach)..values.len().min(at + reach + 1)];
        near.iter().copied().max().unwrap_or_default()
    };
    let rows: Vec<u8> =
        numbers.chunks(width).flat_map(|row| (0..row.len()).map(move |column| along(row, column))).collect();
    let height = rows.len() / width;
    let columns: Vec<Vec<u8>> = (0..width)
        .into_par_iter()
        .map(|column| {
            let values: Vec<u8> = rows.iter().skip(column).step_by(width).copied().collect();
            (0..height).map(|row| along(&values, row)).collect()
        })
        .collect();
    (0..numbers_of(&columns)).map(|cell| columns[cell % width][cell / width]).collect()
}

fn numbers_of(columns: &[Vec<u8>]) -> usize {
    columns.iter().map(Vec::len).sum()
}
