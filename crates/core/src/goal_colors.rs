//! Resolution of the field's symmetry: goals of different colours tell a pose from its mirror pose.

use glam::DVec3;
use image::RgbImage;

use crate::{camera::Camera, field::FieldDimensions, pose::CameraPose, setters::setters};

/// Evidence that the colours of goals give.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct GoalColorConfig {
    /// Number of samples along each post and crossbar, 24: one every 4 to 10 cm, which is a few pixels apart.
    pub samples: u32,
    /// Log-odds of one sample whose colour is clearly that of one goal, 0.1: neighbouring samples are not independent, so
    /// that a whole goal in view gives about as much as one picture may.
    pub sample_log_odds: f64,
    /// Maximum log-odds of one picture, 2: pictures of the same wall are not independent. Two pictures are needed for
    /// [`crate::localization::TrackConfig::max_mirrored_probability`].
    pub max_log_odds: f64,
    /// Minimum distance between the goals' chromaticities, 0.05: nearer ones count as one colour.
    pub min_color_distance: f64,
    /// Maximum distance of a sample's colour from a goal's, as a fraction of the distance between both goals' colours,
    /// 0.35: below one half no sample matches both.
    pub color_reach: f64,
}

setters!(GoalColorConfig {
    with_samples: samples = u32,
    with_sample_log_odds: sample_log_odds = f64,
    with_max_log_odds: max_log_odds = f64,
    with_min_color_distance: min_color_distance = f64,
    with_color_reach: color_reach = f64,
});

impl Default for GoalColorConfig {
    fn default() -> Self {
        Self {
            samples: 24,
            sample_log_odds: 0.1,
            max_log_odds: 2.0,
            min_color_distance: 0.05,
            color_reach: 0.35,
        }
    }
}

/// Compares the colours of goals in pictures with those that the field specifies.
#[derive(Debug, Clone)]
pub struct GoalColors {
    config: GoalColorConfig,
    camera: Camera,
    /// Points on the goals, world axes, metres, and whether the goal is the one at +x.
    points: Vec<(DVec3, bool)>,
    positive: [f64; 2],
    negative: [f64; 2],
}

impl GoalColors {
    /// Prepares the comparison. Returns `None` if the field gives no colours, or the same for both goals.
    pub fn new(camera: &Camera, field: &FieldDimensions, config: GoalColorConfig) -> Option<Self> {
        let (positive, negative) = field.goal_srgb_positive_x.zip(field.goal_srgb_negative_x)?;
        let (positive, negative) = (chromaticity(positive)?, chromaticity(negative)?);
        (distance(positive, negative) > config.min_color_distance).then(|| Self {
            config,
            camera: camera.clone(),
            points: goal_points(field, config.samples),
            positive,
            negative,
        })
    }

    /// Returns the log-odds, from one picture, of the mirror pose against the pose itself.
    pub fn mirrored_log_odds(&self, picture: &RgbImage, pose: CameraPose) -> f64 {
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
                let reach = self.config.color_reach * distance(self.positive, self.negative);
                match (distance(color, here) < reach, distance(color, there) < reach) {
                    (false, true) => Some(self.config.sample_log_odds),
                    (true, false) => Some(-self.config.sample_log_odds),
                    _ => None,
                }
            })
            .sum();
        sum.clamp(-self.config.max_log_odds, self.config.max_log_odds)
    }
}

fn goal_points(field: &FieldDimensions, samples: u32) -> Vec<(DVec3, bool)> {
    let mut points = Vec::new();
    for (goal, at_positive_x) in field.goals().iter().zip([false, true]) {
        let [left, right] = goal.posts;
        let bar_m = field.goal_height_m + field.goal_post_diameter_m / 2.0;
        for i in 0..samples {
            let fraction = (f64::from(i) + 0.5) / f64::from(samples);
            points.push((left.center.extend(fraction * left.height_m), at_positive_x));
            points.push((right.center.extend(fraction * right.height_m), at_positive_x));
            points.push((left.center.lerp(right.center, fraction).extend(bar_m), at_positive_x));
        }
    }
    points
}

/// Returns red and green as fractions of the sum; `None` for a pixel that is too dark to have a colour.
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
        let colors = GoalColors::new(&camera, &field, GoalColorConfig::default()).unwrap();
        let pose =
            CameraPose { x_m: 1.5, y_m: 0.2, yaw_rad: 0.0, height_m: 0.5, pitch_rad: 0.1, roll_rad: 0.0 };
        let painted = |color: Option<[u8; 3]>| {
            let mut picture = RgbImage::from_pixel(320, 240, image::Rgb([90, 90, 90]));
            for (point, at_positive_x) in goal_points(&field, 24) {
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
        assert!(colors.mirrored_log_odds(&painted(field.goal_srgb_positive_x), pose) <= -1.0);
        assert!(colors.mirrored_log_odds(&painted(field.goal_srgb_negative_x), pose) >= 1.0);
        let plain = FieldDimensions { goal_srgb_positive_x: None, ..field };
        assert!(GoalColors::new(&camera, &plain, GoalColorConfig::default()).is_none());
    }
}
