//! Warping by cells: inside one surface, the map from the picture that is drawn to a recorded one is smooth, so it is computed
//! at sixteen pixels of every cell of 16 × 16, and interpolated between them.
//!
//! The map is a bicubic polynomial through four by four nodes. Sixteen pixels in between tell whether that is good
//! enough. Where borders of surfaces cross a cell, it has one map for each of them. Where maps are no polynomials, and wherever
//! something may hide part of a cell from a source, every pixel is computed as in [`super::blend`], of which this is a faster
//! form.

use super::{
    BlendWeights, MAX_SOURCES, Source, Target,
    blend::{draw_bands, form, say},
    faces::{Faces, MOST_FACES, on_face},
    kernel::{ProxyPoints, directions, proxy_points},
    mix::{Opinions, SETTLED},
    origin::Origin,
    rays::RayBlock,
    sampling::{Taps, load},
    smooth::{self, NODES, SmoothMap, SourceView},
};
use crate::camera::{LANES, Lanes};

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
    /// Surfaces that it may show; `None` where every pixel is computed.
    faces: Option<Faces>,
    /// What the nodes tell of each source, on each of the surfaces.
    views: [[SourceView; MAX_SOURCES]; MOST_FACES],
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
        let views = [[SourceView::Uneven; MAX_SOURCES]; MOST_FACES];
        let mut cell = Self { target, sources, weights, column, top, faces: None, views };
        let is_whole = rows == CELL && (column + 1) * CELL <= target.rays.width as usize;
        if is_whole {
            let nodes = rays_of(target, column, top, |lane| [NODES[lane / 4], NODES[lane % 4]]);
            let checks = rays_of(target, column, top, smooth::checked_pixel);
            cell.ask_nodes(&proxy_points(target.proxy, &target.placement, &nodes), &checks);
        }
        cell
    }

    #[inline(always)]
    fn ask_nodes(&mut self, nodes: &ProxyPoints, checks: &RayBlock) {
        self.faces = Faces::new(self.target, nodes);
        let Some(faces) = &self.faces else { return };
        let checks = directions(&self.target.placement, checks);
        for (views, &face) in self.views.iter_mut().zip(faces.all()) {
            let on_face = |directions| on_face(self.target.proxy, &self.target.placement, directions, face);
            let (Some(points), Some(checks)) = (on_face(&nodes.direction), on_face(&checks)) else {
                continue;
            };
            for (view, source) in views.iter_mut().zip(self.sources) {
                *view = smooth::view(self.target, source, self.weights, &points, &checks);
            }
        }
    }

    /// Asks the sources what they show of some rows.
    #[inline(always)]
    fn ask(&self, start: usize, rows: &mut [Opinions]) {
        for row in rows.iter_mut() {
            row.clear();
        }
        match &self.faces {
            Some(faces) if faces.all().len() == 1 => self.ask_of_one_face(start, rows),
            Some(faces) => self.ask_of_faces(faces, start, rows),
            None => {
                for (row, opinions) in rows.iter_mut().enumerate() {
                    let points = self.points(start + row);
                    for number in 0..self.sources.len() {
                        self.form(number, &points, opinions);
                    }
                }
            }
        }
    }

    /// Asks of a cell that shows one surface.
    #[inline(always)]
    fn ask_of_one_face(&self, start: usize, rows: &mut [Opinions]) {
        let mut is_uneven = false;
        for (number, view) in self.views[0][..self.sources.len()].iter().enumerate() {
            match view {
                SourceView::Hidden => {}
                SourceView::Smooth(map) => self.form_smooth(number, map, start, rows),
                SourceView::Uneven => is_uneven = true,
            }
        }
        if !is_uneven {
            return;
        }
        for (row, opinions) in rows.iter_mut().enumerate() {
            let points = self.points(start + row);
            for number in 0..self.sources.len() {
                if self.is_uneven(number) {
                    self.form(number, &points, opinions);
                }
            }
        }
    }

    /// Asks of a cell across which the borders of surfaces run: every pixel follows from the map of the surface that it sees.
    #[inline(always)]
    fn ask_of_faces(&self, faces: &Faces, start: usize, rows: &mut [Opinions]) {
        for (row, opinions) in rows.iter_mut().enumerate() {
            let points = self.points(start + row);
            // A corner of yet another surface may lie between the nodes.
            let is_known = faces.hold(&points.surface);
            for number in 0..self.sources.len() {
                if is_known && !self.is_uneven(number) {
                    self.form_by_faces(number, faces, start + row, &points.surface, opinions);
                } else {
                    self.form(number, &points, opinions);
                }
            }
        }
    }

    /// Returns whether a source is looked up pixel by pixel.
    #[inline(always)]
    fn is_uneven(&self, number: usize) -> bool {
        let count = self.faces.as_ref().map_or(MOST_FACES, |faces| faces.all().len());
        self.views[..count].iter().any(|views| matches!(views[number], SourceView::Uneven))
    }

    /// Forms the opinion of a source on sixteen points.
    #[inline(always)]
    fn form(&self, number: usize, points: &ProxyPoints, opinions: &mut Opinions) {
        if form(opinions.next(number), self.target, &self.sources[number], self.weights, points) {
            opinions.keep();
        }
    }

    /// Forms the opinions of a source whose pixels follow from the nodes.
    #[inline(always)]
    fn form_smooth(&self, number: usize, map: &SmoothMap, start: usize, rows: &mut [Opinions]) {
        let source = &self.sources[number];
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

    /// Forms the opinion of a source on a row of pixels, each of which follows from the nodes on its own surface.
    #[inline(always)]
    fn form_by_faces(
        &self,
        number: usize,
        faces: &Faces,
        row: usize,
        surfaces: &Lanes,
        opinions: &mut Opinions,
    ) {
        let source = &self.sources[number];
        let (mut taps, mut priors) = ([Taps::NONE], [0.0_f32; LANES]);
        let mut is_seen = false;
        for (views, &face) in self.views.iter().zip(faces.all()) {
            let SourceView::Smooth(map) = &views[number] else { continue };
            if let Some((found, weights)) = map.at(row, source, self.weights) {
                is_seen = true;
                taps[0].take(&found, surfaces, face);
                for i in 0..LANES {
                    priors[i] = if surfaces[i] == face { weights[i] } else { priors[i] };
                }
            }
        }
        if is_seen {
            load(source.picture, &mut taps);
            say(opinions.next(number), source, &taps[0].samples(), &priors);
            opinions.keep();
        }
    }

    /// Returns the points that sixteen pixels of a row see.
    #[inline(always)]
    fn points(&self, row: usize) -> ProxyPoints {
        let rays = &self.target.rays.row(self.top + row)[self.column];
        proxy_points(self.target.proxy, &self.target.placement, rays)
    }
}

/// Returns the rays of sixteen of a cell's pixels, given by row and column in it.
#[inline(always)]
fn rays_of(target: &Target, column: usize, top: usize, pixel: impl Fn(usize) -> [usize; 2]) -> RayBlock {
    let mut rays = [[0.0; LANES]; 3];
    for (axis, values) in rays.iter_mut().enumerate() {
        for (lane, value) in values.iter_mut().enumerate() {
            let [row, u] = pixel(lane);
            *value = target.rays.row(top + row)[column][axis][u];
        }
    }
    rays
}

#[cfg(test)]
mod tests;
