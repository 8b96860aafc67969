//! What a camera makes of light that is added to a picture that it recorded: the light of things that were not there passes
//! the lens, the sensor and the encoding, and so joins a picture that has passed them already.

use glam::DVec2;
use image::RgbImage;
use reality_sim_core::filter::{Purpose, Stream};

use crate::{blur::weights, chain::Chain, light_tile::LightTile, noise::noise_stream, sharpening::RADIUS_PX};

/// Number of linear values that are encoded in advance; their square roots are evenly spaced, and values between them are
/// interpolated to a hundredth of a grey level.
const LEVELS: usize = 2048;
/// Number of distances from the principal point for which the blur is known, up to twice half the picture's diagonal: the
/// variance in between differs by less than a hundredth of that in a corner.
const RADII: usize = 128;
/// Largest distance from the principal point, half diagonals: that of a corner when it lies in the opposite one.
const FARTHEST_RADIUS: f64 = 2.0;
/// Number of pixels in a row that are blurred alike.
const SEGMENT_PX: usize = 8;
/// Reach of a blur, pixels; wider ones, which no camera has whose pictures show anything, are cut.
const LONGEST_REACH_PX: usize = 64;
/// Number of normal numbers that the noise is drawn from; a power of two.
const NORMALS: usize = 1 << 15;
/// Share of a pixel that must change for it to be encoded anew: less changes no grey level.
const LEAST_SHARE: f32 = 1e-3;

/// Camera that adds light to its pictures. Make it once: it keeps what it knows of every pixel.
#[derive(Debug, Clone)]
pub struct Development {
    chain: Chain,
    /// Linear values of the 256 encoded ones, before the sensor's response.
    linear: Vec<f32>,
    /// Encoded values, 0 to 255.
    encoded: Vec<f32>,
    /// Share of the light that reaches each pixel; empty where all of it does.
    falloff: Vec<f32>,
    /// Weights of a pixel and of its neighbours on one side, by the distance from the principal point; a single one where the
    /// blur is the same everywhere.
    blurs: Vec<Vec<f32>>,
    /// Weights of the sharpening's mask; empty without one.
    mask: Vec<f32>,
    reach_px: usize,
    normals: Vec<f32>,
}

/// One picture of a [`Development`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposure {
    /// Gain of red, green and blue.
    pub gain: [f32; 3],
    /// Light that the lens spreads over the whole picture, linear, before the gain.
    pub veil: [f32; 3],
    /// Seed of the noise; `None` adds none.
    pub noise_seed: Option<u64>,
    /// Time of the picture, seconds: pictures at different times have different noise.
    pub time_s: f64,
}

impl Development {
    /// Prepares a camera.
    pub fn new(chain: &Chain) -> Self {
        let camera = chain.camera();
        let encode = |linear: f64| 255.0 * chain.encode(chain.respond(linear));
        let level = |level: usize| (level as f64 / (LEVELS - 1) as f64).powi(2);
        let pixels = (0..camera.height).flat_map(|v| (0..camera.width).map(move |u| [u, v]));
        let falloff: Vec<f32> =
            pixels.map(|[u, v]| chain.falloff(DVec2::new(u.into(), v.into())) as f32).collect();
        let blurs = blurs(chain);
        let mask = if chain.sharpening() == 0.0 { Vec::new() } else { short(weights(RADIUS_PX * RADIUS_PX)) };
        let longest = blurs.iter().map(Vec::len).max().unwrap_or(1);
        let stream = Stream::new(0, Purpose::Picture, 0, 0);
        let normals = (0..NORMALS as u32 / 4).flat_map(|index| stream.normals(index).into_iter().take(4));
        Self {
            linear: chain.linear_values(),
            encoded: (0..LEVELS).map(|index| encode(level(index)) as f32).collect(),
            falloff: if falloff.iter().all(|share| *share == 1.0) { Vec::new() } else { falloff },
            reach_px: longest - 1 + mask.len().saturating_sub(1),
            normals: normals.map(|normal| normal as f32).collect(),
            chain: chain.clone(),
            blurs,
            mask,
        }
    }

    /// Returns the camera.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Returns how far beside its place light may change a picture, pixels: tiles have this margin around what is drawn.
    pub fn reach_px(&self) -> usize {
        self.reach_px
    }

    /// Returns the linear value, before the sensor's response, that is encoded as this one.
    pub fn linear(&self, value: u8) -> f32 {
        self.linear[usize::from(value)]
    }

