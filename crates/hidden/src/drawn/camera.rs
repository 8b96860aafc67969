//! Lenses and sensors.

use glam::DVec2;

use crate::{
    blur::{PointSpread, Shape},
    jpeg::Storage,
    lens::{Bend, Lens},
    nominal::{Light, rounded},
    random::Random,
};

/// Bend of a fisheye, which is drawn stronger and weaker.
const FISHEYE: [f64; 4] = [-0.0663, 0.00994, -0.001_103, 0.000_054_6];

/// Draws a lens: half are fisheyes of 110 to 170° across the picture, a third perspective lenses of 60 to 95° that bend,
/// others pinholes of 55 to 80°.
pub fn lens(random: &mut Random, size: [u32; 2]) -> Lens {
    let [width, height] = size.map(f64::from);
    let half_width = width / 2.0;
    let kind = random.uniform();
    let (focal_px, bend, p) = if kind < 0.5 {
        let half_rad = random.between(55.0, 85.0).to_radians();
        let strength = random.between(0.5, 1.3);
        let k = FISHEYE.map(|k| rounded(k * strength, 1e9));
        let square = half_rad * half_rad;
        let bent = 1.0 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3])));
        (half_width / (half_rad * bent), Bend::Fisheye(k), [0.0; 2])
    } else if kind < 0.83 {
        let tangent = random.between(30.0, 47.5).to_radians().tan();
        // Bends are drawn for the corner, and taken at 1.3 half widths for any shape of picture.
        let corner = 1.3 * tangent;
        let k1 = random.between(-0.2, 0.03) / (corner * corner);
        let k2 = random.between(0.0, 0.04) / corner.powi(4);
        let (k1, k2) = (rounded(k1, 1e8), rounded(k2, 1e8));
        let square = tangent * tangent;
        let bent = 1.0 + square * (k1 + square * k2);
        let p = [0.0; 2].map(|_: f64| rounded(random.between(-8e-4, 8e-4), 1e8));
        (half_width / (tangent * bent), Bend::Perspective([k1, k2]), p)
    } else {
        let tangent = random.between(27.5, 40.0).to_radians().tan();
        (half_width / tangent, Bend::Perspective([0.0; 2]), [0.0; 2])
    };
    let off = DVec2::new(random.between(-0.02, 0.02), random.between(-0.02, 0.02)) * width;
    let center_px = DVec2::new(width - 1.0, height - 1.0) / 2.0 + off;
    Lens { focal_px: rounded(focal_px, 1e4), center_px: center_px.map(|value| rounded(value, 1e3)), bend, p }
}

/// Returns the range of pitches at which the upper edge of the picture is about the horizon and the lower one on the carpet.
pub fn look_down_rad(lens: &Lens, [width, _]: [u32; 2]) -> [f64; 2] {
    let top = DVec2::new(f64::from(width) / 2.0, 0.0);
    let ray = lens.ray(top, lens.largest_radius());
    let half_rad = ray.map_or(0.5, |ray| (-ray.y).atan2(ray.z));
    let middle = (0.75 * half_rad).clamp(0.26, 0.48);
    [middle - 0.02, middle + 0.08]
}

/// Draws colours, tone, noise, point spread and storage.
pub fn sensor(random: &mut Random) -> (Light, PointSpread, Storage) {
    let carpet_rgb = carpet_rgb(random);
    let white = random.between(0.42, 0.75);
    let line_rgb = [0.0; 3].map(|_: f64| white * random.between(0.96, 1.04));
    let sigma_px = random.between(0.3, 1.1);
    let shape = match random.uniform() {
        kind if kind < 0.25 => Shape::Disc,
        kind if kind < 0.5 => {
            let (share, wider) = (random.between(0.02, 0.06), random.between(2.0, 4.0));
            Shape::Tail { share, sigma_px: wider }
        }
        _ => Shape::Gaussian,
    };
    let light = Light {
        line_rgb,
        carpet_rgb,
        gamma: rounded(random.between(1.8, 2.4), 1e2),
        noise_shot: 0.001 * random.between(-0.7, 1.1).exp(),
        noise_read: 0.003 * random.between(-0.7, 0.7).exp(),
        psf_sigma_px: sigma_px,
    };
    let storage = if random.uniform() < 0.1 {
        Storage::Png
    } else {
        let quality = 75 + random.below(23) as u8;
        Storage::Jpeg { quality, halves_color: random.uniform() < 0.7 }
    };
    (light, PointSpread { sigma_px, shape }, storage)
}

/// Draws the carpet's mean colour: mostly green, from dark to light, one of ten blue-grey.
fn carpet_rgb(random: &mut Random) -> [f64; 3] {
    let brightness = 0.14 * random.between(-0.8, 0.6).exp();
    if random.uniform() < 0.1 {
        let grey = random.between(0.6, 0.8);
        return [brightness * grey * 0.8, brightness * grey, brightness * random.between(0.9, 1.2)];
    }
    [brightness * random.between(0.2, 0.55), brightness, brightness * random.between(0.25, 0.6)]
}
