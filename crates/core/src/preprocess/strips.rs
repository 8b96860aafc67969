//! Ground in front of the camera, in one strip per bearing: the cells of a picture, and where the carpet ends along
//! each strip.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::carpet::{CarpetColor, ColorSum};

/// Number of directions around the camera, by pseudo-angle.
pub(super) const BEARINGS: usize = 360;
/// Number of steps of the ray's sine of depression, from the horizon (0) to straight down (1).
const DEPRESSIONS: usize = 400;
/// Minimum sine of depression: flatter rays end beyond any field, about 40 camera heights away.
pub(super) const MIN_DEPRESSION: f32 = 0.025;
/// Number of carpet cells at a strip's near end from which the next strip takes its start colour.
const NEAR_CELLS: usize = 8;
/// Step between the bearings among which the best one is sought.
const LOOKED_AT_STEP: usize = 5;

/// Ray of a cell: its bearing, and the sine of its depression below the horizon.
#[derive(Clone, Copy)]
pub(super) struct GroundCell {
    pub bearing: u16,
    pub depression: f32,
}

impl GroundCell {
    /// Returns the cell of a unit ray in heading axes; `None` if the ray is too flat to meet the ground near by.
    pub fn of_ray(ray_in_heading: Vec3) -> Option<Self> {
        let depression = -ray_in_heading.z;
        (depression >= MIN_DEPRESSION)
            .then(|| Self { bearing: bearing_bin(ray_in_heading.truncate()), depression })
    }
}

/// Cells of one step along a strip.
struct Step {
    /// Bin of their sines of depression.
    bin: usize,
    /// Number of cells that show no white line.
    count: f32,
    /// Mean chromaticity of those.
    mean: [f32; 2],
}

/// Steps of every strip that show anything but white lines, from near to far.
pub(super) struct Strips(Vec<Vec<Step>>);

impl Strips {
    /// Gathers the cells of a picture; `color` returns the colour of the cell with an index.
    pub fn gather(
        cells: &[Option<GroundCell>],
        color: impl Fn(usize) -> [u8; 3] + Sync,
        carpet: &CarpetColor,
    ) -> Self {
        let by_bearing = ByBearing::sort(cells);
        let steps = |bearing: usize| {
            let mut sums = [ColorSum::default(); DEPRESSIONS];
            for &(index, bin) in by_bearing.cells(bearing) {
                sums[usize::from(bin)].add(color(index as usize), carpet);
            }
            let steps = sums.iter().enumerate().rev();
            let step =
                |(bin, sum): (usize, &ColorSum)| Some(Step { bin, count: sum.count, mean: sum.mean()? });
            steps.filter_map(step).collect()
        };
        Self((0..BEARINGS).into_par_iter().map(steps).collect())
    }

    /// Finds the sine of depression where the carpet ends along every strip. Lens and light change its colour from one
    /// side of the picture to the other: starting from the strip that shows the learned colour best, each strip begins
    /// with the colour of its neighbour.
    pub fn carpet_ends(&self, carpet: &CarpetColor) -> Vec<Option<f32>> {
        let likeness = |bearing: usize| -> f32 {
            let near = self.0[bearing].iter().filter(|step| carpet.is_near(step.mean));
            near.map(|step| step.count).sum()
        };
        let looked_at = (0..BEARINGS).step_by(LOOKED_AT_STEP).map(|bearing| (bearing, likeness(bearing)));
        let first = looked_at.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(bearing, _)| bearing);
        let mut ends = vec![None; BEARINGS];
        for side in [1, BEARINGS - 1] {
            let mut start = *carpet;
            for turn in 0..=BEARINGS / 2 {
                let bearing = (first + turn * side) % BEARINGS;
                (ends[bearing], start) = farthest_carpet(&self.0[bearing], start, carpet);
            }
        }
        ends
    }
}

/// Cells of a picture, those of one bearing after those of another, in the picture's order.
struct ByBearing {
    /// First cell of every bearing, and the end.
    first: [usize; BEARINGS + 1],
    /// Index and bin of the depression.
    cells: Vec<(u32, u16)>,
}

