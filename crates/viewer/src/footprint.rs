//! Footprint of a camera: the visible ground, seen from above.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use reality_sim_core::{camera::Camera, pose::CameraPose};

/// Distance at which the ground is cut off, metres: beyond it, a pixel covers more than a robot's length.
const FAR_M: f64 = 4.0;
/// Number of directions that are sampled, all around.
const DIRECTIONS: u32 = 120;
/// Number of positions that are sampled in each direction.
const PLACES: u32 = 40;
/// Number of bisections of the step between positions at the picture's edge: they leave a millimetre.
const HALVINGS: u32 = 7;

/// Footprint of a pose, cached while the pose stays the same.
#[derive(Debug, Clone, Default)]
pub struct Footprint {
    of: Option<CameraPose>,
    outline: Vec<DVec2>,
}

impl Footprint {
    /// Returns the outline, as [`footprint`]. All calls must be for the same camera.
    pub fn outline(&mut self, camera: &Camera, pose: CameraPose) -> &[DVec2] {
        if self.of != Some(pose) {
            (self.of, self.outline) = (Some(pose), footprint(camera, pose));
        }
        &self.outline
    }
}

/// Returns the outline of the visible ground in the world frame, metres, cut off at some distance: the far side
/// counter-clockwise, then the near side back. Empty if no ground is visible.
fn footprint(camera: &Camera, pose: CameraPose) -> Vec<DVec2> {
    let place = pose.planar().position_in_world();
    let seen = |direction: DVec2, distance_m: f64| {
        let point_in_world = (place + distance_m * direction).extend(0.0);
        camera.project(pose.camera_from_world(point_in_world)).is_ok()
    };
    // Directions start and end behind the robot, because the visible ground lies in front.
    let mut strips = Vec::new();
    for number in 0..DIRECTIONS {
        let angle_rad = pose.yaw_rad - PI + TAU * f64::from(number) / f64::from(DIRECTIONS);
        let direction = DVec2::from_angle(angle_rad);
        if let Some(ends_m) = strip(|distance_m| seen(direction, distance_m)) {
            strips.push(ends_m.map(|distance_m| place + distance_m * direction));
        }
    }
    let far = strips.iter().map(|[_, far]| *far);
    if strips.len() == DIRECTIONS as usize && seen(DVec2::X, 0.0) {
        // The robot's own position is visible: there is no near side.
        return far.collect();
    }
    far.chain(strips.iter().rev().map(|[near, _]| *near)).collect()
}

/// Returns the interval of distances at which something is visible along a line, metres.
fn strip(seen: impl Fn(f64) -> bool) -> Option<[f64; 2]> {
    let at = |place: u32| FAR_M * f64::from(place) / f64::from(PLACES);
    let first = (0..=PLACES).find(|&place| seen(at(place)))?;
    let last = (first..=PLACES).rev().find(|&place| seen(at(place)))?;
    let near = if first == 0 { 0.0 } else { edge(&seen, at(first), at(first - 1)) };
    let far = if last == PLACES { FAR_M } else { edge(&seen, at(last), at(last + 1)) };
    Some([near, far])
}

/// Finds the edge of visibility between an inner and an outer distance by bisection.
fn edge(seen: impl Fn(f64) -> bool, inside_m: f64, outside_m: f64) -> f64 {
    let (mut inside_m, mut outside_m) = (inside_m, outside_m);
    for _ in 0..HALVINGS {
        let between_m = 0.5 * (inside_m + outside_m);
        *(if seen(between_m) { &mut inside_m } else { &mut outside_m }) = between_m;
    }
    inside_m
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

    /// A pinhole camera that looks straight down sees a rectangle, whose size follows from its angles.
    #[test]
    fn from_above_the_footprint_is_the_pictures_rectangle_on_the_ground() {
        let outline = footprint(&camera(), pose(std::f64::consts::FRAC_PI_2));
        let area: f64 = (0..outline.len())
            .map(|index| outline[index].perp_dot(outline[(index + 1) % outline.len()]))
            .sum::<f64>()
            .abs()
            / 2.0;
        let expected = (0.5 * 639.0 / 400.0) * (0.5 * 479.0 / 400.0);
        assert!((area - expected).abs() < 0.01 * expected, "{area} {expected}");
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
    fn the_footprint_is_kept_for_the_present_pose_only() {
        let mut kept = Footprint::default();
        for pose in [pose(0.3), pose(0.3), pose(0.8), pose(0.3)] {
            assert_eq!(kept.outline(&camera(), pose), footprint(&camera(), pose));
        }
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
