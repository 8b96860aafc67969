//! The ball in a picture, and where it lies on the ground.

use reality_sim::{
    Camera, CameraPose,
    glam::{DVec2, DVec3},
    image::{Rgb, RgbImage},
};

/// Red over green and over blue from which a pixel may belong to the ball. Paint that reflects 0.8 and 0.03 keeps more than this
/// where it mirrors the lamps, and half of a pixel of carpet takes it below.
const RED_OVER: f64 = 1.5;
/// Red over green and over blue from which it can be nothing else, and the share of a ball's pixels that are as red: those of an
/// orange ball, such as lies in the demonstration walk's hall, reach 1.9.
const CLEARLY_RED_OVER: f64 = 2.2;
const CLEARLY_RED_PART: f64 = 0.5;
/// Red below which a pixel is too dark to tell, of 255.
const LEAST_RED: u8 = 40;
/// Smallest number of pixels of a ball: at fewer, its size says nothing.
const LEAST_PIXELS: usize = 20;
/// Share by which the ball's size in the picture may differ from that of a ball at its place.
const SIZE_TOLERANCE: f64 = 0.3;

/// Eye for red balls of a size.
#[derive(Debug, Clone)]
pub struct BallSeeing {
    camera: Camera,
    radius_m: f64,
}

/// Ball as a picture shows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenBall {
    /// Place on the ground, metres.
    pub place_in_world: DVec2,
    /// Number of pixels.
    pub pixels: usize,
}

impl BallSeeing {
    /// Makes an eye behind a lens.
    pub fn new(camera: Camera, radius_m: f64) -> Self {
        Self { camera, radius_m }
    }

    /// Finds the ball in a picture that was taken at a pose: of all that look like it, the one with most pixels.
    pub fn find(&self, picture: &RgbImage, pose: CameraPose) -> Option<SeenBall> {
        let spots = red_spots(picture);
        let is_clear = |spot: &&Vec<[u32; 2]>| {
            let clear = spot.iter().filter(|[x, y]| is_red(picture.get_pixel(*x, *y), CLEARLY_RED_OVER));
            clear.count() as f64 >= CLEARLY_RED_PART * spot.len() as f64
        };
        let seen =
            spots.iter().filter(is_clear).filter_map(|spot| self.ball_at(spot, picture.dimensions(), pose));
        seen.max_by_key(|seen| seen.pixels)
    }

    /// Returns where a red spot lies if it is a ball.
    fn ball_at(&self, spot: &[[u32; 2]], (width, height): (u32, u32), pose: CameraPose) -> Option<SeenBall> {
        let at_edge = |&[x, y]: &[u32; 2]| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        if spot.len() < LEAST_PIXELS || spot.iter().any(at_edge) {
            return None;
        }
        let rays = spot.iter().map(|&[x, y]| self.camera.unproject(DVec2::new(x.into(), y.into())));
        let rays: Vec<DVec3> = rays.collect::<Result<_, _>>().ok()?;
        // The rays that meet a ball fill a cone around its centre.
        let axis = rays.iter().sum::<DVec3>().try_normalize()?;
        let mean_cosine = rays.iter().map(|ray| ray.dot(axis)).sum::<f64>() / rays.len() as f64;
        // Of rays that fill a cone evenly, the mean cosine lies half-way between 1 and that of its edge.
        let edge_cosine = 2.0 * mean_cosine - 1.0;
        let sine = (1.0 - edge_cosine * edge_cosine).max(0.0).sqrt();

        let direction = pose.rotation_world_from_camera() * axis;
        let distance_m = (self.radius_m - pose.height_m) / direction.z;
        if direction.z >= 0.0 || distance_m <= self.radius_m {
            return None;
        }
        let expected = self.radius_m / distance_m;
        let is_of_size = (sine / expected - 1.0).abs() < SIZE_TOLERANCE;
        let place = pose.position_in_world() + distance_m * direction;
        is_of_size.then_some(SeenBall { place_in_world: place.truncate(), pixels: spot.len() })
    }
}

fn is_red(&Rgb([red, green, blue]): &Rgb<u8>, over: f64) -> bool {
    red >= LEAST_RED && f64::from(red) > over * f64::from(green.max(blue))
}

/// Returns the pixels of each connected red spot.
fn red_spots(picture: &RgbImage) -> Vec<Vec<[u32; 2]>> {
    let (width, height) = picture.dimensions();
    let mut left: Vec<bool> = picture.pixels().map(|pixel| is_red(pixel, RED_OVER)).collect();
    let index = |[x, y]: [u32; 2]| (y * width + x) as usize;
    let mut spots = Vec::new();
    for y in 0..height {
        for x in 0..width {
            if !std::mem::take(&mut left[index([x, y])]) {
                continue;
            }
            let mut spot = vec![[x, y]];
            let mut next = 0;
            while let Some(&[x, y]) = spot.get(next) {
                next += 1;
                for near in [[x.wrapping_sub(1), y], [x + 1, y], [x, y.wrapping_sub(1)], [x, y + 1]] {
                    if near[0] < width && near[1] < height && std::mem::take(&mut left[index(near)]) {
                        spot.push(near);
                    }
                }
            }
            spots.push(spot);
        }
    }
    spots
}
