//! Parts of things that stand out over the carpet: what stands on a masked place goes on upwards, in front of walls and goals.
//!
//! There the ground tells nothing, so that the picture is compared with what others, taken elsewhere, show of the hall. Their geometry
//! is a guess there: only what stands over the foot of a thing is compared.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use reality_sim_core::warp::{
    BlendWeights, CpuWarper, Look, Placement, ProxyGeometry, Source, Target, Warper,
};

use super::{
    blobs::Bits,
    differences::beyond_range,
    predicted::{Expected, Predicted},
};
use crate::{select::select, shrunk::ShrunkPicture};

/// Height of things above the carpet, metres: that of people.
const TALLEST_M: f32 = 1.9;
/// Distance by which things may be wider above their feet, metres.
const OVERHANG_M: f32 = 0.25;
/// Smallest distance of pictures that show the hall, metres: from the same place, a thing hides the same wall.
const BASELINE_M: f32 = 0.5;
/// Number of pictures that show the hall.
const SOURCES: usize = 6;
/// Difference from the hall beyond which a pixel shows something else, grey levels: three times that of the carpet, as the geometry is
/// a guess.
const DIFFERS: f32 = 30.0;
/// Distance within which the hall may be displaced, pixels.
const REACH_PX: usize = 2;
/// Share of the ground distances of a thing's pixels below which its foot stands.
const FOOT: f32 = 0.1;
/// Distance up to which gaps in a thing are closed, pixels.
const CLOSED_PX: usize = 2;

/// Column of space above the foot of a thing, as a camera sees it.
struct Column {
    /// Heading of its middle, radians.
    heading_rad: f32,
    half_width_rad: f32,
    distance_m: f32,
}

/// Adds the parts that stand out over the carpet to the things that stand on it.
pub(super) fn with_upper_parts(
    picture: &ShrunkPicture,
    predicted: &Predicted,
    things: Bits,
    others: &[ShrunkPicture],
    proxy: &ProxyGeometry,
) -> Bits {
    let eye = Vec3::from_array(picture.placement.position_in_world);
    let is_open =
        |pixel: usize| !matches!(predicted.pixels[pixel], Expected::Color(_) | Expected::NeverEmpty);
    let near_edge = Bits::new(things.width, (0..things.pixels.len()).map(is_open).collect()).dilated(2);
    let patches = things.patches().into_iter();
    let patches = patches.filter(|patch| patch.iter().any(|pixel| near_edge.pixels[*pixel]));
    let columns: Vec<Column> = patches.map(|patch| Column::above(&patch, predicted, eye)).collect();
    if columns.is_empty() {
        return things;
    }
    let Some(hall) = hall(picture, others, proxy) else { return things };
    let differs = beyond_range(picture, &hall, things.width, REACH_PX);
    let mut found = things.clone();
    let mut open: Vec<usize> = (0..things.pixels.len()).filter(|pixel| things.pixels[*pixel]).collect();
    let height = things.pixels.len() / things.width;
    while let Some(pixel) = open.pop() {
        let (row, column) = (pixel / things.width, pixel % things.width);
        for row in row.saturating_sub(1)..height.min(row + 2) {
            for column in column.saturating_sub(1)..things.width.min(column + 2) {
                let near = row * things.width + column;
                if !found.pixels[near]
                    && is_open(near)
                    && differs[near].is_some_and(|differs| differs > DIFFERS)
                    && columns.iter().any(|column| column.holds(predicted.points[near], eye))
                {
                    found.pixels[near] = true;
                    open.push(near);
                }
            }
        }
    }
    let raised = found.dilated(CLOSED_PX + 1).eroded(CLOSED_PX);
    // On the carpet nothing is added.
    let pixels = raised.pixels.iter().enumerate();
    let pixels = pixels.map(|(pixel, is_raised)| things.pixels[pixel] || *is_raised && is_open(pixel));
    Bits::new(things.width, pixels.collect())
}

impl Column {
    /// Returns the column above the nearest part of a patch.
    fn above(patch: &[usize], predicted: &Predicted, eye: Vec3) -> Self {
        let away: Vec<Vec2> = patch.iter().map(|pixel| (predicted.points[*pixel] - eye).truncate()).collect();
        let mut distances_m: Vec<f32> = away.iter().map(|away| away.length()).collect();
        distances_m.sort_by(f32::total_cmp);
        let distance_m = distances_m[(FOOT * (distances_m.len() - 1) as f32) as usize];
        let middle = away.iter().map(|away| away.normalize_or_zero()).sum::<Vec2>();
        let heading_rad = middle.y.atan2(middle.x);
        let widest = away.iter().map(|away| turned_rad(away.y.atan2(away.x), heading_rad).abs());
        let overhang_rad = OVERHANG_M.atan2(distance_m);
        Self { heading_rad, half_width_rad: widest.fold(0.0, f32::max) + overhang_rad, distance_m }
    }

    /// Returns whether the ray to a point passes through the column.
    fn holds(&self, point: Vec3, eye: Vec3) -> bool {
        let way = point - eye;
        let away_m = way.truncate().length();
        let height_m = eye.z + way.z / away_m * self.distance_m;
        let turned_rad = turned_rad(way.y.atan2(way.x), self.heading_rad).abs();
        turned_rad <= self.half_width_rad && (0.0..=TALLEST_M).contains(&height_m)
    }
}

fn turned_rad(heading_rad: f32, from_rad: f32) -> f32 {
    (heading_rad - from_rad + PI).rem_euclid(TAU) - PI
}

/// Draws the hall as other pictures show it from elsewhere; `None` where there are none. Pixels that none of them sees have no
/// colour.
fn hall(picture: &ShrunkPicture, others: &[ShrunkPicture], proxy: &ProxyGeometry) -> Option<Vec<Expected>> {
    let target = Target { rays: &picture.camera.rays, placement: picture.placement, proxy };
    let place = |placement: &Placement| Vec3::from_array(placement.position_in_world);
    let is_elsewhere =
        |other: &&ShrunkPicture| place(&other.placement).distance(place(&picture.placement)) > BASELINE_M;
    let sources: Vec<Source> = others.iter().filter(is_elsewhere).map(ShrunkPicture::source).collect();
    let weights = BlendWeights::default();
    let chosen = select(&Look::new(&target), &sources, &weights, SOURCES);
    let sources: Vec<Source> = chosen.into_iter().map(|index| sources[index]).collect();
    let drawn = CpuWarper.blend(&target, &sources, &weights).ok()?;
    let pixel = |(color, origin): (&[u8; 3], &reality_sim_core::warp::Origin)| {
        if origin.is_recorded() { Expected::Color(color.map(f32::from)) } else { Expected::Unknown }
    };
    (!sources.is_empty()).then(|| drawn.colors.iter().zip(&drawn.origins).map(pixel).collect())
}
