//! What a picture would show of the empty ground.

use glam::{Vec2, Vec3};
use reality_sim_core::{
    camera::LANES,
    warp::{ProxyGeometry, Surface, Target},
};

use super::{goal_volumes::GoalVolumes, mosaic::Mosaic};
use crate::shrunk::ShrunkPicture;

/// Colours of the ground, averaged over cells of twice, four times and so on the size.
pub(super) struct GroundPyramid {
    levels: Vec<Level>,
    min_m: Vec2,
    cell_m: f32,
}

struct Level {
    width: usize,
    height: usize,
    /// Red, green, blue, and the share of the cells that are known.
    cells: Vec<[f32; 4]>,
}

/// What a pixel would show of the empty ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Expected {
    /// This colour.
    Color([f32; 3]),
    /// Ground on which something always stood.
    NeverEmpty,
    /// Ground that nothing is known of.
    Unknown,
    /// Something that is no ground, or lies behind a goal.
    NoGround,
}

/// Picture of the empty ground.
pub(super) struct Predicted {
    pub width: usize,
    pub pixels: Vec<Expected>,
    /// Points of the proxy geometry that the pixels see, metres; NaN where a pixel sees nothing.
    pub points: Vec<Vec3>,
}

/// Smallest share of known cells at which a colour is one.
const KNOWN: f32 = 0.5;

impl GroundPyramid {
    /// Averages the cells of a mosaic.
    pub fn new(mosaic: &Mosaic) -> Self {
        let grid = &mosaic.grid;
        let cell = |cell: usize| match mosaic.cells[cell] {
            Some(found) if !mosaic.never_empty[cell] => {
                let [red, green, blue] = found.color;
                [red, green, blue, 1.0]
            }
            _ => [0.0; 4],
        };
        let cells = (0..grid.len()).map(cell).collect();
        let mut levels = vec![Level { width: grid.width, height: grid.height, cells }];
        while let Some(level) = levels.last()
            && level.width.min(level.height) > 1
        {
            let coarser = level.halved();
            levels.push(coarser);
        }
        Self { levels, min_m: grid.min_m.as_vec2(), cell_m: grid.cell_m as f32 }
    }

    /// Returns the colour of a patch of this width around a point; `None` where too little of it is known.
    fn color(&self, point_m: Vec2, width_m: f32) -> Option<[f32; 3]> {
        let finest = (width_m / self.cell_m).max(1.0).log2().round() as usize;
        let number = finest.min(self.levels.len() - 1);
        let level = &self.levels[number];
        let place = (point_m - self.min_m) / (self.cell_m * (1 << number) as f32) - 0.5;
        let [red, green, blue, known] = level.bilinear(place);
        (known >= KNOWN).then(|| [red / known, green / known, blue / known])
    }
}

impl Level {
    /// Returns the level with half as many columns and rows; colours are weighed by how much of them is known.
    fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut cells = vec![[0.0_f32; 4]; width * height];
        for (row, line) in self.cells.chunks(self.width).enumerate() {
            for (column, cell) in line.iter().enumerate() {
                let sum = &mut cells[row / 2 * width + column / 2];
                sum.iter_mut().zip(cell).for_each(|(sum, value)| *sum += 0.25 * value);
            }
        }
        Self { width, height, cells }
    }

    /// Interpolates between cells, whose centres have whole coordinates.
    fn bilinear(&self, place: Vec2) -> [f32; 4] {
        let last = Vec2::new(self.width as f32 - 1.0, self.height as f32 - 1.0);
        let place = place.clamp(Vec2::ZERO, last);
        let first = place.floor().min((last - 1.0).max(Vec2::ZERO));
        let beside = place - first;
        let cell = |column: usize, row: usize| {
            let (column, row) = (column.min(self.width - 1), row.min(self.height - 1));
            self.cells[row * self.width + column]
        };
        let (column, row) = (first.x as usize, first.y as usize);
        let taps = [
            (cell(column, row), (1.0 - beside.x) * (1.0 - beside.y)),
            (cell(column + 1, row), beside.x * (1.0 - beside.y)),
            (cell(column, row + 1), (1.0 - beside.x) * beside.y),
            (cell(column + 1, row + 1), beside.x * beside.y),
        ];
        let mut sum = [0.0; 4];
        for (tap, share) in taps {
            sum.iter_mut().zip(tap).for_each(|(sum, value)| *sum += share * value);
        }
        sum
    }
}

/// Draws what a picture would show of the empty ground.
pub(super) fn predict(
    picture: &ShrunkPicture,
    mosaic: &Mosaic,
    pyramid: &GroundPyramid,
    proxy: &ProxyGeometry,
    goals: &GoalVolumes,
) -> Predicted {
    let camera = &picture.camera.camera;
    let target = Target { rays: &picture.camera.rays, placement: picture.placement, proxy };
    let eye = Vec3::from_array(picture.placement.position_in_world);
    let focal_px = picture.camera.kernel.fy;
    let width = camera.width as usize;
    let mut pixels = Vec::with_capacity(width * camera.height as usize);
    let mut points = Vec::with_capacity(pixels.capacity());
    for row in 0..camera.height as usize {
        for block in 0..width.div_ceil(LANES) {
            let seen = target.surfaces(row, block);
            for lane in 0..LANES.min(width - block * LANES) {
                let [x, y, z] = seen.point_in_world.map(|axis| axis[lane]);
                let point_m = Vec2::new(x, y);
                points.push(Vec3::new(x, y, z));
                let cell = mosaic.grid.cell_at(point_m.as_dvec2());
                pixels.push(match (seen.surface[lane], cell) {
                    (Surface::Ground, Some(_)) if goals.hide(eye, Vec3::new(x, y, z)) => Expected::NoGround,
                    (Surface::Ground, Some(cell)) if mosaic.never_empty[cell] => Expected::NeverEmpty,
                    (Surface::Ground, Some(_)) => {
                        let distance_m = seen.distance_m[lane];
                        // The patch of a pixel is as wide as its geometric mean: it is deeper than wide by distance over height.
                        let width_m = distance_m / focal_px * (distance_m / eye.z).sqrt();
                        pyramid.color(point_m, width_m).map_or(Expected::Unknown, Expected::Color)
                    }
                    _ => Expected::NoGround,
                });
            }
        }
    }
    Predicted { width, pixels, points }
}
