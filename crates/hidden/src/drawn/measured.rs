//! What a person measured of brightness, noise and sharpness, with a person's errors.

use reality_sim_core::sequence::Photometry;

use crate::{
    blur::{PointSpread, Shape},
    nominal::{Nominal, rounded},
    random::{Random, normal_part},
};

/// Standard deviations of a person's measurements: of lines, carpet, what both have in common, one colour against the
/// others, noise and blur, as fractions.
const LINE: f64 = 0.03;
const CARPET: f64 = 0.06;
const COMMON: f64 = 0.02;
const COLOR: f64 = 0.005;
const NOISE: f64 = 0.1;
const BLUR: f64 = 0.1;
/// Distance from an edge up to which its blur is measured, pixels.
const EDGE_PX: f64 = 5.0;

/// What the files tell besides the gamma.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Given {
    /// Brightness of lines and carpet, and the black level.
    pub reflectance: bool,
    /// Noise.
    pub noise: bool,
    /// Sharpness.
    pub sharpness: bool,
}

impl Given {
    /// Everything is told.
    pub const ALL: Self = Self { reflectance: true, noise: true, sharpness: true };
    /// Nothing is told but the gamma.
    pub const GAMMA_ALONE: Self = Self { reflectance: false, noise: false, sharpness: false };

    /// Draws: a third of the worlds lack brightness, a quarter noise, a quarter sharpness, and one in seven everything.
    fn draw(random: &mut Random) -> Self {
        let mut given = || random.uniform();
        if given() < 1.0 / 7.0 {
            return Self::GAMMA_ALONE;
        }
        Self { reflectance: given() > 0.25, noise: given() > 0.2, sharpness: given() > 0.2 }
    }
}

/// Returns what the files say.
pub fn photometry(
    random: &mut Random,
    nominal: &Nominal,
    psf: PointSpread,
    given: Option<Given>,
) -> Photometry {
    let drawn = Given::draw(random);
    let given = given.unwrap_or(drawn);
    let light = &nominal.light;
    let common = COMMON * random.normal();
    let mut measured = |rgb: [f64; 3], error: f64| {
        let error = common + error * random.normal();
        rgb.map(|value| rounded(value * (error + COLOR * random.normal()).exp(), 1e4))
    };
    let (line, carpet) = (measured(light.line_rgb, LINE), measured(light.carpet_rgb, CARPET));
    let noise = (NOISE * random.normal()).exp();
    let blur = (BLUR * random.normal()).exp();
    Photometry {
        line_linear_rgb: given.reflectance.then_some(line),
        carpet_linear_rgb: given.reflectance.then_some(carpet),
        black_level: given.reflectance.then_some(0.0),
        noise_shot: given.noise.then(|| rounded(light.noise_shot * noise * noise, 1e6)),
        noise_read: given.noise.then(|| rounded(light.noise_read * noise, 1e6)),
        psf_sigma_px: given.sharpness.then(|| rounded(blur * edge_sigma_px(psf), 1e3)),
        ..Photometry::of_gamma(light.gamma)
    }
}

/// Returns the standard deviation of the Gaussian whose edge is the most like that of a point spread.
fn edge_sigma_px(psf: PointSpread) -> f64 {
    let edge = |distance: f64| match psf.shape {
        Shape::Gaussian => normal_part(distance / psf.sigma_px),
        Shape::Disc => {
            // The part of a disc of this radius on one side of a chord.
            let chord = (distance / (2.0 * psf.sigma_px)).clamp(-1.0, 1.0);
            0.5 + (chord * (1.0 - chord * chord).sqrt() + chord.asin()) / std::f64::consts::PI
        }
        Shape::Tail { share, sigma_px } => {
            (1.0 - share) * normal_part(distance / psf.sigma_px) + share * normal_part(distance / sigma_px)
        }
    };
    let places = || (-50..=50).map(|step| f64::from(step) / 50.0 * EDGE_PX);
    let misfit = |sigma: f64| places().map(|x| (edge(x) - normal_part(x / sigma)).powi(2)).sum::<f64>();
    let candidates = (0..240).map(|step| psf.sigma_px * (0.8 + 0.005 * f64::from(step)));
    candidates.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b))).unwrap_or(psf.sigma_px)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_gaussian_are_its_own_and_those_of_others_are_near() {
        let of = |shape| edge_sigma_px(PointSpread { sigma_px: 0.6, shape });
        assert!((of(Shape::Gaussian) - 0.6).abs() < 0.005);
        assert!((of(Shape::Disc) - 0.6).abs() < 0.1, "{}", of(Shape::Disc));
        let tail = of(Shape::Tail { share: 0.05, sigma_px: 3.0 });
        assert!((0.6..0.75).contains(&tail), "{tail}");
    }

    #[test]
    fn nominal_values_are_off_by_a_persons_errors() {
        let errors = (0..400).map(|seed| {
            let nominal = Nominal::new(seed, [64, 48]);
            let psf = PointSpread::gaussian(0.5);
            let stated = photometry(&mut Random::new(seed), &nominal, psf, Some(Given::ALL));
            let of = |stated: Option<[f64; 3]>, truth: [f64; 3]| (stated.unwrap()[1] / truth[1]).ln();
            let line = of(stated.line_linear_rgb, nominal.light.line_rgb);
            let carpet = of(stated.carpet_linear_rgb, nominal.light.carpet_rgb);
            [line, carpet, (stated.psf_sigma_px.unwrap() / 0.5).ln()]
        });
        let squares = errors.fold([0.0; 3], |sum, error| {
            std::array::from_fn(|index| sum[index] + error[index] * error[index] / 400.0)
        });
        for (square, expected) in squares.iter().zip([LINE.hypot(COMMON), CARPET.hypot(COMMON), BLUR]) {
            assert!((square.sqrt() / expected - 1.0).abs() < 0.15, "{} {expected}", square.sqrt());
        }
    }

    #[test]
    fn a_third_of_the_worlds_lack_brightness() {
        let lack = (0..600).filter(|seed| !Given::draw(&mut Random::new(*seed)).reflectance).count();
        assert!((160..260).contains(&lack), "{lack}");
    }
}
