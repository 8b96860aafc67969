//! Detection of the field's border: the carpet's colour is learned from the picture itself, the farthest carpet is
//! found in every direction, and a convex outline is drawn around it.
//!
//! The paper detects the field's border as a contour in the picture. Here the contour is found on the ground: each
//! direction from the camera is followed outwards to the point that best divides carpet from everything else. A robot
//! in the way makes that point too near, so the convex hull of all points is taken: the carpet is convex, and a robot's
//! foot inside the hull does not change it.

use glam::Vec2;
use image::{GrayImage, RgbImage};
use rayon::prelude::*;

use super::{
    carpet::CarpetColor,
    strips::{BEARINGS, GroundCell, MIN_DEPRESSION, Strips, bearing_direction},
};
use crate::{camera::Camera, mount::MountPose};

/// Side of the square cells into which the picture is divided, pixels.
pub const CELL_PX: u32 = 2;
/// Maximum distance from the camera up to which the carpet's colour is learned, camera heights.
const LEARNING_RADIUS_HEIGHTS: f32 = 8.0;

/// Step between the cells from which the colour is learned.
const LEARNING_STEP: usize = 5;
/// Sine of depression that no ray has.
const NEVER_INSIDE: f32 = 2.0;
/// Number of bearings beside the hull that still count as part of it.
const SIDE_BEARINGS: usize = 6;

/// Finds the field's border in pictures of one camera.
#[derive(Debug, Clone)]
pub struct BorderDetector {
    columns: u32,
    rows: u32,
    /// First byte of each cell's first pixel in a picture.
    first_bytes: Vec<u32>,
    /// Unit rays of the cells' centres in the camera's axes; zero where the camera sees nothing.
    rays_in_camera: Vec<[f32; 3]>,
}

/// Border of the field in one picture.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldBorder {
    columns: u32,
    /// Sine of the depression below the horizon for every cell inside the border; 0 outside.
    depressions: Vec<f32>,
    /// Colour of the carpet in this picture.
    pub carpet: CarpetColor,
    /// Corners of the convex outline, metres, x along the camera's heading and y to its left, counter-clockwise.
    pub outline_in_heading: Vec<Vec2>,
}

impl BorderDetector {
    /// Prepares the rays of a camera's pixels.
    pub fn new(camera: &Camera) -> Self {
        let (columns, rows) = (camera.width.div_ceil(CELL_PX), camera.height.div_ceil(CELL_PX));
        let centre = |cell: u32| f64::from(cell * CELL_PX) + f64::from(CELL_PX - 1) / 2.0;
        let ray = |row, column| {
            let pixel = glam::DVec2::new(centre(column), centre(row))
                .min(glam::DVec2::new(f64::from(camera.width - 1), f64::from(camera.height - 1)));
            let seen = camera.check_inside(pixel).is_ok();
            camera.unproject(pixel).ok().filter(|_| seen).map_or([0.0; 3], |ray| ray.as_vec3().to_array())
        };
        let first_byte = |row, column| 3 * CELL_PX * (row * camera.width + column);
        let of_row = |row| (0..columns).map(move |column| (row, column));
        let cells = || (0..rows).into_par_iter().flat_map_iter(of_row);
        Self {
            columns,
            rows,
            first_bytes: cells().map(|(row, column)| first_byte(row, column)).collect(),
            rays_in_camera: cells().map(|(row, column)| ray(row, column)).collect(),
        }
    }

    /// Finds the border in a picture taken with this mount pose.
    pub fn detect(&self, picture: &RgbImage, mount: MountPose) -> FieldBorder {
        let cells = self.ground_cells(mount);
        // A picture of another size than the camera's has no colour where it has no pixel.
        let pixel = |first: u32| picture.get(first as usize..)?.first_chunk().copied();
        let color = |index: usize| pixel(self.first_bytes[index]).unwrap_or_default();
        let near = 1.0 / (1.0 + LEARNING_RADIUS_HEIGHTS * LEARNING_RADIUS_HEIGHTS).sqrt();
        let seen = || cells.iter().enumerate().filter_map(|(index, cell)| cell.map(|cell| (index, cell)));
        let carpet = CarpetColor::learn(
            seen()
                .step_by(LEARNING_STEP)
                .filter(|(_, cell)| cell.depression > near)
                .map(|(index, _)| color(index)),
        );
        let ends = Strips::gather(&cells, color, &carpet).carpet_ends(&carpet);
        let mut places = border_points(&ends, mount.height_m as f32);
        // The robot itself stands on the carpet: without its own position, the outline of a narrow view would cut off
        // what lies near.
        places.push(Vec2::ZERO);
        let outline_in_heading = convex_hull(places);
        let limits = hull_depressions(&outline_in_heading, mount.height_m as f32);
        let inside = |cell: &GroundCell| cell.depression >= limits[usize::from(cell.bearing)];
        let depressions =
            cells.par_iter().map(|cell| cell.filter(inside).map_or(0.0, |cell| cell.depression)).collect();
        FieldBorder { columns: self.columns, depressions, carpet, outline_in_heading }
    }