    /// Returns the share of the light that reaches a pixel, counted row by row.
    pub fn falloff(&self, pixel: usize) -> f32 {
        self.falloff.get(pixel).copied().unwrap_or(1.0)
    }

    /// Prepares the picture with this timestamp, seconds, to which light is added. Adds noise if a seed is given.
    pub fn exposure(&self, picture: &RgbImage, time_s: f64, noise_seed: Option<u64>) -> Exposure {
        let gain = self.chain.gain(time_s).map(|gain| gain as f32);
        let glare = self.chain.glare();
        if glare == 0.0 {
            return Exposure { gain, veil: [0.0; 3], noise_seed, time_s };
        }
        let mut counts = [[0_u32; 256]; 3];
        for pixel in picture.pixels() {
            counts.iter_mut().zip(pixel.0).for_each(|(counts, value)| counts[usize::from(value)] += 1);
        }
        let pixels = f64::from(picture.width() * picture.height()).max(1.0);
        let veil = [0, 1, 2].map(|channel| {
            let values = counts[channel].iter().zip(&self.linear);
            let sum: f64 = values.map(|(count, linear)| f64::from(*count) * f64::from(*linear)).sum();
            // The recorded light contains its own veil.
            (glare / (1.0 + glare) * sum / pixels) as f32 / gain[channel].max(f32::MIN_POSITIVE)
        });
        Exposure { gain, veil, noise_seed, time_s }
    }

    /// Returns the colour of a pixel when it gets this share of its light.
    pub fn darkened(&self, color: [u8; 3], share: f32) -> [u8; 3] {
        color.map(|value| rounded(self.encode(share * self.linear(value))))
    }

    /// Develops the light of a tile and puts it over the recorded picture; returns the tile's pixels, row by row.
    ///
    /// # Panics
    ///
    /// Panics if the tile lies outside the picture, or the picture does not have the camera's size.
    pub fn compose(&self, tile: &mut LightTile, picture: &RgbImage, exposure: &Exposure) -> Vec<[u8; 3]> {
        self.pass_lens(tile);
        let recorded = recorded(tile, picture);
        let mut values: Vec<[f32; 3]> = Vec::with_capacity(recorded.len());
        for (row, colors) in recorded.chunks(tile.width.max(1)).enumerate() {
            let v = tile.top + row;
            let mut noise =
                exposure.noise_seed.map(|seed| self.noise_of_row(seed, exposure.time_s, v, tile.left));
            for (column, color) in colors.iter().enumerate() {
                let normals =
                    noise.as_mut().map_or([0.0; 3], |noise| [0; 3].map(|_| noise.next().unwrap_or(0.0)));
                values.push(self.over(tile, row * tile.width + column, *color, exposure, normals));
            }
        }
        if !self.mask.is_empty() {
            self.sharpen(tile, &recorded, &mut values);
        }
        values.into_iter().map(|value| value.map(rounded)).collect()
    }

    /// Darkens the light by the lens's falloff and blurs it.
    fn pass_lens(&self, tile: &mut LightTile) {
        if !self.falloff.is_empty() {
            let width = self.chain.camera().width as usize;
            for row in 0..tile.height {
                let first = (tile.top + row) * width + tile.left;
                let falloff = &self.falloff[first..first + tile.width];
                for plane in &mut tile.color {
                    let light = &mut plane[row * tile.width..(row + 1) * tile.width];
                    light.iter_mut().zip(falloff).for_each(|(light, share)| *light *= share);
                }
            }
        }
        if self.blurs.len() == 1 && self.blurs[0].len() == 1 {
            return;
        }
        let (left, top) = (tile.left as f64, tile.top as f64);
        // A blur that is the same everywhere takes whole rows at once.
        let segment = if self.blurs.len() == 1 { tile.width } else { SEGMENT_PX };
        tile.blur(segment, |column, row| self.blur_at(DVec2::new(left + column, top + row)));
    }

    fn blur_at(&self, pixel: DVec2) -> &[f32] {
        let last = self.blurs.len() - 1;
        let index = (self.chain.radius(pixel) / FARTHEST_RADIUS * last as f64).round() as usize;
        &self.blurs[index.min(last)]
    }

    /// Returns the encoded value, 0 to 255, of a tile's pixel over the recorded one.
    fn over(
        &self,
        tile: &LightTile,
        index: usize,
        recorded: [u8; 3],
        exposure: &Exposure,
        normals: [f32; 3],
    ) -> [f32; 3] {
        if !tile.is_touched(index, LEAST_SHARE) {
            return recorded.map(f32::from);
        }
        std::array::from_fn(|channel| {
            let (gain, veil) = (exposure.gain[channel], exposure.gain[channel] * exposure.veil[channel]);
            let seen = self.linear(recorded[channel]);
            let kept = 1.0 - tile.cover(channel)[index];
            let linear = veil + kept * (seen - veil) + gain * tile.color[channel][index];
            self.encode(linear + normals[channel] * self.missing_noise(linear, seen, kept))
        })
    }

