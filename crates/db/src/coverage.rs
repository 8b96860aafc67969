//! Coverage of the field: where pictures were taken, in which directions, and how far any pose is from the nearest one.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::{
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
};

use crate::index::PoseIndex;

/// Number of headings that are distinguished.
pub const HEADINGS: usize = 8;

/// Distance from which on all distances have the same colour, pixels.
pub const FAR_PX: f64 = 300.0;

/// Returns the colour for a share in pictures of the coverage, sRGB: from nearly white (0) over green to dark blue (1).
/// Lightness falls all the way, so that any kind of colour vision can read it.
pub fn shade_srgb(share: f64) -> [u8; 3] {
    const STOPS: [[f64; 3]; 4] =
        [[247.0, 247.0, 240.0], [161.0, 214.0, 170.0], [42.0, 140.0, 150.0], [20.0, 50.0, 110.0]];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let first = (place.floor() as usize).min(STOPS.len() - 2);
    let part = place - first as f64;
    std::array::from_fn(|i| (STOPS[first][i] + part * (STOPS[first + 1][i] - STOPS[first][i])).round() as u8)
}

/// Coverage of one cell of the carpet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverageCell {
    /// Centre of the cell in the world frame, metres.
    pub middle_in_world: DVec2,
    /// Number of pictures taken in the cell, by heading: 0 looks along +x, then counter-clockwise.
    pub pictures: [u32; HEADINGS],
    /// Distance from the cell's centre to the nearest picture, by heading, root mean square pixels.
    pub distance_px: [f64; HEADINGS],
}

impl CoverageCell {
    /// Number of pictures taken in the cell.
    pub fn count(&self) -> u32 {
        self.pictures.iter().sum()
    }

    /// Distance to the nearest picture, averaged over the headings, root mean square pixels.
    pub fn mean_distance_px(&self) -> f64 {
        self.distance_px.iter().sum::<f64>() / HEADINGS as f64
    }
}

/// Coverage of the carpet in square cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// Side of a cell, metres.
    pub cell_m: f64,
    /// Number of cells along x and along y.
    pub size: [usize; 2],
    /// Cells by rows of equal y; rows in the order of y, cells of a row in the order of x.
    pub cells: Vec<CoverageCell>,
}

/// Number of cells along one side that can be computed and shown without delay.
const MOST_CELLS_ALONG: f64 = 64.0;

impl Coverage {
    /// Computes the coverage of a field's carpet in cells of about this size, metres. Distances are those for a camera at
    /// this height, pitch and roll. Pictures taken beside the carpet count in no cell.
    pub fn new(index: &PoseIndex, field: &FieldDimensions, usual: CameraPose, cell_m: f64) -> Self {
        let grid = Grid::new(index, field, cell_m);
        let cells = grid.numbers().map(|number| grid.cell(index, usual, number)).collect();
        grid.coverage(cells)
    }

    /// Works like [`Coverage::new`] while `goes_on` returns true; it is asked before every cell. `None` once it returns
    /// false.
    pub fn new_while(
        index: &PoseIndex,
        field: &FieldDimensions,
        usual: CameraPose,
        cell_m: f64,
        goes_on: impl Fn() -> bool + Sync,
    ) -> Option<Self> {
        let grid = Grid::new(index, field, cell_m);
        let cell = |number| goes_on().then(|| grid.cell(index, usual, number));
        let cells: Option<Vec<_>> = grid.numbers().map(cell).collect();
        Some(grid.coverage(cells?))
    }

    /// Share of all places and headings with a picture nearer than this, root mean square pixels.
    pub fn share_within(&self, distance_px: f64) -> f64 {
        let near = self.cells.iter().flat_map(|cell| cell.distance_px).filter(|found| *found < distance_px);
        near.count() as f64 / (HEADINGS * self.cells.len()) as f64
    }
}

/// Grid of cells, and the pictures taken in each.
struct Grid {
    cell_m: f64,
    size: [usize; 2],
    /// Corner with the smallest x and y in the world frame, metres.
    corner: DVec2,
    counts: Vec<[u32; HEADINGS]>,
}