    fn ground_cells(&self, mount: MountPose) -> Vec<Option<GroundCell>> {
        let rotation = mount.rotation_heading_from_camera().as_mat3();
        debug_assert_eq!(self.rays_in_camera.len(), (self.columns * self.rows) as usize);
        self.rays_in_camera
            .par_iter()
            .map(|&ray| GroundCell::of_ray(rotation * glam::Vec3::from(ray)))
            .collect()
    }
}

impl FieldBorder {
    /// Returns whether a pixel shows a point inside the border (or something that stands in front of it).
    pub fn contains(&self, u: u32, v: u32) -> bool {
        self.depression(u, v) > 0.0
    }

    /// Returns the sine of the depression below the horizon of a pixel inside the border; 0 outside.
    pub(super) fn depression(&self, u: u32, v: u32) -> f32 {
        self.depressions.get(((v / CELL_PX) * self.columns + u / CELL_PX) as usize).copied().unwrap_or(0.0)
    }

    /// Returns one bit per cell of two by two pixels, row by row, the first in the lowest bit: whether it lies inside.
    pub fn inside_bits(&self) -> Vec<u32> {
        let word = |cells: &[f32]| {
            cells
                .iter()
                .zip(0..)
                .fold(0, |word, (&depression, bit)| word | u32::from(depression > 0.0) << bit)
        };
        self.depressions.chunks(32).map(word).collect()
    }

    /// Sets all pixels outside the border to zero.
    pub fn mask(&self, picture: &mut GrayImage) {
        let width = picture.width().max(1) as usize;
        picture.par_chunks_exact_mut(width).enumerate().for_each(|(v, row)| {
            let first = v / CELL_PX as usize * self.columns as usize;
            let cells = &self.depressions[first..first + self.columns as usize];
            for (pixels, &depression) in row.chunks_mut(CELL_PX as usize).zip(cells) {
                let kept = if depression > 0.0 { u8::MAX } else { 0 };
                pixels.iter_mut().for_each(|pixel| *pixel &= kept);
            }
        });
    }
}

/// Returns the points where the carpet ends, without single directions that reach beyond both neighbours.
fn border_points(ends: &[Option<f32>], height_m: f32) -> Vec<Vec2> {
    let at = |bin: usize, step: i32| ends[(bin as i32 + step).rem_euclid(ends.len() as i32) as usize];
    (0..ends.len())
        .filter_map(|bin| {
            let here = ends[bin]?.max(MIN_DEPRESSION);
            let nearer = |step| at(bin, step).unwrap_or(1.0);
            let limited = here.max(nearer(-1).min(nearer(-2)).min(nearer(1).min(nearer(2))));
            Some(bearing_direction(bin) * height_m * ((1.0 - limited * limited).max(0.0).sqrt() / limited))
        })
        .collect()
}

