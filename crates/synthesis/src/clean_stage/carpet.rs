//! What a carpet usually looks like, place by place: by it, votes for things that stand still are told from votes for the ground.

use glam::DVec2;
use reality_sim_core::{
    field::{Curve, FieldDimensions, MARK_HALF_SIDE_M},
    statistics::{median, robust_sigma},
};

use super::grid::Grid;

/// Side of the tiles in which the carpet has one usual colour, metres.
const TILE_M: f64 = 0.5;
/// Tiles around one whose colours count for it: 2.5 m, more than half of which no thing covers.
const AROUND: i64 = 2;
/// Colours of the carpet's texture, in its standard deviations.
const SIGMAS: f64 = 4.0;
/// Smallest tolerance, grey levels: noise and changes of the light, where the carpet has no texture.
const LEAST_TOLERANCE: f32 = 20.0;
/// Distance from a line's edge up to which paint may show, metres: blur, and errors of poses.
const BESIDE_LINE_M: f64 = 0.04;

/// Usual colours of a carpet.
pub(super) struct Carpet {
    tiles: Grid,
    /// Usual colour of each tile.
    colors: Vec<[f32; 3]>,
    /// Differences from them that the carpet's texture makes.
    tolerance: [f32; 3],
    curves: Vec<Curve>,
    marks: [DVec2; 3],
    half_line_m: f64,
}

impl Carpet {
    /// Finds the usual colours from those of cells, of which most show carpet; `None` if no cell has a colour.
    pub fn new(field: &FieldDimensions, cells: &Grid, found: &[Option<[f32; 3]>]) -> Option<Self> {
        let tiles = Grid::of_carpet(field, TILE_M);
        let mut members: Vec<Vec<[f32; 3]>> = vec![Vec::new(); tiles.len()];
        for (cell, color) in found.iter().enumerate() {
            if let (Some(color), Some(tile)) = (color, tiles.cell_at(cells.center_m(cell))) {
                members[tile].push(*color);
            }
        }
        let all = median_color(members.iter().flatten())?;
        let colors: Vec<[f32; 3]> = (0..tiles.len())
            .map(|tile| median_color(around(&tiles, tile).flat_map(|near| &members[near])).unwrap_or(all))
            .collect();
        let tolerance = [0, 1, 2].map(|channel| {
            let differences = members.iter().zip(&colors).flat_map(|(members, usual)| {
                members.iter().map(|color| f64::from(color[channel] - usual[channel]))
            });
            ((SIGMAS * robust_sigma(differences)) as f32).max(LEAST_TOLERANCE)
        });
        let half_line_m = field.line_width_m / 2.0;
        Some(Self { tiles, colors, tolerance, curves: field.curves(), marks: field.marks(), half_line_m })
    }

    /// Returns whether there may be paint at a point.
    pub fn may_be_painted(&self, point_m: DVec2) -> bool {
        let near_m = self.half_line_m + BESIDE_LINE_M;
        let on_mark = |mark: &DVec2| (point_m - mark).abs().max_element() <= MARK_HALF_SIDE_M + BESIDE_LINE_M;
        self.curves.iter().any(|curve| curve.distance_m(point_m) <= near_m) || self.marks.iter().any(on_mark)
    }

    /// Returns whether the ground at a point may have a colour: that of the carpet, or a brighter one where there may be paint.
    pub fn is_plausible(&self, point_m: DVec2, may_be_painted: bool, color: [f32; 3]) -> bool {
        let Some(tile) = self.tiles.cell_at(point_m) else { return false };
        let usual = self.colors[tile];
        (0..3).all(|channel| {
            let difference = color[channel] - usual[channel];
            difference >= -self.tolerance[channel]
                && (may_be_painted || difference <= self.tolerance[channel])
        })
    }
}

/// Returns the tiles around one, itself included.
fn around(tiles: &Grid, tile: usize) -> impl Iterator<Item = usize> {
    let (width, height) = (tiles.width as i64, tiles.height as i64);
    let [column, row] = [tile as i64 % width, tile as i64 / width];
    let rows = (row - AROUND).max(0)..(row + AROUND + 1).min(height);
    rows.flat_map(move |row| {
        ((column - AROUND).max(0)..(column + AROUND + 1).min(width))
            .map(move |column| (row * width + column) as usize)
    })
}

fn median_color<'a>(colors: impl Iterator<Item = &'a [f32; 3]>) -> Option<[f32; 3]> {
    let colors: Vec<&[f32; 3]> = colors.collect();
    let channel = |channel: usize| median(colors.iter().map(|color| f64::from(color[channel]))) as f32;
    (!colors.is_empty()).then(|| [channel(0), channel(1), channel(2)])
}
