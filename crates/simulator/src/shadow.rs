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

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::test_view::{TestCamera, usual_pose};

    /// Returns the share of an even sky's light that a sphere leaves, by summing over directions of the sky.
    fn summed(sphere: Sphere, ground_point: DVec2) -> f64 {
        let to_center = sphere.center_in_world - ground_point.extend(0.0);
        let cos_cone = (1.0 - (sphere.radius_m / to_center.length()).powi(2)).max(0.0).sqrt();
        let (steps, turns) = (300, 600);
        let mut left = 0.0;
        for (step, turn) in (0..steps).flat_map(|step| (0..turns).map(move |turn| (step, turn))) {
            // Squares of the sine that are evenly spaced have the same share of the light each.
            let sin = ((f64::from(step) + 0.5) / f64::from(steps)).sqrt();
            let around = TAU * (f64::from(turn) + 0.5) / f64::from(turns);
            let ray = DVec3::new(sin * around.cos(), sin * around.sin(), (1.0 - sin * sin).sqrt());
            left += f64::from(u8::from(ray.dot(to_center) / to_center.length() < cos_cone));
        }
        left / f64::from(steps * turns)
    }

    #[test]
    fn the_share_of_light_is_that_of_a_sum_over_the_sky() {
        for (height_m, radius_m, beside_m) in
            [(0.065, 0.065, 0.03), (0.065, 0.065, 0.1), (0.5, 0.2, 0.1), (0.5, 0.2, 0.6), (0.3, 0.1, 0.0)]
        {
            let sphere = Sphere { center_in_world: DVec3::new(1.0, 2.0, height_m), radius_m };
            let point = DVec2::new(1.0, 2.0) + beside_m * DVec2::from_angle(0.7);
            let (found, truth) = (light_left(sphere, point), summed(sphere, point));
            assert!((found - truth).abs() < 0.004, "{height_m} {radius_m} {beside_m}: {found} {truth}");
        }
    }

    #[test]
    fn a_ball_takes_all_light_where_it_touches_the_ground_and_none_far_away_or_below_it() {
        let sphere = Sphere { center_in_world: DVec3::new(0.0, 0.0, 0.1), radius_m: 0.1 };
        assert_eq!(light_left(sphere, DVec2::ZERO), 0.0);
        assert!(light_left(sphere, DVec2::new(3.0, 0.0)) > 0.9999);
        let sunk = Sphere { center_in_world: DVec3::new(0.0, 0.0, -0.1), ..sphere };
        assert_eq!(light_left(sunk, DVec2::ZERO), 1.0);
    }

    #[test]
    fn the_part_of_the_picture_holds_all_that_is_darkened_by_a_hundredth() {
        let camera = &TestCamera::of_all_lenses()[2];
        let view = camera.view(usual_pose());
        let sphere = Sphere { center_in_world: DVec3::new(1.2, 0.4, 0.1), radius_m: 0.1 };
        let shadow = Shadow::new(sphere, &view).unwrap();
        for (u, v) in (0..160_u32).flat_map(|u| (0..120_u32).map(move |v| (u, v))) {
            let pixel = DVec2::new(u.into(), v.into());
            let Ok(ground) = view.lens().unproject_to_ground(view.pose(), pixel) else { continue };
            let left = light_left(sphere, ground);
            assert!(left > 0.99 || shadow.area.contains(u, v), "{u} {v}: {left}");
            let approximate = f64::from(shadow.left(ground.x as f32, ground.y as f32));
            assert!((approximate - left).abs() < 0.0101, "{approximate} {left}");
        }
        for wrong in [DVec3::NAN, DVec3::new(0.0, 0.0, -1.0), DVec3::new(1e9, 0.0, 0.1)] {
            let seen = Shadow::new(Sphere { center_in_world: wrong, ..sphere }, &view);
            assert!(seen.is_none_or(|shadow| shadow.area.width() <= 160), "{wrong}");
        }
    }
}
