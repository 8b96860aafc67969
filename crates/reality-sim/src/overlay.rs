//! Overlays that draw a pose into its picture: the field's lines where the pose predicts them, the detected border of the
//! field, the particles, and a map of the field from above.
//!
//! Everything on the ground is projected by the camera's own lens model, see [`crate::field::project_lines`].

use glam::{DVec2, Vec2};
use image::RgbImage;

use crate::{
    camera::Camera,
    field::{Curve, FieldDimensions, project_lines, project_polygon},
    pose::CameraPose,
};

/// Colour of both edges of the lines at the pose to be shown, and of the pose on the map.
pub const POSE_SRGB: [u8; 3] = [255, 45, 160];
/// Colour of the lines' centres at the true pose, and of the true pose on the map.
pub const TRUTH_SRGB: [u8; 3] = [20, 110, 255];
/// Colour of the detected border of the field.
pub const BORDER_SRGB: [u8; 3] = [255, 205, 0];
/// Colour of the particles.
pub const PARTICLE_SRGB: [u8; 3] = [255, 150, 30];

const MAP_GROUND_SRGB: [u8; 3] = [14, 44, 28];
const MAP_LINE_SRGB: [u8; 3] = [225, 235, 228];
const PATH_SRGB: [u8; 3] = [250, 190, 225];

/// Largest distance between poses that are joined on the map, metres: beyond it the robot was carried, or the filter
/// jumped.
const MAX_PATH_STEP_M: f64 = 0.5;
/// Ratio of the map's width to the picture's.
const MAP_FRACTION: f64 = 0.34;
/// Smallest size of a map, pixels: a smaller one would be illegible and is left out.
const MIN_MAP_PX: u32 = 48;

/// Border of the field in a picture, and the camera's pose when it was detected.
#[derive(Debug, Clone, Copy)]
pub struct BorderOutline<'a> {
    /// Corners, metres, x along the camera's heading and y to its left: see
    /// [`crate::preprocess::FieldBorder::outline_in_heading`].
    pub corners_in_heading: &'a [Vec2],
    /// Pose of the camera above the origin of these axes.
    pub camera_in_heading: CameraPose,
}

/// Contents to be drawn into a picture.
#[derive(Debug, Clone, Copy)]
pub struct Overlay<'a> {
    /// Camera that took the picture.
    pub camera: &'a Camera,
    /// Field in view.
    pub field: &'a FieldDimensions,
    /// Pose to be shown.
    pub pose: CameraPose,
    /// True pose, if it is known.
    pub truth: Option<CameraPose>,
    /// Border of the field, if it was searched for.
    pub border: Option<BorderOutline<'a>>,
    /// Particles to be drawn.
    pub particles: &'a [CameraPose],
    /// Poses so far, drawn on the map.
    pub path: &'a [CameraPose],
}

impl Overlay<'_> {
    /// Draws everything into the picture.
    pub fn draw(&self, picture: RgbImage) -> RgbImage {
        self.draw_map(self.draw_scene(picture))
    }

    /// Draws everything that lies on the ground into the picture: lines, border, particles.
    pub fn draw_scene(&self, mut picture: RgbImage) -> RgbImage {
        let scale = f64::from(picture.width().max(picture.height())) / 640.0;
        let pen = Pen { width_px: 1.3 * scale.clamp(1.0, 4.0), halo: 0.35 };
        if let Some(BorderOutline { corners_in_heading, camera_in_heading }) = self.border {
            let corners: Vec<DVec2> = corners_in_heading.iter().map(|corner| corner.as_dvec2()).collect();
            let outline = project_polygon(self.camera, &corners, camera_in_heading);
            pen.stroke(&mut picture, &segments(&outline), BORDER_SRGB);
        }
        if let Some(truth) = self.truth {
            let centres = project_lines(self.camera, self.field, truth, 0.0);
            pen.stroke(&mut picture, &segments(&centres), TRUTH_SRGB);
        }
        let half_width_m = self.field.line_width_m / 2.0;
        let edge = |sideways_m| project_lines(self.camera, self.field, self.pose, sideways_m);
        let edges = [edge(-half_width_m), edge(half_width_m)].concat();
        pen.stroke(&mut picture, &segments(&edges), POSE_SRGB);
        let dots: Vec<_> = self
            .particles
            .iter()
            .filter_map(|particle| self.see(self.pose, particle.planar().position_in_world()))
            .map(|pixel| (pixel, pixel))
            .collect();
        Pen { width_px: 1.5 * pen.width_px, halo: 0.0 }.stroke(&mut picture, &dots, PARTICLE_SRGB);
        picture
    }

    /// Draws a map of the field into the upper right corner of the picture, with the opponent's goal (+x) on the right.
    pub fn draw_map(&self, mut picture: RgbImage) -> RgbImage {
        let Some(map) = Map::new(self.field, picture.dimensions()) else { return picture };
        let mut inset =
            image::imageops::crop_imm(&picture, map.left, map.top, map.width, map.height).to_image();
        for pixel in inset.pixels_mut() {
            blend(&mut pixel.0, MAP_GROUND_SRGB, 0.85);
        }
        let pen = Pen { width_px: (f64::from(map.width) / 180.0).max(1.0), halo: 0.0 };
        pen.stroke(&mut inset, &map.lines(self.field), MAP_LINE_SRGB);
        let dots: Vec<_> =
            self.particles.iter().map(|&particle| (map.at(particle), map.at(particle))).collect();
        Pen { width_px: 1.6 * pen.width_px, ..pen }.stroke(&mut inset, &dots, PARTICLE_SRGB);
        pen.stroke(&mut inset, &map.path(self.path), PATH_SRGB);
        let arrow = Pen { width_px: 1.8 * pen.width_px, halo: 0.5 };
        if let Some(truth) = self.truth {
            arrow.stroke(&mut inset, &map.arrow(truth), TRUTH_SRGB);
        }
        arrow.stroke(&mut inset, &map.arrow(self.pose), POSE_SRGB);
        image::imageops::replace(&mut picture, &inset, i64::from(map.left), i64::from(map.top));
        picture
    }

    fn see(&self, pose: CameraPose, point_on_ground: DVec2) -> Option<DVec2> {
        self.camera.project(pose.camera_from_world(point_on_ground.extend(0.0))).ok()
    }
}