impl Grid {
    fn new(index: &PoseIndex, field: &FieldDimensions, cell_m: f64) -> Self {
        let half = field.carpet_half_extent_m();
        let cell_m = cell_m.max(2.0 * half.max_element() / MOST_CELLS_ALONG);
        let size = (2.0 * half / cell_m).ceil().max(DVec2::ONE);
        let (corner, size) = (-0.5 * cell_m * size, [size.x as usize, size.y as usize]);
        let mut counts = vec![[0_u32; HEADINGS]; size[0] * size[1]];
        for pose in index.poses() {
            let cell = ((DVec2::new(pose.x_m, pose.y_m) - corner) / cell_m).floor();
            let is_inside =
                cell.cmpge(DVec2::ZERO).all() && cell.x < size[0] as f64 && cell.y < size[1] as f64;
            if is_inside {
                counts[cell.y as usize * size[0] + cell.x as usize][heading_of(pose.yaw_rad)] += 1;
            }
        }
        Self { cell_m, size, corner, counts }
    }

    fn numbers(&self) -> rayon::range::Iter<usize> {
        (0..self.counts.len()).into_par_iter()
    }

    fn cell(&self, index: &PoseIndex, usual: CameraPose, number: usize) -> CoverageCell {
        let along = self.size[0];
        let place = DVec2::new((number % along) as f64, (number / along) as f64);
        let middle_in_world = self.corner + self.cell_m * (place + 0.5);
        let distance_px = std::array::from_fn(|heading| {
            let yaw_rad = TAU * heading as f64 / HEADINGS as f64;
            let pose = usual.with_planar(Pose2::new(middle_in_world.x, middle_in_world.y, yaw_rad));
            index.nearest(pose, 1).map_or(f64::INFINITY, |nearest| nearest[0].distance_px)
        });
        CoverageCell { middle_in_world, pictures: self.counts[number], distance_px }
    }

    fn coverage(self, cells: Vec<CoverageCell>) -> Coverage {
        Coverage { cell_m: self.cell_m, size: self.size, cells }
    }
}

fn heading_of(yaw_rad: f64) -> usize {
    ((yaw_rad / TAU).rem_euclid(1.0) * HEADINGS as f64).round() as usize % HEADINGS
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use reality_sim_core::camera::{Camera, Distortion};

    use super::*;
    use crate::metric::PixelMetric;

    fn usual() -> CameraPose {
        CameraPose { height_m: 0.5, pitch_rad: 0.4, ..Default::default() }
    }

    fn index(field: &FieldDimensions, poses: Vec<CameraPose>) -> PoseIndex {
        let camera = Camera::new([640, 480], [215.0, 215.0, 319.5, 239.5], Distortion::Pinhole).unwrap();
        PoseIndex::new(PixelMetric::new(&camera, usual(), field).unwrap(), poses)
    }

    #[test]
    fn as_long_as_it_goes_on_the_coverage_is_the_same_and_then_it_stops_before_the_next_cells() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let index = index(&field, vec![usual()]);
        let whole = Coverage::new(&index, &field, usual(), 0.25);
        assert_eq!(Coverage::new_while(&index, &field, usual(), 0.25, || true).as_ref(), Some(&whole));
        let asked = AtomicUsize::new(0);
        let stopped =
            Coverage::new_while(&index, &field, usual(), 0.25, || asked.fetch_add(1, Ordering::Relaxed) < 3);
        assert_eq!(stopped, None);
        assert!(asked.into_inner() < whole.cells.len());
    }

    #[test]
    fn every_picture_on_the_carpet_is_counted_where_it_was_taken_and_where_it_looks() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let usual = usual();
        let pose = |x, y, yaw| usual.with_planar(Pose2::new(x, y, yaw));
        let poses = vec![
            pose(1.05, 0.6, 0.1),
            pose(1.05, 0.6, -0.1),
            pose(-2.05, -1.1, 3.1),
            pose(-2.05, -1.1, -3.1),
            pose(90.0, 0.0, 0.0),
        ];
        let index = index(&field, poses);
        let coverage = Coverage::new(&index, &field, usual, 0.25);
        assert_eq!(coverage.cells.iter().map(CoverageCell::count).sum::<u32>(), 4, "one was taken outside");
        let cell_at = |x: f64, y: f64| {
            let near = |cell: &&CoverageCell| {
                (cell.middle_in_world - DVec2::new(x, y)).abs().max_element() <= 0.5 * coverage.cell_m
            };
            *coverage.cells.iter().find(near).unwrap()
        };
        assert_eq!(cell_at(1.05, 0.6).pictures[0], 2);
        assert_eq!(cell_at(-2.05, -1.1).pictures[HEADINGS / 2], 2);
        assert!(cell_at(1.05, 0.6).distance_px[0] < cell_at(1.05, 0.6).distance_px[4]);
        assert!(coverage.share_within(1e9) == 1.0 && coverage.share_within(0.0) == 0.0);
    }
}
