//! Warping by cells: inside one surface, the map from the picture that is drawn to a recorded one is smooth, so it is computed
//! at sixteen pixels of every cell of 16 × 16, and interpolated between them.
//!
//! The map is a bicubic polynomial through four by four nodes. A source's third differences tell whether that is good
//! enough; where it is not, and wherever an edge may cross a cell, every pixel is computed as in [`super::blend`], of which
//! this is a faster form.

use super::{
    BlendWeights, MAX_SOURCES, Source, Target,
    blend::{draw_bands, form, say},
    kernel::{ProxyPoints, proxy_points},
    mix::{Opinions, SETTLED},
    origin::Origin,
    rays::RayBlock,
    sampling::{Taps, load},
    smooth::{NODES, SmoothMap, SourceView, is_one_surface, view},
};
use crate::camera::LANES;

/// Columns and rows of a cell.
pub(crate) const CELL: usize = LANES;

/// Rows of a cell that are drawn together: their numbers stay in the processor's nearest memory.
const ROWS: usize = 8;

/// Draws what [`super::blend_into`] draws, faster: places are looked up at most 0.05 px beside those that it finds. Both count places
/// in parts of a pixel, 256 along each axis.
///
/// # Panics
///
/// If there is not one colour for every pixel of the target.
pub fn blend_cells_into(
    target: &Target,
    sources: &[Source],
    weights: &BlendWeights,
    colors: &mut [[u8; 3]],
) -> Vec<Origin> {
    draw_bands(target, sources, colors, CELL, |sources, top, colors, origins| {
        blend_band(target, sources, weights, top, colors, origins);
    })
}

/// Draws a row of cells whose first row of pixels is `top`.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn blend_band(
    target: &Target,
    sources: &[Source],
    weights: &BlendWeights,
    top: usize,
    colors: &mut [[u8; 3]],
    origins: &mut [Origin],
) {
    let width = target.rays.width as usize;
    let rows = colors.len() / width;
    let mut opinions = [Opinions::NONE; ROWS];
    for column in 0..width.div_ceil(CELL) {
        let cell = Cell::new(target, sources, weights, column, top, rows);
        let (first, end) = (column * CELL, width.min((column + 1) * CELL));
        for start in (0..rows).step_by(ROWS) {
            let opinions = &mut opinions[..ROWS.min(rows - start)];
            cell.ask(start, opinions);
            for (row, opinions) in opinions.iter_mut().enumerate() {
                let from = (start + row) * width;
                let pixels = from + first..from + end;
                opinions
                    .mixed(sources.len(), weights, SETTLED)
                    .write(&mut colors[pixels.clone()], &mut origins[pixels]);
            }
        }
    }
}

/// Cell with what is known of it from its nodes.
struct Cell<'a> {
    target: &'a Target<'a>,
    sources: &'a [Source<'a>],
    weights: &'a BlendWeights,
    /// Column of the cell, in cells.
    column: usize,
    /// First row, in pixels.
    top: usize,
    views: [SourceView; MAX_SOURCES],
    /// Whether some source is looked up pixel by pixel.
    is_uneven: bool,
}

impl<'a> Cell<'a> {
    #[inline(always)]
    fn new(
        target: &'a Target<'a>,
        sources: &'a [Source<'a>],
        weights: &'a BlendWeights,
        column: usize,
        top: usize,
        rows: usize,
    ) -> Self {
        let mut views = [SourceView::Uneven; MAX_SOURCES];
        let is_whole = rows == CELL && (column + 1) * CELL <= target.rays.width as usize;
        if is_whole {
            let nodes = node_rays(target, column, top);
            let points = proxy_points(target.proxy, &target.placement, &nodes);
            if is_one_surface(target, &points) {
                for (found, source) in views.iter_mut().zip(sources) {
                    *found = view(target, source, weights, &points);
                }
            }
        }
        let is_uneven = views[..sources.len()].iter().any(|view| matches!(view, SourceView::Uneven));
        Self { target, sources, weights, column, top, views, is_uneven }
    }

    /// Asks the sources what they show of some rows.
    #[inline(always)]
    fn ask(&self, start: usize, rows: &mut [Opinions]) {
        for row in rows.iter_mut() {
            row.clear();
        }
        for (number, (source, view)) in self.sources.iter().zip(&self.views).enumerate() {
            if let SourceView::Smooth(map) = view {
                self.form_smooth(number, source, map, start, rows);
            }
        }
        if !self.is_uneven {
            return;
        }
        for (row, opinions) in rows.iter_mut().enumerate() {
            let points = self.points(start + row);
            for (number, (source, view)) in self.sources.iter().zip(&self.views).enumerate() {
                // A closure would not be compiled for the processor's vectors.
                if matches!(view, SourceView::Uneven)
                    && form(opinions.next(number), self.target, source, self.weights, &points)
                {
                    opinions.keep();
                }
            }
        }
    }

    /// Forms the opinions of a source whose pixels follow from the nodes.
    #[inline(always)]
    fn form_smooth(
        &self,
        number: usize,
        source: &Source,
        map: &SmoothMap,
        start: usize,
        rows: &mut [Opinions],
    ) {
        let mut taps = [Taps::NONE; ROWS];
        let mut priors = [[0.0_f32; LANES]; ROWS];
        let mut is_seen = [false; ROWS];
        for row in 0..rows.len() {
            if let Some((found, weights)) = map.at(start + row, source, self.weights) {
                is_seen[row] = true;
                taps[row] = found;
                priors[row] = weights;
            }
        }
        load(source.picture, &mut taps[..rows.len()]);
        for (row, opinions) in rows.iter_mut().enumerate() {
            if is_seen[row] {
                say(opinions.next(number), source, &taps[row].samples(), &priors[row]);
                opinions.keep();
            }
        }
    }

    /// Returns the points that sixteen pixels of a row see.
    #[inline(always)]
    fn points(&self, row: usize) -> ProxyPoints {
        let rays = &self.target.rays.row(self.top + row)[self.column];
        proxy_points(self.target.proxy, &self.target.placement, rays)
    }
}

/// Returns the rays of a cell's nodes, row by row.
#[inline(always)]
fn node_rays(target: &Target, column: usize, top: usize) -> RayBlock {
    let mut nodes = [[0.0; LANES]; 3];
    for (j, v) in NODES.into_iter().enumerate() {
        let block = &target.rays.row(top + v)[column];
        for (i, u) in NODES.into_iter().enumerate() {
            for axis in 0..3 {
                nodes[axis][4 * j + i] = block[axis][u];
            }
        }
    }
    nodes
}

#[cfg(test)]
mod tests;
