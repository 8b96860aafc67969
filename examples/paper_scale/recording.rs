//! Ray-traced recordings: a long walk, and the paper's two sets of true poses, of the same hall with the same camera.

use std::{f64::consts::TAU, path::Path};

use reality_sim::{Pose2, Sequence};
use reality_sim_hidden::Recipe;

/// Seed of hall, camera and walk.
const SEED: u64 = 2013;
/// Columns and rows of the pictures, as in the paper.
const SIZE: [u32; 2] = [640, 480];
/// Distance between places of the grid, metres, as in the paper.
const GRID_M: f64 = 0.3;
/// Distance between places of the crossing, metres: a robot's way from one picture to the next.
const CROSSING_M: f64 = 0.05;
/// Extent of grid and crossing on either side of the field's centre, metres: as far as the robot walks.
const REACH_M: [f64; 2] = [2.4, 1.5];
/// Line along which the field is crossed, metres to the left of its centre.
const CROSSING_Y_M: f64 = 0.25;
/// Turn from one place of the grid to the next, parts of a whole one: the golden ratio's, by which headings never repeat.
const GRID_TURN: f64 = 0.381_966;

/// Recordings of one hall, with exact reference poses.
pub struct Recordings {
    /// Random walk.
    pub walk: Sequence,
    /// Pictures at places 30 cm apart, with all headings.
    pub grid: Sequence,
    /// Pictures along a straight line from one goal to the other.
    pub crossing: Sequence,
}

/// Makes the recordings, with so many frames of the walk.
pub fn record(folder: &Path, frames: usize) -> anyhow::Result<()> {
    let recipe = Recipe { frames, size: SIZE, exact_references: true, ..Recipe::new(SEED) };
    recipe.visit(&grid(), &folder.join("grid"))?;
    recipe.visit(&crossing(), &folder.join("crossing"))?;
    recipe.record(&folder.join("walk"))?;
    Ok(())
}

impl Recordings {
    pub fn open(folder: &Path) -> anyhow::Result<Self> {
        let open = |name| Sequence::open(&folder.join(name));
        Ok(Self { walk: open("walk")?, grid: open("grid")?, crossing: open("crossing")? })
    }
}

fn grid() -> Vec<Pose2> {
    let [columns, rows] = REACH_M.map(|reach_m| (2.0 * reach_m / GRID_M).round() as usize + 1);
    let place = |number: usize| {
        let (column, row) = (number % columns, number / columns);
        let turns = (GRID_TURN * number as f64).fract();
        Pose2::new(column as f64 * GRID_M - REACH_M[0], row as f64 * GRID_M - REACH_M[1], TAU * turns)
    };
    (0..columns * rows).map(place).collect()
}

fn crossing() -> Vec<Pose2> {
    let count = (2.0 * REACH_M[0] / CROSSING_M).round() as usize + 1;
    (0..count).map(|number| Pose2::new(number as f64 * CROSSING_M - REACH_M[0], CROSSING_Y_M, 0.0)).collect()
}
