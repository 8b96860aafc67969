//! The ground that a camera sees, from above.

use glam::DVec2;
use reality_sim_core::{camera::Camera, pose::CameraPose};

/// Ground farther away than this is cut off, metres: a pixel there shows more than a robot's length.
const FAR_M: f64 = 4.0;
/// Pixels of the picture's border that are looked at on each side.
const STEPS: u32 = 48;
/// Halvings on the way to where the lens ends: less than a pixel is left.
const HALVINGS: u32 = 12;

/// The outline of the ground in a picture, world axes, metres, cut off at some distance. Empty where no ground is seen.
pub fn footprint(camera: &Camera, pose: CameraPose) -> Vec<DVec2> {
    let sees_ground =
        camera.unproject_to_ground(pose, DVec2::new(camera.cx, f64::from(camera.height) - 1.0)).is_ok();
    if !sees_ground {
        return Vec::new();
    }
    let rotation = pose.rotation_world_from_camera();
    let place = pose.planar().position_in_world();
    let seen = border(camera).filter_map(|pixel| {
        let ray = rotation * camera.unproject(outermost(camera, pixel)?).ok()?;
        let aside = ray.truncate();
        // Above the horizon the ground goes on for ever.
        let far_m = if ray.z < 0.0 { -pose.height_m / ray.z * aside.length() } else { f64::INFINITY };
        Some(place + far_m.min(FAR_M) * aside.try_normalize()?)
    });
    seen.collect()
}

/// Pixels once around the picture.
fn border(camera: &Camera) -> impl Iterator<Item = DVec2> {
    let [right, bottom] = [camera.width, camera.height].map(|size| f64::from(size) - 1.0);
    let corners = [DVec2::ZERO, DVec2::new(right, 0.0), DVec2::new(right, bottom), DVec2::new(0.0, bottom)];
    (0..4).flat_map(move |side| {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        (0..STEPS).map(move |step| from.lerp(to, f64::from(step) / f64::from(STEPS)))
    })
}

/// The pixel nearest to this one, on the line from the principal point, at which the lens sees something.
fn outermost(camera: &Camera, pixel: DVec2) -> Option<DVec2> {
    let middle = DVec2::new(camera.cx, camera.cy);
    let is_seen = |pixel: DVec2| camera.check_inside(pixel).is_ok() && camera.unproject(pixel).is_ok();
    if is_seen(pixel) {
        return Some(pixel);
    }
    let (mut seen, mut unseen) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let between = 0.5 * (seen + unseen);
        *(if is_seen(middle.lerp(pixel, between)) { &mut seen } else { &mut unseen }) = between;
    }
    (seen > 0.0).then(|| middle.lerp(pixel, seen))
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Distortion, ImageCircle},
        pose::Pose2,
    };

    use super::*;

    fn camera() -> Camera {
        Camera::new([640, 480], [400.0, 400.0, 319.5, 239.5], Distortion::Pinhole).unwrap()
    }

    fn pose(pitch_rad: f64) -> CameraPose {
        CameraPose::new(Pose2::new(1.0, -0.5, 0.8), 0.5, pitch_rad, 0.0)
    }

    /// A pinhole camera that looks straight down sees a rectangle: what it measures is known from its angles alone.
    #[test]
    fn from_above_the_footprint_is_the_pictures_rectangle_on_the_ground() {
        let outline = footprint(&camera(), pose(std::f64::consts::FRAC_PI_2));
        let area: f64 = (0..outline.len())
            .map(|index| outline[index].perp_dot(outline[(index + 1) % outline.len()]))
            .sum::<f64>()
            .abs()
            / 2.0;
        let expected = (0.5 * 639.0 / 400.0) * (0.5 * 479.0 / 400.0);
        assert!((area - expected).abs() < 1e-6, "{area} {expected}");
    }

    #[test]
    fn ground_is_in_front_of_the_camera_and_ends_where_it_is_cut_off() {
        let pose = pose(0.3);
        let outline = footprint(&camera(), pose);
        let forward = DVec2::from_angle(pose.yaw_rad);
        let distances: Vec<f64> =
            outline.iter().map(|point| (*point - DVec2::new(1.0, -0.5)).length()).collect();
        assert!(outline.iter().all(|point| (*point - DVec2::new(1.0, -0.5)).dot(forward) > 0.0));
        assert!(distances.iter().all(|distance| *distance <= FAR_M + 1e-9));
        assert!(distances.iter().any(|distance| *distance > FAR_M - 1e-9), "the horizon is in the picture");
    }

    #[test]
    fn a_smaller_image_circle_shows_less_ground_and_the_sky_none() {
        let farthest = |camera: &Camera| {
            let pose = pose(1.2);
            let distance = |point: &DVec2| (*point - DVec2::new(1.0, -0.5)).length();
            footprint(camera, pose).iter().map(distance).fold(0.0, f64::max)
        };
        let circle = ImageCircle { cx: 319.5, cy: 239.5, radius: 150.0 };
        assert!(farthest(&camera().with_image_circle(Some(circle))) < farthest(&camera()));
        assert!(footprint(&camera(), pose(-1.2)).is_empty());
    }
}