/// Straight segment in the picture, pixels.
type Segment = (DVec2, DVec2);

/// Returns the segments of polylines.
fn segments(polylines: &[Vec<DVec2>]) -> Vec<Segment> {
    polylines.iter().flat_map(|polyline| polyline.windows(2).map(|pair| (pair[0], pair[1]))).collect()
}

/// Map of the field from above: its position in the picture, and its scale.
struct Map {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    px_per_m: f64,
}

impl Map {
    /// Places the map; `None` if the picture is too small for one.
    fn new(field: &FieldDimensions, (picture_width, picture_height): (u32, u32)) -> Option<Self> {
        let extent_m = 2.0 * field.carpet_half_extent_m();
        let scale = |pixels: u32, metres: f64| MAP_FRACTION * f64::from(pixels) / metres;
        let px_per_m = scale(picture_width, extent_m.x).min(scale(picture_height, extent_m.y));
        let (width, height) =
            ((px_per_m * extent_m.x).round() as u32, (px_per_m * extent_m.y).round() as u32);
        let margin = picture_width / 80;
        let left = picture_width.checked_sub(width + margin)?;
        (width.min(height) >= MIN_MAP_PX).then_some(Self { left, top: margin, width, height, px_per_m })
    }

    fn place(&self, point: DVec2) -> DVec2 {
        let middle = DVec2::new(f64::from(self.width - 1), f64::from(self.height - 1)) / 2.0;
        middle + self.px_per_m * DVec2::new(point.x, -point.y)
    }

    fn at(&self, pose: CameraPose) -> DVec2 {
        self.place(pose.planar().position_in_world())
    }

    fn lines(&self, field: &FieldDimensions) -> Vec<Segment> {
        let mut segments = Vec::new();
        for curve in field.curves() {
            let count = match curve {
                Curve::Segment { .. } => 1,
                Curve::Circle { .. } => 48,
            };
            let point = |step: u32| self.place(curve.at(f64::from(step) / f64::from(count)).0);
            segments.extend((0..count).map(|step| (point(step), point(step + 1))));
        }
        segments
    }

    fn path(&self, path: &[CameraPose]) -> Vec<Segment> {
        path.windows(2)
            .filter(|pair| (pair[0].x_m - pair[1].x_m).hypot(pair[0].y_m - pair[1].y_m) < MAX_PATH_STEP_M)
            .map(|pair| (self.at(pair[0]), self.at(pair[1])))
            .collect()
    }

    fn arrow(&self, pose: CameraPose) -> Vec<Segment> {
        let length_px = f64::from(self.width) / 10.0;
        let direction = DVec2::new(pose.yaw_rad.cos(), -pose.yaw_rad.sin());
        let (tail, tip) = (self.at(pose), self.at(pose) + length_px * direction);
        let barb = |angle_rad: f64| tip - 0.4 * length_px * DVec2::from_angle(angle_rad).rotate(direction);
        vec![(tail, tip), (tip, barb(0.5)), (tip, barb(-0.5))]
    }
}

/// Appearance of strokes.
#[derive(Clone, Copy)]
struct Pen {
    width_px: f64,
    /// Opacity of the dark rim that separates a stroke from its background.
    halo: f64,
}

impl Pen {
    /// Draws all segments at once: where they overlap, they cover no more than a single one does.
    fn stroke(self, picture: &mut RgbImage, segments: &[Segment], color: [u8; 3]) {
        if self.halo > 0.0 {
            Coverage::of(picture, segments, self.width_px + 1.6).paint(picture, [0, 0, 0], self.halo);
        }
        Coverage::of(picture, segments, self.width_px).paint(picture, color, 1.0);
    }
}

