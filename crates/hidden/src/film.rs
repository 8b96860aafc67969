//! Conversion from light to pixel values: losses in the lens, gains, noise, black level, gamma.

use std::f64::consts::TAU;

use glam::DVec2;
use image::RgbImage;

use crate::{
    blur::smoothed,
    effect::{Course, Falloff, Mistake},
    nominal::Light,
    random::{Deviates, Random},
    truth::Truth,
};

/// Light that dirt on the lens scatters into the picture, linear.
const DIRT_LIGHT: f64 = 0.02;

/// Number of steps of the table of the tone curve, over the square root of the linear value: the curve is steep near 0.
const TONE_STEPS: usize = 1 << 16;

/// Sensor, and those properties of the lens that change brightness only.
pub struct Film {
    truth: Truth,
    light: Light,
    size: [u32; 2],
    /// First and last time of the recording, seconds.
    span_s: [f64; 2],
    /// Transmission of the lens, per pixel.
    transmission: Vec<f32>,
    /// Light added by the lens, per pixel.
    haze: Vec<f32>,
    /// Pixel values over the square root of the linear value, where they are looked up.
    tone: Option<Vec<u8>>,
}

impl Film {
    /// Prepares pictures of this size taken between two times, seconds.
    pub fn new(truth: &Truth, light: Light, size: [u32; 2], span_s: [f64; 2]) -> Self {
        let pixels = (0..size[1]).flat_map(|v| (0..size[0]).map(move |u| DVec2::new(u.into(), v.into())));
        let dirt = |pixel| truth.dirt.iter().map(|dirt| dirt.at(pixel).x).sum::<f64>().min(1.0);
        let (transmission, haze) = pixels
            .map(|pixel| {
                let clean = 1.0 - dirt(pixel);
                ((clean * vignette(truth, pixel, size)) as f32, ((1.0 - clean) * DIRT_LIGHT) as f32)
            })
            .unzip();
        Self { truth: truth.clone(), light, size, span_s, transmission, haze, tone: None }
    }

    /// Takes noise and tone from tables, which is as good and several times as fast, but gives other numbers.
    pub fn with_tables(mut self) -> Self {
        let steps = (0..=TONE_STEPS).map(|step| (step as f64 / TONE_STEPS as f64).powi(2));
        self.tone = Some(steps.map(|raised| self.encode_raised(raised)).collect());
        self
    }

    /// Develops the picture of a frame (from 0) from the linear light of its three colours; `random` generates the noise.
    pub fn develop(
        &self,
        planes: &[Vec<f32>; 3],
        frame: usize,
        time_s: f64,
        random: &mut Random,
    ) -> RgbImage {
        let exposure = self.exposure(time_s);
        let width = self.size[0] as usize;
        let rows: Vec<f64> = (0..self.size[1]).map(|row| exposure * self.flicker(row, frame)).collect();
        let veils: [f64; 3] = std::array::from_fn(|channel| exposure * self.veil(&planes[channel]));
        let mut picture = RgbImage::new(self.size[0], self.size[1]);
        let mut deviates = self.tone.as_ref().map(|_| Deviates::new(random.clone()));
        for (index, pixel) in picture.pixels_mut().enumerate() {
            let gain = rows[index / width] * f64::from(self.transmission[index]);
            for (channel, plane) in planes.iter().enumerate() {
                let light = (f64::from(plane[index]) * gain + f64::from(self.haze[index]) + veils[channel])
                    * self.truth.gains[channel];
                let deviate = match &mut deviates {
                    Some(deviates) => deviates.draw(),
                    None => random.normal(),
                };
                pixel.0[channel] = self.encode(self.noisy(light, deviate));
            }
        }
        self.finished(picture)
    }

    /// Returns the light that the lens adds everywhere, before its gains.
    fn veil(&self, plane: &[f32]) -> f64 {
        if self.truth.glare == 0.0 {
            return 0.0;
        }
        let light = plane.iter().zip(&self.transmission).map(|(light, part)| f64::from(light * part));
        self.truth.glare * light.sum::<f64>() / plane.len() as f64
    }

    fn noisy(&self, light: f64, deviate: f64) -> f64 {
        let variance = self.light.noise_shot * light.max(0.0) + self.light.noise_read.powi(2);
        light + self.truth.noise * variance.sqrt() * deviate
    }

    fn encode(&self, light: f64) -> u8 {
        let raised = light * (1.0 - self.truth.black_level) + self.truth.black_level;
        let raised = raised.clamp(0.0, 1.0);
        match &self.tone {
            Some(tone) => tone[(raised.sqrt() * TONE_STEPS as f64).round() as usize],
            None => self.encode_raised(raised),
        }
    }

    fn encode_raised(&self, raised: f64) -> u8 {
        let gamma = self.light.gamma + self.truth.gamma_change;
        (raised.powf(1.0 / gamma) * 255.0).round() as u8
    }

