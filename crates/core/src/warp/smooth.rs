//! Maps that are smooth inside a cell: what the nodes of a cell tell of all of its pixels, checked at sixteen more.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{
    BlendWeights, Source, Target,
    blend::{penalties, weigh},
    edges::{Edges, Meeting, post_margin},
    kernel::{FIRST_BILLBOARD, ON_SCREEN, Placement, ProxyPoints, in_camera},
    lanes::largest_of,
    proxy_geometry::ProxyGeometry,
    sampling::Taps,
};
use crate::camera::{KernelCamera, LANES, Lanes, Pixels, Places, inside_lanes, place_lanes};

/// Columns and rows of a cell's nodes.
pub(crate) const NODES: [usize; 4] = [0, 5, 10, 15];

/// Distance of the nodes, pixels.
const NODE_STEP: f32 = 5.0;

/// Columns and rows at which the polynomials are checked. What a cubic leaves out, s (s − 1) (s − 2) (s − 3) times the fourth difference,
/// is largest at 0.38 and 2.62 steps.
const CHECKED: [usize; 2] = [2, 13];

/// Number of checks along the rows of nodes; as many follow along their columns.
const CHECKS_ALONG: usize = NODES.len() * CHECKED.len();

/// Largest error along a row or a column of nodes, pixels. In between, both add up: no place is more than 0.05 px off.
const LARGEST_ERROR_PX: f32 = 0.024;

/// Part of a value's range over the nodes by which values in the cell may exceed it.
const EXCESS: f32 = 0.25;

/// What a cell's nodes tell of one source.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "eight of them on the stack")]
pub(crate) enum SourceView {
    /// It shows nothing of the cell.
    Hidden,
    /// Its pixels follow from the nodes.
    Smooth(SmoothMap),
    /// An edge may cross the cell, or the map bends too much.
    Uneven,
}

/// Bicubic polynomials for column, row and penalty of a source.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SmoothMap {
    /// For every row of nodes, the coefficients along the row: four of the column, four of the row, four of the penalty.
    node_rows: [Lanes; 4],
    /// Whether all of the cell lies inside the source's picture, where no border lowers its weight.
    is_inner: bool,
}

impl SmoothMap {
    /// Fits the polynomials.
    #[inline(always)]
    fn new(u: &Lanes, v: &Lanes, penalty: &Lanes, is_inner: bool) -> Self {
        let mut node_rows = [[0.0; LANES]; 4];
        for j in 0..4 {
            for (k, values) in [u, v, penalty].into_iter().enumerate() {
                let nodes = [values[4 * j], values[4 * j + 1], values[4 * j + 2], values[4 * j + 3]];
                let coefficients = coefficients(nodes);
                for i in 0..4 {
                    node_rows[j][4 * k + i] = coefficients[i];
                }
            }
        }
        Self { node_rows, is_inner }
    }

    /// Returns columns and rows of the source's picture for a row of the cell, pixels, and the source's penalties.
    #[inline(always)]
    pub fn places(&self, row: usize) -> [Lanes; 3] {
        let shares = &SHARES[row];
        let mut row = [0.0_f32; LANES];
        for k in 0..LANES {
            row[k] = shares[0] * self.node_rows[0][k]
                + shares[1] * self.node_rows[1][k]
                + shares[2] * self.node_rows[2][k]
                + shares[3] * self.node_rows[3][k];
        }
        [cubic(&row, 0), cubic(&row, 4), cubic(&row, 8)]
    }

    /// Returns the pixels of the source's picture around a row of the cell, and the source's weights; `None` if it shows none of it.
    #[inline(always)]
    pub fn at(&self, row: usize, source: &Source, weights: &BlendWeights) -> Option<(Taps, Lanes)> {
        let [u, v, penalty] = self.places(row);
        if self.is_inner {
            let mut weight = [0.0_f32; LANES];
            for i in 0..LANES {
                weight[i] = 1.0 / (penalty[i] * penalty[i]);
            }
            return Some((Taps::inside(source.picture, &u, &v), weight));
        }
        let mut pixels = Pixels { u, v, seen: [0.0; LANES], nearness: [0.0; LANES] };
        inside_lanes(source.camera, &mut pixels).then(|| {
            let taps = Taps::at(source.picture, &pixels.u, &pixels.v);
            (taps, weigh(source, weights, &pixels, &penalty))
        })
    }
}