    /// Returns the standard deviation of the noise that a linear value lacks, of which a recorded one makes up this part.
    fn missing_noise(&self, linear: f32, recorded: f32, part: f32) -> f32 {
        let noise = self.chain.noise();
        let variance = |value: f32| noise.variance(f64::from(value)) as f32;
        (variance(linear) - part * part * variance(recorded)).max(0.0).sqrt()
    }

    fn noise_of_row(&self, seed: u64, time_s: f64, v: usize, left: usize) -> impl Iterator<Item = f32> {
        let stream = noise_stream(seed, time_s, 1);
        let first = stream.words(v as u32, 0)[0] as usize + 3 * left;
        (first..).map(|index| self.normals[index % NORMALS])
    }

    /// Encodes a linear value before the sensor's response: 0 to 255, not rounded.
    fn encode(&self, linear: f32) -> f32 {
        let place = linear.clamp(0.0, 1.0).sqrt() * (LEVELS - 1) as f32;
        let below = (place as usize).min(LEVELS - 2);
        let part = place - below as f32;
        self.encoded[below] + part * (self.encoded[below + 1] - self.encoded[below])
    }

    /// Sharpens what the tile changed: the recorded picture was sharpened when it was taken.
    fn sharpen(&self, tile: &LightTile, recorded: &[[u8; 3]], values: &mut [[f32; 3]]) {
        let change = |channel: usize| {
            let pairs = values.iter().zip(recorded);
            pairs.map(|(value, color)| value[channel] - f32::from(color[channel])).collect::<Vec<f32>>()
        };
        let color = [0, 1, 2].map(change);
        let mut smooth = LightTile { color: color.clone(), cover: Vec::new(), ..*tile };
        smooth.blur(tile.width, |_, _| &self.mask);
        let amount = self.chain.sharpening() as f32;
        for (index, value) in values.iter_mut().enumerate() {
            for channel in 0..3 {
                value[channel] += amount * (color[channel][index] - smooth.color[channel][index]);
            }
        }
    }
}

/// Rounds an encoded value. A cast is faster than `round`, which is a call on processors of the baseline.
fn rounded(value: f32) -> u8 {
    (value.clamp(0.0, 255.0) + 0.5) as u8
}

/// Returns the tile's pixels in the picture, row by row.
fn recorded(tile: &LightTile, picture: &RgbImage) -> Vec<[u8; 3]> {
    let (colors, _) = picture.as_chunks::<3>();
    let width = picture.width() as usize;
    let rows = (tile.top..tile.top + tile.height).map(|v| v * width + tile.left);
    rows.flat_map(|first| colors[first..first + tile.width].iter().copied()).collect()
}

/// Returns the blur at distances from the principal point, from 0 to [`FARTHEST_RADIUS`].
fn blurs(chain: &Chain) -> Vec<Vec<f32>> {
    let variance_px2 =
        |index: usize| chain.psf_variance_at_radius_px2(FARTHEST_RADIUS * index as f64 / (RADII - 1) as f64);
    let variances: Vec<f64> = (0..RADII).map(variance_px2).collect();
    let count = if variances.iter().all(|variance| *variance == variances[0]) { 1 } else { RADII };
    variances[..count].iter().map(|variance| short(weights(*variance))).collect()
}