/// Returns the convex hull, counter-clockwise, by Andrew's monotone chain.
fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let chain = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut hull: Vec<Vec2> = Vec::new();
        for point in points {
            while hull.len() >= 2
                && (hull[hull.len() - 1] - hull[hull.len() - 2]).perp_dot(point - hull[hull.len() - 1]) <= 0.0
            {
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        hull
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

/// Returns the sine of depression at which a ray leaves the hull, for every bearing. Bearings just beside the hull, at
/// the picture's sides, end where their neighbours do; 2 (never inside) elsewhere.
fn hull_depressions(hull: &[Vec2], height_m: f32) -> Vec<f32> {
    let limit = |bin: usize| {
        let direction = bearing_direction(bin);
        let reach = (0..hull.len())
            .filter_map(|i| ray_meets_edge(direction, hull[i], hull[(i + 1) % hull.len()]))
            .fold(0.0, f32::max);
        if reach > 0.0 { height_m / reach.hypot(height_m) } else { NEVER_INSIDE }
    };
    let limits: Vec<f32> = (0..BEARINGS).map(limit).collect();
    let beside = |bin: usize| {
        (1..=SIDE_BEARINGS)
            .flat_map(|step| [bin + step, bin + BEARINGS - step])
            .map(|neighbour| limits[neighbour % BEARINGS])
            .fold(NEVER_INSIDE, f32::min)
    };
    (0..BEARINGS).map(|bin| if limits[bin] < NEVER_INSIDE { limits[bin] } else { beside(bin) }).collect()
}

fn ray_meets_edge(direction: Vec2, from: Vec2, to: Vec2) -> Option<f32> {
    let edge = to - from;
    let denominator = direction.perp_dot(edge);
    if denominator.abs() < 1e-12 {
        return None;
    }
    let distance = from.perp_dot(edge) / denominator;
    let along = from.perp_dot(direction) / denominator;
    (distance > 0.0 && (-1e-4..=1.0001).contains(&along)).then_some(distance)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use image::Rgb;

    use super::*;
    use crate::{pose::CameraPose, test_scene};

    /// Returns the fraction of carpet classified as outside, and that of everything else classified as inside, among
    /// pixels that are not near the border.
    fn mistakes(picture: &RgbImage, pose: CameraPose) -> (f64, f64) {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let border = BorderDetector::new(&camera).detect(picture, MountPose::of(pose));
        let extent = field.carpet_half_extent_m();
        let (mut carpet, mut lost, mut other, mut kept) = (0.0, 0.0, 0.0, 0.0);
        for (u, v, _) in picture.enumerate_pixels() {
            let on_carpet = |scale: f64| {
                camera
                    .unproject_to_ground(pose, DVec2::new(f64::from(u), f64::from(v)))
                    .is_ok_and(|ground| (ground.abs() - scale * extent).max_element() < 0.0)
            };
            match (on_carpet(0.93), on_carpet(1.12)) {
                (true, _) => {
                    (carpet, lost) = (carpet + 1.0, lost + f64::from(u8::from(!border.contains(u, v))));
                }
                (_, false) => {
                    (other, kept) = (other + 1.0, kept + f64::from(u8::from(border.contains(u, v))));
                }
                _ => (),
            }
        }
        (lost / carpet, kept / other)
    }

    /// Draws into a picture, and asserts that its border loses little of the carpet and keeps little of the hall.
    fn assert_border(pose: CameraPose, most_lost: f64, draw: impl Fn(&mut RgbImage)) {
        let mut picture = test_scene::render(&test_scene::fisheye(), pose, &test_scene::field());
        draw(&mut picture);
        let (lost, kept) = mistakes(&picture, pose);
        assert!(lost < most_lost && kept < 0.03, "{lost} of the carpet lost, {kept} of the hall kept");
    }

    #[test]
    fn carpet_is_inside_and_the_hall_is_outside() {
        for pose in test_scene::poses() {
            assert_border(pose, 0.03, |_| ());
        }
    }

    #[test]
    fn a_robot_in_front_does_not_move_the_border() {
        assert_border(test_scene::poses()[0], 0.03, |picture| {
            for (u, v) in (140..180).flat_map(|u| (40..190).map(move |v| (u, v))) {
                picture.put_pixel(u, v, Rgb([30, 30, 90]));
            }
        });
    }

    /// Red and blue fall to a fifth from one side of the picture to the other, as with some lenses and cheap sensors.
    #[test]
    fn a_tint_from_one_side_to_the_other_hides_no_carpet() {
        for pose in test_scene::poses() {
            assert_border(pose, 0.08, |picture| {
                for (u, _, pixel) in picture.enumerate_pixels_mut() {
                    let gain = 1.0 - 0.8 * u as f32 / 320.0;
                    for channel in [0, 2] {
                        pixel.0[channel] = (gain * f32::from(pixel.0[channel])) as u8;
                    }
                }
            });
        }
    }

    /// Most of what is near is the robot's own grey shoulder.
    #[test]
    fn the_robot_s_shoulder_is_not_the_carpet() {
        for pose in test_scene::poses() {
            assert_border(pose, 0.03, |picture| {
                for (u, v, pixel) in picture.enumerate_pixels_mut() {
                    if DVec2::new(f64::from(u), f64::from(v)).distance(DVec2::new(160.0, 270.0)) < 150.0 {
                        *pixel = Rgb([62, 66, 64]);
                    }
                }
            });
        }
    }

    #[test]
    fn the_carpet_need_not_be_green() {
        assert_border(test_scene::poses()[1], 0.03, |picture| {
            picture.pixels_mut().for_each(|pixel| pixel.0.swap(0, 1));
        });
    }

    #[test]
    fn a_picture_without_carpet_has_some_border() {
        for value in [0, 255] {
            let flat = RgbImage::from_pixel(320, 240, Rgb([value; 3]));
            let pose = test_scene::poses()[1];
            BorderDetector::new(&test_scene::fisheye()).detect(&flat, MountPose::of(pose));
        }
    }

    #[test]
    fn a_hull_is_convex_and_holds_all_points() {
        let points: Vec<Vec2> =
            (0..200).map(|i| Vec2::from_angle(i as f32) * ((i * 37 % 101) as f32)).collect();
        let hull = convex_hull(points.clone());
        for i in 0..hull.len() {
            let (from, to) = (hull[i], hull[(i + 1) % hull.len()]);
            assert!(points.iter().all(|point| (to - from).perp_dot(*point - from) >= -1e-2));
        }
    }
}