/// Fraction of each pixel that strokes cover, 0 to 1.
struct Coverage {
    width: usize,
    values: Vec<f32>,
}

impl Coverage {
    fn of(picture: &RgbImage, segments: &[Segment], width_px: f64) -> Self {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let mut coverage = Self { width, values: vec![0.0; width * height] };
        for &(from, to) in segments {
            coverage.add(from, to, width_px / 2.0, height);
        }
        coverage
    }

    fn add(&mut self, from: DVec2, to: DVec2, half_width_px: f64, height: usize) {
        let reach = half_width_px + 0.5;
        let range = |a: f64, b: f64, size: usize| {
            let first = (a.min(b) - reach).ceil().max(0.0) as usize;
            let end = ((a.max(b) + reach).floor() + 1.0).clamp(0.0, size as f64) as usize;
            first.min(end)..end
        };
        let along = to - from;
        let squared = along.length_squared().max(f64::MIN_POSITIVE);
        for v in range(from.y, to.y, height) {
            for u in range(from.x, to.x, self.width) {
                let pixel = DVec2::new(u as f64, v as f64);
                let fraction = ((pixel - from).dot(along) / squared).clamp(0.0, 1.0);
                let covered = (reach - pixel.distance(from + fraction * along)).clamp(0.0, 1.0) as f32;
                let value = &mut self.values[v * self.width + u];
                *value = value.max(covered);
            }
        }
    }

    fn paint(&self, picture: &mut RgbImage, color: [u8; 3], opacity: f64) {
        for (pixel, &covered) in picture.pixels_mut().zip(&self.values) {
            if covered > 0.0 {
                blend(&mut pixel.0, color, opacity * f64::from(covered));
            }
        }
    }
}

fn blend(pixel: &mut [u8; 3], color: [u8; 3], opacity: f64) {
    for (channel, wanted) in pixel.iter_mut().zip(color) {
        let mixed = f64::from(*channel) + opacity * (f64::from(wanted) - f64::from(*channel));
        *channel = mixed.round() as u8;
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;
    use crate::camera::Distortion;

    fn camera() -> Camera {
        Camera::new([320, 240], [150.0, 150.0, 159.5, 119.5], Distortion::Pinhole).unwrap()
    }

    fn field() -> FieldDimensions {
        FieldDimensions::preset("humanoid-kidsize-2010").unwrap()
    }

    fn overlay<'a>(camera: &'a Camera, field: &'a FieldDimensions) -> Overlay<'a> {
        let pose = CameraPose { x_m: -1.0, height_m: 0.5, pitch_rad: 0.4, ..Default::default() };
        Overlay { camera, field, pose, truth: None, border: None, particles: &[], path: &[] }
    }

    #[test]
    fn the_edges_of_the_halfway_line_are_drawn_where_the_camera_sees_them() {
        let (camera, field) = (camera(), field());
        let overlay = overlay(&camera, &field);
        let drawn = overlay.draw_scene(RgbImage::new(320, 240));
        for x in [-0.5, 0.5] {
            let point = DVec2::new(x * field.line_width_m, 0.9);
            let pixel = overlay.see(overlay.pose, point).unwrap();
            let [red, green, _] = drawn.get_pixel(pixel.x.round() as u32, pixel.y.round() as u32).0;
            assert!(red > 100 && green < 60, "{pixel}: {red} {green}");
        }
    }

    #[test]
    fn the_sky_is_left_unchanged() {
        let (camera, field) = (camera(), field());
        let drawn = overlay(&camera, &field).draw_scene(RgbImage::from_pixel(320, 240, Rgb([9, 9, 9])));
        assert!((0..320).all(|u| drawn.get_pixel(u, 20).0 == [9, 9, 9]));
    }

    #[test]
    fn the_map_shows_the_pose_where_it_is() {
        let (camera, field) = (camera(), field());
        let overlay = overlay(&camera, &field);
        let drawn = overlay.draw_map(RgbImage::new(320, 240));
        let map = Map::new(&field, (320, 240)).unwrap();
        let place = map.at(overlay.pose) + DVec2::new(f64::from(map.left), f64::from(map.top));
        let pixel = drawn.get_pixel(place.x.round() as u32, place.y.round() as u32).0;
        assert!(pixel[0] > 150 && pixel[1] < 100, "{pixel:?}");
    }

    #[test]
    fn tiny_pictures_and_impossible_poses_do_not_panic() {
        let (camera, field) = (camera(), field());
        let far = CameraPose { x_m: 1e300, yaw_rad: f64::NAN, height_m: f64::NAN, ..Default::default() };
        let overlay =
            Overlay { truth: Some(far), particles: &[far], path: &[far, far], ..overlay(&camera, &field) };
        for size in [1, 20, 320] {
            assert_eq!(overlay.draw(RgbImage::new(size, size)).dimensions(), (size, size));
        }
        let lost = Overlay { pose: far, ..overlay };
        assert_eq!(lost.draw(RgbImage::new(320, 240)).dimensions(), (320, 240));
    }
}
