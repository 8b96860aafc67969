//! Fills a triangle: finds the parts of pixels that it covers.

use glam::Vec3;

use super::screen::ScreenTriangle;
use crate::{
    canvas::{Canvas, Fragment, PART_OFFSETS, PARTS},
    pixel_box::PixelBox,
};

/// Area below which a triangle is a line, pixels².
const LEAST_AREA_PX2: f32 = 1e-7;
/// Tolerance of edges, pixels²: parts on the edge of two triangles belong to both, whatever the rounding. The nearer one
/// shows.
const TOLERANCE_PX2: f32 = 2e-4;

/// Value that is 0 on an edge of a triangle, above 0 inside and linear in the pixel.
#[derive(Clone, Copy)]
struct Edge {
    across: f32,
    down: f32,
    at_origin: f32,
    /// Largest change from a pixel's centre to a part of it.
    reach: f32,
}

impl Edge {
    /// `from` and `to` are given from an origin near the triangle.
    fn new(from: [f32; 2], to: [f32; 2]) -> Self {
        let (along_u, along_v) = (to[0] - from[0], to[1] - from[1]);
        Self {
            across: -along_v,
            down: along_u,
            at_origin: along_v * from[0] - along_u * from[1],
            reach: 0.5 * (along_u.abs() + along_v.abs()),
        }
    }

    /// Cuts a span of a row's pixels, from the first to the one after the last, to those of which the edge may leave a part.
    fn clipped(&self, (first, end): (f32, f32), row: f32) -> (f32, f32) {
        let rest = self.at(0.0, row) + self.reach;
        if self.across == 0.0 {
            return if rest < 0.0 { (0.0, 0.0) } else { (first, end) };
        }
        let meets = -rest / self.across;
        // A pixel more than the rounding of a pixel; the casts that follow round towards 0.
        if self.across > 0.0 { (first.max(meets - 1.0), end) } else { (first, end.min(meets + 2.0)) }
    }

    fn at(&self, u: f32, v: f32) -> f32 {
        self.at_origin + self.across * u + self.down * v
    }
}

/// Puts the fragments of a triangle on a canvas; `allowed` are the parts of pixels that it may cover.
pub(crate) fn fill(canvas: &mut Canvas, triangle: &ScreenTriangle, object: u16, allowed: u16) {
    let Some(area) = touched(canvas, triangle) else { return };
    let origin = [area.left, area.top].map(f64::from);
    let place = |corner: usize| {
        let pixel = triangle.corners[corner].pixel;
        [(pixel.x - origin[0]) as f32, (pixel.y - origin[1]) as f32]
    };
    let [a, b, c] = [place(0), place(1), place(2)];
    let double_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if double_area.is_nan() || double_area.abs() <= LEAST_AREA_PX2 {
        return;
    }
    // Each edge is opposite its corner, so that its value is the corner's weight.
    let edges = if double_area > 0.0 {
        [Edge::new(b, c), Edge::new(c, a), Edge::new(a, b)]
    } else {
        [Edge::new(c, b), Edge::new(a, c), Edge::new(b, a)]
    };
    for v in area.top..area.bottom {
        let row = (v - area.top) as f32;
        let (first, end) =
            edges.iter().fold((0.0, area.width() as f32), |span, edge| edge.clipped(span, row));
        for column in first as u32..end as u32 {
            let values = edges.map(|edge| edge.at(column as f32, row));
            let parts = allowed & covered(&edges, values);
            if parts != 0 {
                canvas.put(area.left + column, v, fragment(triangle, values, object, parts));
            }
        }
    }
}

fn touched(canvas: &Canvas, triangle: &ScreenTriangle) -> Option<PixelBox> {
    let extreme = |axis: usize, better: fn(f64, f64) -> f64| {
        let [a, b, c] = triangle.corners.map(|corner| corner.pixel[axis]);
        better(better(a, b), c)
    };
    let least = [0, 1].map(|axis| extreme(axis, f64::min));
    let most = [0, 1].map(|axis| extreme(axis, f64::max));
    PixelBox::touched(least, most, canvas.size())
}

/// Returns the parts of a pixel inside all edges, which have these values at its centre.
fn covered(edges: &[Edge; 3], values: [f32; 3]) -> u16 {
    let mut parts = Fragment::ALL;
    for (edge, value) in edges.iter().zip(values) {
        if value < -edge.reach {
            return 0;
        }
        if value < edge.reach {
            parts &= inside(edge, value);
        }
    }
    parts
}

fn inside(edge: &Edge, value: f32) -> u16 {
    let mut at = [0.0_f32; PARTS];
    for (part, at) in at.iter_mut().enumerate() {
        *at = value + edge.across * PART_OFFSETS[0][part] + edge.down * PART_OFFSETS[1][part];
    }
    at.iter().enumerate().fold(0, |parts, (part, at)| parts | u16::from(*at >= -TOLERANCE_PX2) << part)
}

/// Returns colour and distance at a pixel's centre, or at the nearest place of the triangle or so.
fn fragment(triangle: &ScreenTriangle, values: [f32; 3], object: u16, parts: u16) -> Fragment {
    let weights = values.map(|value| value.max(0.0));
    let sum = weights.iter().sum::<f32>();
    let mix = |of: [f32; 3]| of.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f32>() / sum;
    let corners = &triangle.corners;
    let color: Vec3 = corners.iter().zip(weights).map(|(corner, weight)| weight / sum * corner.color).sum();
    let distance_m = mix([0, 1, 2].map(|index| corners[index].distance_m as f32));
    Fragment { color, alpha: 1.0, distance_m, object, parts }
}
