//! Lines of the field as a pose projects them into a picture.

use glam::DVec2;

use crate::{
    camera::Camera,
    field::{FieldDimensions, VisibleSample},
    pose::CameraPose,
};

/// Maximum distance in the picture of neighbouring samples that are joined, pixels: beyond it the line is out of view or behind a
/// post in between.
const MAX_JOINT_PX: f64 = 80.0;
/// Minimum half width at which a line is expected to be found, pixels. In drawn and real pictures 84 to 88 % of the lines between
/// 1 and 1.5 px are found, 43 to 74 % between 0.3 and 0.5 px.
const LEAST_HALF_WIDTH_PX: f64 = 1.0;
/// Radius of the largest mark among the presets, metres; a mark is a cross or a spot.
const MARK_RADIUS_M: f64 = 0.12;

/// Piece of a projected line between two neighbouring samples.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from: DVec2,
    to: DVec2,
}

/// One line of the field in the picture.
#[derive(Debug, Clone)]
pub(super) struct ProjectedLine {
    pieces: Vec<Piece>,
    /// Length of what is broad enough to be found, pixels.
    pub clear_px: f64,
}

/// Piece that is nearest to a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    pub line: usize,
    pub piece: usize,
    pub distance_px: f64,
}

impl Piece {
    fn distance_squared(&self, point: DVec2) -> f64 {
        let along = self.to - self.from;
        let fraction = (point - self.from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        point.distance_squared(self.from + fraction.clamp(0.0, 1.0) * along)
    }
}

impl ProjectedLine {
    fn new(samples: &[VisibleSample]) -> Self {
        let joined =
            || samples.array_windows().filter(|[from, to]| from.pixel.distance(to.pixel) < MAX_JOINT_PX);
        let clear = joined().filter(|[from, _]| from.half_width_px >= LEAST_HALF_WIDTH_PX);
        Self {
            pieces: joined().map(|[from, to]| Piece { from: from.pixel, to: to.pixel }).collect(),
            clear_px: clear.map(|[from, to]| from.pixel.distance(to.pixel)).sum(),
        }
    }

    /// Returns the number of pieces.
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// Returns the length of a piece, pixels.
    pub fn length_px(&self, piece: usize) -> f64 {
        self.pieces.get(piece).map_or(0.0, |piece| piece.from.distance(piece.to))
    }
}

/// Joins the samples in view to lines.
pub(super) fn projected_lines(visible: &[VisibleSample]) -> Vec<ProjectedLine> {
    visible.chunk_by(|a, b| a.sample.curve == b.sample.curve).map(ProjectedLine::new).collect()
}

/// Returns the piece that is nearest to a point, if one lies within `reach_px`.
pub(super) fn nearest_piece(lines: &[ProjectedLine], point: DVec2, reach_px: f64) -> Option<Nearest> {
    let mut nearest = None;
    let mut least = reach_px * reach_px;
    for (line, projected) in lines.iter().enumerate() {
        for (piece, place) in projected.pieces.iter().enumerate() {
            let squared = place.distance_squared(point);
            if squared <= least {
                least = squared;
                nearest = Some(Nearest { line, piece, distance_px: squared.sqrt() });
            }
        }
    }
    nearest
}

/// Centre and size of a mark in the picture, pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProjectedMark {
    pub center: DVec2,
    pub radius_px: f64,
}

/// Projects the field's marks.
pub(super) fn projected_marks(
    camera: &Camera,
    field: &FieldDimensions,
    pose: CameraPose,
) -> Vec<ProjectedMark> {
    let pixel = |point: DVec2| camera.project(pose.camera_from_world(point.extend(0.0))).ok();
    let marks = field.marks().into_iter().filter_map(|mark| {
        let center = pixel(mark)?;
        let rim = [DVec2::X, DVec2::Y].map(|axis| pixel(mark + MARK_RADIUS_M * axis));
        let radius_px = rim.into_iter().flatten().map(|rim| rim.distance(center)).fold(0.0, f64::max);
        Some(ProjectedMark { center, radius_px })
    });
    marks.collect()
}