/// Returns the values in a row of a cell of the polynomial with four of these coefficients.
#[inline(always)]
fn cubic(coefficients: &Lanes, first: usize) -> Lanes {
    let mut values = [0.0_f32; LANES];
    for i in 0..LANES {
        let s = i as f32 / NODE_STEP;
        values[i] = ((coefficients[first + 3] * s + coefficients[first + 2]) * s + coefficients[first + 1])
            * s
            + coefficients[first];
    }
    values
}

/// Shares of the four rows of nodes in the sixteen rows of a cell: Lagrange's polynomials.
const SHARES: [[f32; 4]; LANES] = shares();

const fn shares() -> [[f32; 4]; LANES] {
    let mut shares = [[0.0; 4]; LANES];
    let mut row = 0;
    while row < LANES {
        let mut j = 0;
        while j < 4 {
            let mut share = 1.0;
            let mut other = 0;
            while other < 4 {
                if other != j {
                    share *= (row as f32 - NODES[other] as f32) / (NODES[j] as f32 - NODES[other] as f32);
                }
                other += 1;
            }
            shares[row][j] = share;
            j += 1;
        }
        row += 1;
    }
    shares
}

/// Returns the coefficients, lowest power first, of the cubic polynomial in steps of the nodes through four values:
/// Newton's forward differences.
#[inline(always)]
fn coefficients([a, b, c, d]: [f32; 4]) -> [f32; 4] {
    let first = b - a;
    let second = c - 2.0 * b + a;
    let third = d - 3.0 * (c - b) - a;
    [a, first - second / 2.0 + third / 3.0, (second - third) / 2.0, third / 6.0]
}

/// Returns row and column of a pixel at which the polynomials are checked.
#[inline(always)]
pub(crate) const fn checked_pixel(lane: usize) -> [usize; 2] {
    let (node, checked) = (NODES[lane % CHECKS_ALONG / CHECKED.len()], CHECKED[lane % CHECKED.len()]);
    if lane < CHECKS_ALONG { [node, checked] } else { [checked, node] }
}

/// Returns whether cubic polynomials through the values at the nodes meet these values where they are checked; false if one is NaN.
#[inline(always)]
fn is_cubic(nodes: &Lanes, exact: &Lanes) -> bool {
    let mut met = 0u32;
    for lane in 0..LANES {
        let node = lane % CHECKS_ALONG / CHECKED.len();
        let shares = &SHARES[CHECKED[lane % CHECKED.len()]];
        let (first, step) = if lane < CHECKS_ALONG { (4 * node, 1) } else { (node, 4) };
        let mut value = 0.0;
        for k in 0..4 {
            value += shares[k] * nodes[first + k * step];
        }
        met += u32::from((value - exact[lane]).abs() <= LARGEST_ERROR_PX);
    }
    met as usize == LANES
}

/// Smallest and largest value over a cell, as its nodes tell.
#[inline(always)]
pub(crate) fn range(values: &Lanes) -> [f32; 2] {
    let mut negative = *values;
    for i in 0..LANES {
        negative[i] = -values[i];
    }
    let (low, high) = (-largest_of(&negative), largest_of(values));
    let excess = EXCESS * (high - low);
    [low - excess, high + excess]
}

