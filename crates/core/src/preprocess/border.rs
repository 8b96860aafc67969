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

use super::carpet::{CarpetColor, ColorSum};
use crate::{camera::Camera, mount::MountPose};

/// Side of the square cells into which the picture is divided, pixels.
pub const CELL_PX: u32 = 2;
/// Number of directions around the camera, by pseudo-angle.
const BEARINGS: usize = 360;
/// Number of steps of the ray's sine of depression, from the horizon (0) to straight down (1).
const DEPRESSIONS: usize = 400;
/// Minimum sine of depression: flatter rays end beyond any field, about 40 camera heights away.
const MIN_DEPRESSION: f32 = 0.025;
/// Maximum distance from the camera up to which the carpet's colour is learned, camera heights.
const LEARNING_RADIUS_HEIGHTS: f32 = 8.0;

/// Number of carpet cells at a strip's near end from which the next strip takes its start colour.
const NEAR_CELLS: usize = 8;
/// Step between the cells from which the colour is learned, and between the bearings among which the best one is
/// sought.
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

/// Ray of a cell: its bearing, and the sine of its depression below the horizon.
#[derive(Clone, Copy)]
struct GroundCell {
    bearing: u16,
    depression: f32,
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
        let rays_in_camera = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(r, c)| ray(r, c))
            .collect();
        Self { columns, rows, rays_in_camera }
    }

    /// Finds the border in a picture taken with this mount pose.
    pub fn detect(&self, picture: &RgbImage, mount: MountPose) -> FieldBorder {
        let cells = self.ground_cells(mount);
        let color = |index: usize| {
            let (column, row) = (index as u32 % self.columns, index as u32 / self.columns);
            picture
                .get_pixel(
                    (column * CELL_PX).min(picture.width() - 1),
                    (row * CELL_PX).min(picture.height() - 1),
                )
                .0
        };
        let near = 1.0 / (1.0 + LEARNING_RADIUS_HEIGHTS * LEARNING_RADIUS_HEIGHTS).sqrt();
        let seen = || cells.iter().enumerate().filter_map(|(index, cell)| cell.map(|cell| (index, cell)));
        let carpet = CarpetColor::learn(
            seen()
                .step_by(LEARNING_STEP)
                .filter(|(_, cell)| cell.depression > near)
                .map(|(index, _)| color(index)),
        );
        let mut strips = vec![[ColorSum::default(); DEPRESSIONS]; BEARINGS];
        for (index, cell) in seen() {
            strips[usize::from(cell.bearing)][depression_bin(cell.depression)].add(color(index), &carpet);
        }
        let ends = carpet_ends(&strips, &carpet);
        let mut places = border_points(&ends, mount.height_m as f32);
        // The robot itself stands on the carpet: without its own position, the outline of a narrow view would cut off
        // what lies near.
        places.push(Vec2::ZERO);
        let outline_in_heading = convex_hull(places);
        let limits = hull_depressions(&outline_in_heading, mount.height_m as f32);
        let inside = |cell: &GroundCell| cell.depression >= limits[usize::from(cell.bearing)];
        let depressions =
            cells.iter().map(|cell| cell.filter(inside).map_or(0.0, |cell| cell.depression)).collect();
        FieldBorder { columns: self.columns, depressions, carpet, outline_in_heading }
    }

    fn ground_cells(&self, mount: MountPose) -> Vec<Option<GroundCell>> {
        let rotation = mount.rotation_heading_from_camera().as_mat3();
        debug_assert_eq!(self.rays_in_camera.len(), (self.columns * self.rows) as usize);
        self.rays_in_camera
            .par_iter()
            .map(|&ray| {
                let ray = rotation * glam::Vec3::from(ray);
                (-ray.z >= MIN_DEPRESSION)
                    .then(|| GroundCell { bearing: bearing_bin(ray.truncate()), depression: -ray.z })
            })
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
        for (v, row) in picture.as_flat_samples_mut().samples.chunks_exact_mut(width).enumerate() {
            let first = v / CELL_PX as usize * self.columns as usize;
            let cells = &self.depressions[first..first + self.columns as usize];
            for (pixels, &depression) in row.chunks_mut(CELL_PX as usize).zip(cells) {
                if depression <= 0.0 {
                    pixels.fill(0);
                }
            }
        }
    }
}