impl ByBearing {
    /// Sorts by counting, so that the strips are summed up each in its own few kilobytes, on all cores.
    fn sort(cells: &[Option<GroundCell>]) -> Self {
        let mut first = [0; BEARINGS + 1];
        for cell in cells.iter().flatten() {
            first[usize::from(cell.bearing) + 1] += 1;
        }
        for bearing in 0..BEARINGS {
            first[bearing + 1] += first[bearing];
        }
        let mut next = first;
        let mut sorted = vec![(0, 0); first[BEARINGS]];
        for (cell, index) in cells.iter().zip(0..) {
            if let Some(cell) = cell {
                let place = &mut next[usize::from(cell.bearing)];
                sorted[*place] = (index, depression_bin(cell.depression));
                *place += 1;
            }
        }
        Self { first, cells: sorted }
    }

    fn cells(&self, bearing: usize) -> &[(u32, u16)] {
        &self.cells[self.first[bearing]..self.first[bearing + 1]]
    }
}

/// Returns a number from 0 to 4 that grows with the angle of a direction, without trigonometry.
fn pseudo_angle(direction: Vec2) -> f32 {
    let p = direction.y / (direction.x.abs() + direction.y.abs()).max(f32::MIN_POSITIVE);
    if direction.x < 0.0 {
        2.0 - p
    } else if direction.y < 0.0 {
        4.0 + p
    } else {
        p
    }
}

fn bearing_bin(direction: Vec2) -> u16 {
    ((pseudo_angle(direction) * (BEARINGS as f32 / 4.0)) as usize).min(BEARINGS - 1) as u16
}

/// Returns the direction at the centre of a bearing's bin.
pub(super) fn bearing_direction(bin: usize) -> Vec2 {
    let p = (bin as f32 + 0.5) * 4.0 / BEARINGS as f32;
    let direction = match p {
        p if p < 1.0 => Vec2::new(1.0 - p, p),
        p if p < 2.0 => Vec2::new(1.0 - p, 2.0 - p),
        p if p < 3.0 => Vec2::new(p - 3.0, 2.0 - p),
        p => Vec2::new(p - 3.0, p - 4.0),
    };
    direction.normalize_or(Vec2::X)
}

fn depression_bin(depression: f32) -> u16 {
    ((depression * DEPRESSIONS as f32) as usize).min(DEPRESSIONS - 1) as u16
}

/// Returns the sine of depression that best divides carpet from everything else, along a strip followed from near to
/// far, and the carpet's colour at its near end. The colour that counts as carpet follows gradual changes of
/// light along the strip; a wall, a floor or a robot is a sudden change.
fn farthest_carpet(strip: &[Step], start: CarpetColor, learned: &CarpetColor) -> (Option<f32>, CarpetColor) {
    let (mut local, mut near_end) = (start, start);
    let (mut sum, mut best, mut end) = (0.0, 0.0, None);
    let mut carpet_cells = 0;
    for &Step { bin, count, mean } in strip {
        if local.is_near(mean) {
            local = local.drifted(mean, learned);
            carpet_cells += 1;
            if carpet_cells == NEAR_CELLS {
                near_end = local;
            }
            sum += count;
            if sum > best {
                (best, end) = (sum, Some(bin));
            }
        } else {
            // The robot's own shoulder may hide the near end: the carpet may begin anywhere.
            sum = (sum - count).max(0.0);
        }
    }
    (end.map(|bin| bin as f32 / DEPRESSIONS as f32), near_end)
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    #[test]
    fn bearings_are_where_their_bins_are() {
        for bin in 0..BEARINGS {
            assert_eq!(usize::from(bearing_bin(bearing_direction(bin))), bin);
        }
        let angle = |bin: usize| bearing_direction(bin).to_angle().rem_euclid(TAU);
        assert!((1..BEARINGS).all(|bin| angle(bin) > angle(bin - 1)));
    }
}