/// Cuts a kernel to the longest reach.
fn short(mut weights: Vec<f32>) -> Vec<f32> {
    weights.truncate(LONGEST_REACH_PX + 1);
    let sum = 2.0 * weights.iter().sum::<f32>() - weights[0];
    weights.iter_mut().for_each(|weight| *weight /= sum);
    while weights.len() > 1 && weights.last().is_some_and(|last| *last < 1e-5) {
        weights.pop();
    }
    weights
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Camera, Distortion},
        field::FieldDimensions,
        sequence::CameraSetup,
    };

    use super::*;
    use crate::{Model, effect};

    fn development(effects: &[(&str, &[f64])]) -> Development {
        let camera = Camera::new([64, 48], [50.0, 50.0, 31.5, 23.5], Distortion::Pinhole).unwrap();
        let setup = CameraSetup { camera, mount_height_m: 0.5, photometry: None };
        let with =
            |model: Model, (id, values): &(&str, &[f64])| model.with(effect(id).unwrap(), values.to_vec());
        let model = effects.iter().fold(Model::default(), with);
        Development::new(&Chain::new(&setup, &FieldDimensions::preset("spl").unwrap(), &model).unwrap())
    }

    fn gradient() -> RgbImage {
        RgbImage::from_fn(64, 48, |u, v| image::Rgb([40 + 2 * u as u8, 90 + v as u8, 250]))
    }

    /// Returns a tile in the middle of the picture with a patch in it.
    fn patch(light: f32, cover: f32) -> LightTile {
        let mut tile = LightTile::empty([16, 12], [32, 24], false);
        for (row, column) in (8..16).flat_map(|row| (10..22).map(move |column| (row, column))) {
            tile.color.iter_mut().for_each(|plane| plane[row * 32 + column] = light);
            tile.cover[0][row * 32 + column] = cover;
        }
        tile
    }

    fn composed(development: &Development, mut tile: LightTile, noise_seed: Option<u64>) -> Vec<[u8; 3]> {
        let exposure = development.exposure(&gradient(), 1.0, noise_seed);
        development.compose(&mut tile, &gradient(), &exposure)
    }

    #[test]
    fn light_that_covers_nothing_leaves_every_camera_s_picture_as_it_is() {
        let cameras: [&[(&str, &[f64])]; 4] = [
            &[],
            &[("defocus", &[1.5]), ("vignetting", &[0.5])],
            &[("sensor_noise", &[0.01, 1e-4]), ("tone_curve", &[0.4])],
            &[("sharpening", &[0.7]), ("veiling_glare", &[0.3]), ("black_level", &[0.05])],
        ];
        for effects in cameras {
            let development = development(effects);
            let tile = LightTile::empty([16, 12], [32, 24], false);
            let pixels = composed(&development, tile.clone(), Some(3));
            assert_eq!(pixels, recorded(&tile, &gradient()), "{effects:?}");
        }
    }

    #[test]
    fn opaque_light_is_recorded_as_the_camera_records_it_and_half_of_it_is_mixed_in_linear_light() {
        let development = development(&[("tone_curve", &[0.3]), ("black_level", &[0.02])]);
        let value = |linear: f64| {
            let chain = development.chain();
            (255.0 * chain.encode(chain.respond(linear))).round() as u8
        };
        let middle = 12 * 32 + 16;
        assert!(
            composed(&development, patch(0.3, 1.0), None)[middle].iter().all(|v| v.abs_diff(value(0.3)) <= 1)
        );
        let seen = gradient().get_pixel(32, 24).0;
        let half = composed(&development, patch(0.15, 0.5), None)[middle];
        for channel in 0..3 {
            let mixed = 0.15 + 0.5 * f64::from(development.linear(seen[channel]));
            assert!(half[channel].abs_diff(value(mixed)) <= 1, "{half:?}");
        }
    }

    #[test]
    fn a_blur_keeps_the_light_and_stays_within_the_reach() {
        let development = development(&[("defocus", &[1.1])]);
        let mut tile = patch(0.3, 1.0);
        let sum = |tile: &LightTile| tile.color[1].iter().sum::<f32>();
        let before = sum(&tile);
        development.pass_lens(&mut tile);
        assert!((sum(&tile) / before - 1.0).abs() < 1e-4);
        let reach = development.reach_px();
        assert!((4..8).contains(&reach), "{reach}");
        let at = |row: usize, column: usize| tile.cover[0][row * 32 + column];
        assert!(at(12, 9) > 0.2 && at(12, 9) < 0.4 && (at(12, 9) + at(12, 10) - 1.0).abs() < 5e-3);
        assert_eq!(at(12, 10 - reach - 1), 0.0);
    }

    #[test]
    fn values_are_encoded_to_a_hundredth_of_a_grey_level() {
        let development = development(&[("tone_curve", &[0.4])]);
        for step in 4..1000 {
            let linear = (f64::from(step) / 1000.0).powi(2);
            let exact = 255.0 * development.chain().encode(linear);
            assert!((f64::from(development.encode(linear as f32)) - exact).abs() < 0.01, "{linear}");
        }
    }

    #[test]
    fn noise_is_that_of_its_seed_and_its_time() {
        let development = development(&[("sensor_noise", &[0.01, 1e-4])]);
        let with = |seed: u64| composed(&development, patch(0.3, 1.0), Some(seed));
        assert_eq!(with(1), with(1));
        assert_ne!(with(1), with(2));
    }
}
