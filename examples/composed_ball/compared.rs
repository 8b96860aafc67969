//! A composed ball against the true one.

use glam::{DVec2, DVec3, Vec3};
use image::{RgbImage, imageops::crop_imm};
use reality_sim::{
    Camera,
    evaluation::percentile,
    preprocess::luma,
    synthesis::quality::{psnr_db, ssim},
};

use crate::probes::Probe;

/// Parts of the ball's own redness from and to which a pixel belongs to it. Its dark lower side has a third of it, lines, carpet
/// and shadows next to none.
const BALL_SHARES: [f64; 2] = [0.08, 0.32];
/// Parts of the ball's radius: inside the first there is nothing but the ball, outside the last none of it.
const INSIDE: f64 = 0.85;
const OUTSIDE: f64 = 1.15;
/// Half the side of the surroundings that are compared, in radii of the ball.
const SURROUNDINGS: f64 = 3.0;
/// Smallest radius of a ball that is compared, pixels.
const LEAST_RADIUS_PX: f64 = 3.0;
/// Gamma of the probes' camera.
const GAMMA: f32 = 2.2;

/// Comparison of one ball.
pub struct Compared {
    /// Distance between the centroids, pixels.
    pub place_px: f64,
    /// Diameter against the true one.
    pub size: f64,
    pub ssim: Option<f64>,
    pub psnr_db: Option<f64>,
    /// Mean squared difference around the ball's outline, grey levels².
    pub edge_error: f64,
    /// Mean linear colours inside: composed and true.
    pub colors: [Vec3; 2],
    /// Standard deviation of the noise inside, against the true one.
    pub noise: f64,
    /// Mean squared difference inside, grey levels².
    pub inner_error: f64,
}

impl Probe {
    /// Compares a composed ball with the true one; `None` where the ball or its surroundings are not wholly in the picture, or
    /// something hides it.
    pub fn compare(&self, lens: &Camera, without: &RgbImage, with: &RgbImage) -> Option<Compared> {
        let center = DVec3::from_array(self.ball);
        let at = self.pose.camera_from_world(center);
        let middle = lens.project(at).ok()?;
        let radius_px = lens.fx * self.ball[2] / at.length();
        let half = (SURROUNDINGS * radius_px).max(12.0);
        let corners = [middle - half, middle + half];
        let is_seen =
            radius_px >= LEAST_RADIUS_PX && corners.iter().all(|pixel| lens.check_inside(*pixel).is_ok());
        if !is_seen {
            return None;
        }
        let (left, top, side) = (corners[0].x as u32, corners[0].y as u32, (2.0 * half) as u32);
        let crop = |picture: &RgbImage| crop_imm(picture, left, top, side, side).to_image();
        let [empty, truth, without, with] = [&self.empty, &self.truth, without, with].map(crop);
        let middle = middle - DVec2::new(left.into(), top.into());
        let ring =
            |pixel: DVec2, from: f64, to: f64| (from..to).contains(&(pixel.distance(middle) / radius_px));
        let is_inside = |pixel: DVec2| ring(pixel, 0.0, INSIDE);
        let (true_place, true_area) = ball(&empty, &truth, is_inside);
        let (place, area) = ball(&without, &with, is_inside);
        let expected = std::f64::consts::PI * radius_px * radius_px;
        if !(0.7..1.5).contains(&(true_area / expected)) {
            return None;
        }
        let [noise, true_noise] = [&with, &truth].map(|picture| noise(picture, |p| ring(p, 0.0, INSIDE)));
        Some(Compared {
            place_px: place.distance(true_place),
            size: (area / true_area).sqrt(),
            ssim: ssim(&luma(&with), &luma(&truth)),
            psnr_db: psnr_db(&with, &truth, None),
            edge_error: squared(&with, &truth, |p| ring(p, INSIDE, OUTSIDE)),
            colors: [&with, &truth].map(|picture| mean(picture, &truth, |p| ring(p, 0.0, INSIDE))),
            noise: noise / true_noise.max(1e-6),
            inner_error: squared(&with, &truth, |p| ring(p, 0.0, INSIDE)),
        })
    }
}

fn pixels(picture: &RgbImage) -> impl Iterator<Item = (DVec2, [u8; 3])> {
    picture.enumerate_pixels().map(|(u, v, pixel)| (DVec2::new(u.into(), v.into()), pixel.0))
}