/// Returns what the nodes tell of a source; `checks` are the points that are seen by the pixels of [`checked_pixel`].
#[inline(always)]
pub(crate) fn view(
    target: &Target,
    source: &Source,
    weights: &BlendWeights,
    points: &ProxyPoints,
    checks: &ProxyPoints,
) -> SourceView {
    match hiding(target.proxy, &source.placement, points) {
        Meeting::None => {}
        Meeting::Wholly => return SourceView::Hidden,
        Meeting::Partly => return SourceView::Uneven,
    }
    let camera = source.camera;
    let places = place_lanes(camera, &in_camera(&source.placement, points));
    let [least_cos, largest_cos] = range(&places.cos);
    if largest_cos < camera.min_cos {
        return SourceView::Hidden;
    }
    if least_cos.is_nan() || least_cos < camera.min_cos {
        return SourceView::Uneven;
    }
    let ([least_u, largest_u], [least_v, largest_v]) = (range(&places.u), range(&places.v));
    let is_beside = largest_u < 0.0 || least_u > camera.max_u || largest_v < 0.0 || least_v > camera.max_v;
    if is_beside {
        return SourceView::Hidden;
    }
    // Within it no weight fades. A pixel at least, more than the polynomials are off: places are looked up without asking again.
    let margin = (weights.border_px - 1.0).max(1.0);
    let is_inner = least_u >= margin
        && largest_u <= camera.max_u - margin
        && least_v >= margin
        && largest_v <= camera.max_v - margin
        && is_in_circle(camera, &places);
    let exact = place_lanes(camera, &in_camera(&source.placement, checks));
    if !(is_cubic(&places.u, &exact.u) && is_cubic(&places.v, &exact.v)) {
        return SourceView::Uneven;
    }
    let penalty = penalties(target, source, weights, points, &places.nearness);
    SourceView::Smooth(SmoothMap::new(&places.u, &places.v, &penalty, is_inner))
}

/// Returns whether all of a cell lies in the camera's image circle.
#[inline(always)]
fn is_in_circle(camera: &KernelCamera, places: &Places) -> bool {
    let Some([circle_u, circle_v, radius_squared]) = camera.circle else { return true };
    let mut squares = [0.0_f32; LANES];
    for i in 0..LANES {
        let (du, dv) = (places.u[i] - circle_u, places.v[i] - circle_v);
        squares[i] = du * du + dv * dv;
    }
    range(&squares)[1] <= radius_squared
}

/// Returns how much of a cell, all of it on one surface, a goal hides from a camera.
#[inline(always)]
fn hiding(proxy: &ProxyGeometry, from: &Placement, points: &ProxyPoints) -> Meeting {
    let [x, y, z] = from.position_in_world;
    let [least_x, most_x] = range(&points.place[0]);
    for (number, billboard) in proxy.billboards.iter().enumerate() {
        let at = billboard.x_m as f32;
        // The billboard stands behind the camera, or behind the whole cell, or it is what the cell shows.
        let is_own = points.surface[0] == (FIRST_BILLBOARD + number) as f32;
        if is_own || at > x.max(most_x) || at < x.min(least_x) {
            continue;
        }
        let (mut across, mut up, mut margin) = ([0.0_f32; LANES], [0.0_f32; LANES], [0.0_f32; LANES]);
        let mut before = 0u32;
        let mut behind = 0u32;
        for i in 0..LANES {
            let (dx, dy) = (points.place[0][i] - x, points.place[1][i] - y);
            let share = (at - x) / dx;
            across[i] = y + share * dy;
            up[i] = z + share * (points.place[2][i] - z);
            margin[i] = post_margin(dy / dx);
            before += u32::from(share > 0.0);
            behind += u32::from(share > 0.0 && share < ON_SCREEN);
        }
        if before == 0 {
            continue;
        }
        if (before as usize) < LANES {
            return Meeting::Partly;
        }
        match Edges::new(billboard).meeting(range(&across), range(&up), range(&margin)) {
            Meeting::None => {}
            Meeting::Wholly if behind as usize == LANES => return Meeting::Wholly,
            _ if behind == 0 && !(least_x..=most_x).contains(&at) => {}
            _ => return Meeting::Partly,
        }
    }
    Meeting::None
}