/// Returns a number from 0 to 4 that grows with the angle of a direction, without trigonometry.
fn pseudo_angle(direction: Vec2) -> f32 {
    let p = direction.y / (direction.x.abs() + direction.y.abs()).max(f32::MIN_POSITIVE);
    if direction.x < 0.0 {
        2.0 - p
    } else if direction.y < 0.0 {
        4.0 + p
    } else {
        p
    }
}

fn bearing_bin(direction: Vec2) -> u16 {
    ((pseudo_angle(direction) * (BEARINGS as f32 / 4.0)) as usize).min(BEARINGS - 1) as u16
}

/// Returns the direction at the centre of a bearing's bin.
fn bearing_direction(bin: usize) -> Vec2 {
    let p = (bin as f32 + 0.5) * 4.0 / BEARINGS as f32;
    let direction = match p {
        p if p < 1.0 => Vec2::new(1.0 - p, p),
        p if p < 2.0 => Vec2::new(1.0 - p, 2.0 - p),
        p if p < 3.0 => Vec2::new(p - 3.0, 2.0 - p),
        p => Vec2::new(p - 3.0, p - 4.0),
    };
    direction.normalize_or(Vec2::X)
}

fn depression_bin(depression: f32) -> usize {
    ((depression * DEPRESSIONS as f32) as usize).min(DEPRESSIONS - 1)
}

/// Cells from near to far along one bearing.
type Strip = [ColorSum; DEPRESSIONS];

/// Finds where the carpet ends along every bearing. Lens and light change its colour from one side of the picture to
/// the other: starting from the strip that shows the learned colour best, each strip begins with the colour of its
/// neighbour.
fn carpet_ends(strips: &[Strip], carpet: &CarpetColor) -> Vec<Option<f32>> {
    let likeness = |strip: &Strip| -> f32 {
        let near = strip.iter().filter(|cells| cells.mean().is_some_and(|mean| carpet.is_near(mean)));
        near.map(|cells| cells.count).sum()
    };
    let count = strips.len();
    let looked_at = (0..count).step_by(LEARNING_STEP).map(|bin| (bin, likeness(&strips[bin])));
    let first = looked_at.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(bin, _)| bin);
    let mut ends = vec![None; count];
    for side in [1, count - 1] {
        let mut start = *carpet;
        for step in 0..=count / 2 {
            let bin = (first + step * side) % count;
            (ends[bin], start) = farthest_carpet(&strips[bin], start, carpet);
        }
    }
    ends
}

/// Returns the sine of depression that best divides carpet from everything else, along a strip of cells followed from
/// near to far, and the carpet's colour at its near end. The colour that counts as carpet follows gradual changes of
/// light along the strip; a wall, a floor or a robot is a sudden change.
fn farthest_carpet(strip: &Strip, start: CarpetColor, learned: &CarpetColor) -> (Option<f32>, CarpetColor) {
    let (mut local, mut near_end) = (start, start);
    let (mut sum, mut best, mut end) = (0.0, 0.0, None);
    let mut carpet_cells = 0;
    for (bin, cells) in strip.iter().enumerate().rev() {
        let Some(mean) = cells.mean() else { continue };
        if local.is_near(mean) {
            local = local.drifted(mean, learned);
            carpet_cells += 1;
            if carpet_cells == NEAR_CELLS {
                near_end = local;
            }
            sum += cells.count;
            if sum > best {
                (best, end) = (sum, Some(bin));
            }
        } else {
            // The robot's own shoulder may hide the near end: the carpet may begin anywhere.
            sum = (sum - cells.count).max(0.0);
        }
    }
    (end.map(|bin| bin as f32 / DEPRESSIONS as f32), near_end)
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
    use std::f32::consts::TAU;

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
    fn bearings_are_where_their_bins_are() {
        for bin in 0..BEARINGS {
            assert_eq!(usize::from(bearing_bin(bearing_direction(bin))), bin);
        }
        let angle = |bin: usize| bearing_direction(bin).to_angle().rem_euclid(TAU);
        assert!((1..BEARINGS).all(|bin| angle(bin) > angle(bin - 1)));
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