/// Returns centroid and area of what has got redder against blue: the orange ball without its shadow.
fn ball(without: &RgbImage, with: &RgbImage, is_inside: impl Fn(DVec2) -> bool) -> (DVec2, f64) {
    let redness = |color: [u8; 3]| f64::from(color[0]) - f64::from(color[2]);
    let changes: Vec<(DVec2, f64)> = pixels(without)
        .zip(pixels(with))
        .map(|((place, a), (_, b))| (place, redness(b) - redness(a)))
        .collect();
    let inside = changes.iter().filter(|(place, _)| is_inside(*place));
    let mut inside: Vec<f64> = inside.map(|(_, change)| *change).collect();
    inside.sort_by(f64::total_cmp);
    let level = percentile(&inside, 0.5).unwrap_or(0.0).max(1.0);
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (place, change) in changes {
        let [least, most] = BALL_SHARES;
        let share = ((change / level - least) / (most - least)).clamp(0.0, 1.0);
        sum += share * place;
        area += share;
    }
    (sum / area.max(1e-9), area)
}

fn squared(a: &RgbImage, b: &RgbImage, is_of: impl Fn(DVec2) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for ((_, a), (_, b)) in pixels(a).zip(pixels(b)).filter(|((place, _), _)| is_of(*place)) {
        sum += (0..3).map(|c| f64::from(a[c].abs_diff(b[c])).powi(2)).sum::<f64>() / 3.0;
        count += 1.0;
    }
    sum / count.max(1.0)
}

fn linear(value: u8) -> f32 {
    (f32::from(value) / 255.0).powf(GAMMA)
}

/// Returns the mean linear colour, of each channel where the true picture is not clipped.
fn mean(picture: &RgbImage, truth: &RgbImage, is_of: impl Fn(DVec2) -> bool) -> Vec3 {
    let (mut sum, mut count) = (Vec3::ZERO, Vec3::ZERO);
    for ((_, color), (_, truth)) in pixels(picture).zip(pixels(truth)).filter(|((place, _), _)| is_of(*place))
    {
        for channel in (0..3).filter(|channel| truth[*channel] < 250) {
            sum[channel] += linear(color[channel]);
            count[channel] += 1.0;
        }
    }
    sum / count.max(Vec3::ONE)
}

/// Returns the standard deviation of what differs from the mean of four neighbours, green, grey
/// levels.
fn noise(picture: &RgbImage, is_of: impl Fn(DVec2) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for (u, v) in (1..picture.height() - 1).flat_map(|v| (1..picture.width() - 1).map(move |u| (u, v))) {
        if !is_of(DVec2::new(u.into(), v.into())) {
            continue;
        }
        let at = |u: u32, v: u32| f64::from(picture.get_pixel(u, v).0[1]);
        let around = [(u - 1, v), (u + 1, v), (u, v - 1), (u, v + 1)];
        // The difference of a number and the mean of four others has 5/4 of their variance.
        let off = at(u, v) - around.iter().map(|(u, v)| at(*u, *v)).sum::<f64>() / 4.0;
        sum += 0.8 * off * off;
        count += 1.0;
    }
    (sum / count.max(1.0)).sqrt()
}

/// Means over several balls.
pub struct Mean {
    count: usize,
    place_px: f64,
    most_px: f64,
    size: f64,
    ssim: f64,
    psnr_db: f64,
    edge: f64,
    noise: f64,
}

impl Mean {
    pub const HEADER: &str = "| stages | balls | place | largest | size | SSIM | PSNR | edge | noise |\n|---|---|---|---|---|---|---|---|---|";

    pub fn new(all: &[Compared]) -> Self {
        Self {
            count: all.len(),
            place_px: Self::of(all, |compared| compared.place_px),
            most_px: all.iter().map(|compared| compared.place_px).fold(0.0, f64::max),
            size: Self::of(all, |compared| compared.size),
            ssim: Self::of(all, |compared| compared.ssim.unwrap_or(0.0)),
            psnr_db: Self::of(all, |compared| compared.psnr_db.unwrap_or(0.0)),
            edge: Self::of(all, |compared| compared.edge_error).sqrt(),
            noise: Self::of(all, |compared| compared.noise),
        }
    }

    pub fn of(all: &[Compared], value: impl Fn(&Compared) -> f64) -> f64 {
        all.iter().map(value).sum::<f64>() / all.len().max(1) as f64
    }

    /// Returns the true mean colour over the composed one.
    pub fn color_ratio(all: &[Compared]) -> Vec3 {
        let sum = |index: usize| all.iter().map(|compared| compared.colors[index]).sum::<Vec3>();
        sum(1) / sum(0).max(Vec3::splat(1e-6))
    }

    pub fn row(&self, stages: &str) -> String {
        let Self { count, place_px, most_px, size, ssim, psnr_db, edge, noise } = self;
        let percent = 100.0 * (size - 1.0);
        format!(
            "| {stages} | {count} | {place_px:.2} px | {most_px:.2} px | {percent:+.1} % | {ssim:.3} | {psnr_db:.2} dB | {edge:.1} | {noise:.2} |"
        )
    }
}
