//! Which half of the field: goals of different colours tell a pose from its mirror image.

use glam::DVec3;
use image::RgbImage;

use crate::{camera::Camera, field::FieldDimensions, pose::CameraPose};

/// Evidence of one picture is cut here: pictures of the same wall are not independent.
const MAX_LOG_ODDS: f64 = 2.0;
/// Log-odds of one sample whose colour is clearly that of one goal.
const SAMPLE_LOG_ODDS: f64 = 0.1;
/// Samples along each post and crossbar.
const SAMPLES: u32 = 24;

/// Compares the colours of goals in pictures with those the field says.
#[derive(Debug, Clone)]
pub struct GoalColors {
    camera: Camera,
    /// Points on the goals, world axes, and whether the goal is the one at +x.
    points: Vec<(DVec3, bool)>,
    positive: [f64; 2],
    negative: [f64; 2],
}

impl GoalColors {
    /// `None` where the field gives no colours, or the same for both goals.
    pub fn new(camera: &Camera, field: &FieldDimensions) -> Option<Self> {
        let (positive, negative) = field.goal_srgb_positive_x.zip(field.goal_srgb_negative_x)?;
        let (positive, negative) = (chromaticity(positive)?, chromaticity(negative)?);
        (distance(positive, negative) > 0.05).then(|| Self {
            camera: camera.clone(),
            points: goal_points(field),
            positive,
            negative,
        })
    }

    /// Log-odds, from one picture, of the pose turned by 180° against the pose itself.
    pub fn mirror_log_odds(&self, picture: &RgbImage, pose: CameraPose) -> f64 {
        let sum: f64 = self
            .points
            .iter()
            .filter_map(|&(point, at_positive_x)| {
                let pixel = self.camera.project(pose.camera_from_world(point)).ok()?;
                let color =
                    chromaticity(picture.get_pixel(pixel.x.round() as u32, pixel.y.round() as u32).0)?;
                let (here, there) = if at_positive_x {
                    (self.positive, self.negative)
                } else {
                    (self.negative, self.positive)
                };
                let reach = 0.35 * distance(self.positive, self.negative);
                match (distance(color, here) < reach, distance(color, there) < reach) {
                    (false, true) => Some(SAMPLE_LOG_ODDS),
                    (true, false) => Some(-SAMPLE_LOG_ODDS),
                    _ => None,
                }
            })
            .sum();
        sum.clamp(-MAX_LOG_ODDS, MAX_LOG_ODDS)
    }
}

fn goal_points(field: &FieldDimensions) -> Vec<(DVec3, bool)> {
    let mut points = Vec::new();
    for (goal, at_positive_x) in field.goals().iter().zip([false, true]) {
        let [left, right] = goal.posts;
        let bar_m = field.goal_height_m + field.goal_post_diameter_m / 2.0;
        for i in 0..SAMPLES {
            let fraction = (f64::from(i) + 0.5) / f64::from(SAMPLES);
            points.push((left.center.extend(fraction * left.height_m), at_positive_x));
            points.push((right.center.extend(fraction * right.height_m), at_positive_x));
            points.push((left.center.lerp(right.center, fraction).extend(bar_m), at_positive_x));
        }
    }
    points
}

/// Red and green as fractions of the sum; `None` for what is too dark to have a colour.
fn chromaticity(rgb: [u8; 3]) -> Option<[f64; 2]> {
    let sum: f64 = rgb.iter().map(|&channel| f64::from(channel)).sum();
    (sum > 60.0).then(|| [f64::from(rgb[0]) / sum, f64::from(rgb[1]) / sum])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scene;

    #[test]
    fn goals_of_the_right_colour_speak_for_a_pose_and_swapped_ones_against_it() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let colors = GoalColors::new(&camera, &field).unwrap();
        let pose =
            CameraPose { x_m: 1.5, y_m: 0.2, yaw_rad: 0.0, height_m: 0.5, pitch_rad: 0.1, roll_rad: 0.0 };
        let painted = |color: Option<[u8; 3]>| {
            let mut picture = RgbImage::from_pixel(320, 240, image::Rgb([90, 90, 90]));
            for (point, at_positive_x) in goal_points(&field) {
                if let (true, Ok(pixel)) = (at_positive_x, camera.project(pose.camera_from_world(point))) {
                    picture.put_pixel(
                        pixel.x.round() as u32,
                        pixel.y.round() as u32,
                        image::Rgb(color.unwrap()),
                    );
                }
            }
            picture
        };
        assert!(colors.mirror_log_odds(&painted(field.goal_srgb_positive_x), pose) <= -1.0);
        assert!(colors.mirror_log_odds(&painted(field.goal_srgb_negative_x), pose) >= 1.0);
        let plain = FieldDimensions { goal_srgb_positive_x: None, ..field };
        assert!(GoalColors::new(&camera, &plain).is_none());
    }
}