    /// Applies what happens to encoded pictures.
    fn finished(&self, mut picture: RgbImage) -> RgbImage {
        for &[amount, radius_px] in &self.truth.sharpening {
            sharpen(&mut picture, amount, radius_px);
        }
        if self.truth.mistakes.contains(&Mistake::MirroredPictures) {
            image::imageops::flip_horizontal_in_place(&mut picture);
        }
        picture
    }

    /// Returns the gain at a time, seconds.
    fn exposure(&self, time_s: f64) -> f64 {
        let [first_s, last_s] = self.span_s;
        let stops = self.truth.drifts.iter().map(|&(amplitude_ev, course)| match course {
            Course::Linear => amplitude_ev * (2.0 * (time_s - first_s) / (last_s - first_s).max(1e-9) - 1.0),
            Course::Sine { period_s, phase_rad } => {
                amplitude_ev * (TAU * time_s / period_s + phase_rad).sin()
            }
        });
        stops.sum::<f64>().exp2()
    }

    /// Returns the gain of a row of a frame.
    fn flicker(&self, row: u32, frame: usize) -> f64 {
        let part = f64::from(row) / f64::from(self.size[1]);
        let wave = |&[amplitude, bands, roll]: &[f64; 3]| {
            1.0 + amplitude * (TAU * (bands * part + roll * frame as f64)).sin()
        };
        self.truth.flicker.iter().map(wave).product()
    }
}

/// Sharpens by an unsharp mask.
fn sharpen(picture: &mut RgbImage, amount: f64, radius_px: f64) {
    let size = [picture.width() as usize, picture.height() as usize];
    for channel in 0..3 {
        let plane: Vec<f32> = picture.pixels().map(|pixel| pixel.0[channel].into()).collect();
        let soft = smoothed(&plane, size, radius_px);
        for ((pixel, value), soft) in picture.pixels_mut().zip(&plane).zip(soft) {
            let sharp = value + amount as f32 * (value - soft);
            pixel.0[channel] = sharp.round().clamp(0.0, 255.0) as u8;
        }
    }
}

/// Returns the transmission of the lens at a pixel, without dirt.
fn vignette(truth: &Truth, pixel: DVec2, size: [u32; 2]) -> f64 {
    let corner_px = (DVec2::from(size.map(f64::from)) - 1.0).length() / 2.0;
    let square = pixel.distance_squared(truth.lens.center_px) / (corner_px * corner_px);
    let gain = |&(strength, falloff): &(f64, Falloff)| match falloff {
        Falloff::Quadratic => 1.0 - strength * square,
        // This is cos⁴ of the angle whose tangent is the relative distance; in the corner it is a quarter.
        Falloff::Cos4 => 1.0 - strength * (1.0 - (1.0 + square).powi(-2)) / 0.75,
    };
    truth.vignettes.iter().map(gain).product::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{effect::Hidden, nominal::Nominal};

    fn film(effects: &[Hidden]) -> Film {
        let nominal = Nominal::new(1, [120, 90]);
        Film::new(&Truth::new(&nominal, effects), nominal.light, nominal.size, [0.2, 4.0])
    }

    /// Returns mean and standard deviation of the linear green values of a uniform picture.
    fn flat(film: &Film, light: f32) -> (f64, f64) {
        let planes = [0; 3].map(|_| vec![light; 120 * 90]);
        let picture = film.develop(&planes, 0, 0.2, &mut Random::new(2));
        let values: Vec<f64> =
            picture.pixels().map(|pixel| (f64::from(pixel.0[1]) / 255.0).powf(2.2)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
        (mean, variance.sqrt())
    }

    #[test]
    fn noise_of_even_light_has_the_standard_deviation_of_the_sensor() {
        for (light, factor) in [(0.1_f32, 0.0), (0.6, 0.0), (0.3, 0.5)] {
            let (mean, deviation) = flat(&film(&[Hidden::SensorNoise { factor }]), light);
            let expected = (1.0 + factor) * (0.0015 * f64::from(light) + 0.004 * 0.004).sqrt();
            assert!((mean - f64::from(light)).abs() < 1e-3, "{light}: {mean}");
            assert!((deviation / expected - 1.0).abs() < 0.03, "{light}: {deviation} {expected}");
        }
    }

    #[test]
    fn vignetting_takes_its_strength_from_the_corners() {
        for falloff in [Falloff::Quadratic, Falloff::Cos4] {
            let nominal = Nominal::new(1, [120, 90]);
            let mut truth = Truth::new(&nominal, &[Hidden::Vignetting { strength: 0.3, falloff }]);
            truth.lens.center_px = DVec2::new(59.5, 44.5);
            assert!((vignette(&truth, DVec2::ZERO, [120, 90]) - 0.7).abs() < 1e-12);
            assert!((vignette(&truth, truth.lens.center_px, [120, 90]) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_black_level_keeps_full_scale() {
        let film = film(&[Hidden::BlackLevel { offset: 0.02 }]);
        assert_eq!(film.encode(1.0), 255);
        assert_eq!(film.encode(0.0), (0.02_f64.powf(1.0 / 2.2) * 255.0).round() as u8);
    }
}
