//! Check that a path lets the camera see lines, as people take care of when they record.

use glam::DVec2;

use crate::{nominal::Nominal, rig::Station, trajectory::Trajectory};

/// Distance between the points at which lines are looked for, metres.
const STEP_M: f64 = 0.1;
/// Distance up to which a line counts, metres.
const NEAR_M: f64 = 4.0;
/// Least number of points in view in an ordinary picture, and least part of ordinary pictures.
const LEAST_POINTS: usize = 15;
const LEAST_PICTURES: f64 = 0.8;
/// Number of pictures that are looked at.
const PICTURES: usize = 20;

/// Whether lines are in view at most of these times, seconds.
pub fn are_ordinary(nominal: &Nominal, path: &Trajectory, times_s: &[f64]) -> bool {
    let points = points(nominal);
    let largest_radius = nominal.lens.largest_radius();
    let looked_at: Vec<f64> = times_s.iter().copied().step_by(times_s.len().div_ceil(PICTURES)).collect();
    let sees = |time_s: &&f64| {
        let station = path.station(**time_s);
        points.iter().filter(|point| is_in_view(nominal, largest_radius, station, **point)).count()
            >= LEAST_POINTS
    };
    looked_at.iter().filter(sees).count() as f64 >= LEAST_PICTURES * looked_at.len() as f64
}

fn is_in_view(nominal: &Nominal, largest_radius: f64, station: Station, point: DVec2) -> bool {
    if point.distance(station.position.truncate()) > NEAR_M {
        return false;
    }
    let seen = station.world_from_camera.transpose() * (point.extend(0.0) - station.position);
    let [width, height] = nominal.size.map(f64::from);
    let pixel = (seen.z > 0.0).then(|| nominal.lens.pixel(seen)).flatten();
    let inside = |pixel: DVec2| pixel.cmpge(DVec2::ZERO).all() && pixel.x < width && pixel.y < height;
    // A bent lens maps directions far outside its range back into the picture.
    let within = |pixel| {
        let back = nominal.lens.ray(pixel, largest_radius);
        back.is_some_and(|ray| ray.angle_between(seen) < 0.01)
    };
    pixel.is_some_and(|pixel| inside(pixel) && within(pixel))
}

/// Returns points on the outline, the halfway line, the circle and the areas.
fn points(nominal: &Nominal) -> Vec<DVec2> {
    let field = &nominal.field;
    let half = DVec2::new(field.length_m, field.width_m) / 2.0;
    let corner = |x: f64, y: f64| half * DVec2::new(x, y);
    let mut lines = vec![(corner(0.0, -1.0), corner(0.0, 1.0))];
    let mut area = |depth_m: f64, width_m: f64| {
        for side in [-1.0, 1.0] {
            let (front, y) = (side * (half.x - depth_m), width_m / 2.0);
            lines.push((DVec2::new(front, -y), DVec2::new(front, y)));
            for y in [-y, y] {
                lines.push((DVec2::new(side * half.x, y), DVec2::new(front, y)));
            }
        }
    };
    area(field.goal_area_length_m, field.goal_area_width_m);
    if let (Some(depth_m), Some(width_m)) = (field.penalty_area_length_m, field.penalty_area_width_m) {
        area(depth_m, width_m);
    }
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    lines.extend(corners.iter().copied().zip(corners.iter().copied().cycle().skip(1)));
    let radius_m = field.center_circle_diameter_m / 2.0;
    let around = (0..40).map(|step| DVec2::from_angle(f64::from(step) * 0.157) * radius_m);
    let straight = lines.into_iter().flat_map(|(from, to): (DVec2, DVec2)| {
        let count = (from.distance(to) / STEP_M) as u32;
        (0..=count).map(move |step| from.lerp(to, f64::from(step) / f64::from(count.max(1))))
    });
    straight.chain(around).collect()
}
