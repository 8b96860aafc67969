//! Contact shadows: the light from above that things take from the ground.
//!
//! A sphere of radius `r` whose centre is `h` above the ground takes the share `r² h / d³` of the light of an even sky from a
//! point of the ground at the distance `d` from the centre: the form factor from a small area to a sphere above its horizon
//! (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-43 and its limits). Several spheres multiply what
//! they leave, as if they hid different parts of the sky by chance.

use glam::{DVec2, DVec3, Vec3};
use image::RgbImage;
use rayon::prelude::*;
use reality_sim_core::{
    camera::LANES,
    warp::{Surface, Target},
};
use reality_sim_sensor::Development;

use crate::{layer::Sphere, pixel_box::PixelBox, view::View};

/// Share of the light that may be missing unseen: 1 % of linear light is 0.9 grey levels at a value of 200 and a gamma of 2.2.
const LEAST_SHARE: f64 = 0.01;
/// Number of points on the outline of a shadow by which its place in the picture is found.
const OUTLINE_POINTS: u32 = 16;
/// How much farther than a polygon of so many points a circle reaches.
const OUTLINE_MARGIN: f64 = 1.05;

/// Returns the share of an even sky's light that a sphere leaves to a point of the ground.
pub fn light_left(sphere: Sphere, ground_point: DVec2) -> f64 {
    let Sphere { center_in_world, radius_m } = sphere;
    let distance_m = center_in_world.distance(ground_point.extend(0.0));
    let height_m = center_in_world.z;
    if height_m <= 0.0 {
        return 1.0;
    }
    (1.0 - radius_m * radius_m * height_m / distance_m.powi(3)).clamp(0.0, 1.0)
}

/// Sphere with the part of the picture that its shadow may reach.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shadow {
    pub(crate) area: PixelBox,
    center: Vec3,
    /// Radius squared times height.
    strength: f32,
    /// Distance from the centre within which the shadow shows, squared.
    reach_squared: f32,
}

impl Shadow {
    /// Finds a sphere's shadow; `None` where it is not seen.
    pub(crate) fn new(sphere: Sphere, view: &View<'_>) -> Option<Self> {
        let Sphere { center_in_world, radius_m } = sphere;
        let strength = radius_m * radius_m * center_in_world.z;
        let reach_m = (strength / LEAST_SHARE).cbrt();
        let on_ground_m = (reach_m * reach_m - center_in_world.z.powi(2)).max(0.0).sqrt();
        let is_plausible = center_in_world.is_finite() && strength > 0.0 && on_ground_m > 0.0;
        if !is_plausible {
            return None;
        }
        let area = area(center_in_world, on_ground_m, view)?;
        Some(Self {
            area,
            center: center_in_world.as_vec3(),
            strength: strength as f32,
            reach_squared: (reach_m * reach_m) as f32,
        })
    }

    /// Returns the share of the light that is left at a point of the ground.
    fn left(&self, x: f32, y: f32) -> f32 {
        let (dx, dy) = (x - self.center.x, y - self.center.y);
        let squared = dx * dx + dy * dy + self.center.z * self.center.z;
        if squared >= self.reach_squared {
            return 1.0;
        }
        (1.0 - self.strength / (squared * squared.sqrt())).max(0.0)
    }
}

/// Returns the pixels that show a disc on the ground; all of them where it reaches beyond the lens's largest valid angle.
fn area(center: DVec3, radius_m: f64, view: &View<'_>) -> Option<PixelBox> {
    let turn = std::f64::consts::TAU / f64::from(OUTLINE_POINTS);
    let outline = (0..OUTLINE_POINTS).map(|point| {
        let offset = OUTLINE_MARGIN * radius_m * DVec2::from_angle(turn * f64::from(point));
        view.project((center.truncate() + offset).extend(0.0))
    });
    let seen: Vec<DVec2> = outline.flatten().map(|seen| seen.pixel).collect();
    if seen.is_empty() {
        return None;
    }
    if seen.len() < OUTLINE_POINTS as usize {
        return Some(PixelBox::whole(view.size()));
    }
    let least = seen.iter().copied().reduce(DVec2::min)?;
    let most = seen.iter().copied().reduce(DVec2::max)?;
    PixelBox::touched(least.to_array(), most.to_array(), view.size())
}

/// Darkens the ground in a recorded picture.
pub(crate) fn darken(
    picture: &mut RgbImage,
    target: &Target<'_>,
    development: &Development,
    shadows: &[Shadow],
) {
    let width = picture.width() as usize;
    let all = shadows.iter().fold(PixelBox::default(), |all, shadow| all.union(shadow.area));
    let rows = picture.par_chunks_exact_mut(3 * width).enumerate();
    rows.skip(all.top as usize).take(all.height() as usize).for_each(|(v, row)| {
        let here: Vec<&Shadow> = shadows
            .iter()
            .filter(|shadow| (shadow.area.top..shadow.area.bottom).contains(&(v as u32)))
            .collect();
        let (colors, _) = row.as_chunks_mut::<3>();
        for (block, colors) in colors.chunks_mut(LANES).enumerate() {
            darken_block(colors, (v, block), target, development, &here);
        }
    });
}

fn darken_block(
    colors: &mut [[u8; 3]],
    (row, block): (usize, usize),
    target: &Target<'_>,
    development: &Development,
    shadows: &[&Shadow],
) {
    let (first, end) = ((block * LANES) as u32, (block * LANES + LANES) as u32);
    let meets = |shadow: &&&Shadow| shadow.area.left < end && first < shadow.area.right;
    if !shadows.iter().any(|shadow| meets(&shadow)) {
        return;
    }
    let seen = target.surfaces(row, block);
    if !seen.surface.contains(&Surface::Ground) {
        return;
    }
    let mut left = [1.0_f32; LANES];
    for shadow in shadows.iter().filter(meets) {
        for (lane, left) in left.iter_mut().enumerate() {
            *left *= shadow.left(seen.point_in_world[0][lane], seen.point_in_world[1][lane]);
        }
    }
    for (lane, color) in colors.iter_mut().enumerate() {
        if seen.surface[lane] == Surface::Ground && left[lane] < 1.0 - 0.5 * LEAST_SHARE as f32 {
            *color = development.darkened(*color, left[lane]);
        }
    }
}
