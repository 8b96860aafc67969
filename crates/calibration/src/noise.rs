//! Noise of what a calibration uses, learned from the recording itself.

use nalgebra::{Matrix6, Vector3, Vector6};

/// Standard deviations of lines, joints and IMU.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Offset of a measured line, pixels.
    pub offset_px: f64,
    /// Number of measured points, each a few pixels from the next, that count as one, because their errors are alike.
    pub repeats: f64,
    /// Height of the camera about its nominal one, from picture to picture, metres.
    pub height_m: f64,
    /// Stated pitch about the true one, apart from the mount's own turn, radians.
    pub pitch_rad: f64,
    /// Stated roll about the true one, apart from the mount's own turn, radians.
    pub roll_rad: f64,
}

/// Deviation, in standard deviations, from which a picture was fitted to wrong lines.
const LARGEST: f64 = 4.0;

/// Bounds of the learned standard deviations of height, pitch and roll. No body stands stiller than a millimetre and half a
/// milliradian; with more than the upper ones a picture would not need the mount pose at all.
const BOUNDS: [(f64, f64); 3] = [(0.001, 0.10), (0.0005, 0.06), (0.0005, 0.06)];

impl Noise {
    /// Returns what is assumed before the recording has shown anything: lines are off by a pixel, a humanoid's knees bend by
    /// 3 cm in a step, joints and IMU err by a degree.
    pub(crate) fn unknown() -> Self {
        Self { offset_px: 1.0, repeats: 10.0, height_m: 0.03, pitch_rad: 0.015, roll_rad: 0.015 }
    }

    /// Returns the inverse covariance that joints and IMU give the six numbers of a pose.
    pub fn information(&self) -> Matrix6<f64> {
        let [height, pitch, roll] =
            [self.height_m, self.pitch_rad, self.roll_rad].map(|sigma| 1.0 / (sigma * sigma));
        Matrix6::from_diagonal(&Vector6::new(0.0, 0.0, 0.0, height, pitch, roll))
    }

    /// Returns the noise with the standard deviations of height, pitch and roll learned from how far the fitted poses are from
    /// the stated ones.
    ///
    /// A pose is drawn to the mount by as much as the noise is believed to be small. What the picture alone says follows from
    /// the pose's deviation d, its variance p and the noise σ² with which it was fitted: a deviation of d σ² / (σ² − p), with the
    /// variance v = p σ² / (σ² − p). These scatter by σ² + v, and one step of Fisher scoring makes the likelihood of that larger.
    pub(crate) fn learned(self, deviations: &[Vector3<f64>], variances: &[Vector3<f64>]) -> Self {
        let sigma = |axis: usize, believed: f64| {
            let square = believed * believed;
            let of_pictures = deviations.iter().zip(variances).filter_map(|(deviation, variance)| {
                let gain = square / (square - variance[axis]);
                let of_picture = variance[axis] * gain;
                let deviation = deviation[axis] * gain;
                let scatter = square + of_picture;
                let is_sound =
                    gain.is_finite() && gain > 0.0 && deviation * deviation < LARGEST * LARGEST * scatter;
                is_sound.then(|| (1.0 / (scatter * scatter), deviation * deviation - of_picture))
            });
            let (mut weights, mut sum) = (0.0, 0.0);
            for (weight, excess) in of_pictures {
                weights += weight;
                sum += weight * excess;
            }
            let (least, most) = BOUNDS[axis];
            if weights > 0.0 { (sum / weights).max(least * least).sqrt().min(most) } else { believed }
        };
        Self {
            height_m: sigma(0, self.height_m),
            pitch_rad: sigma(1, self.pitch_rad),
            roll_rad: sigma(2, self.roll_rad),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use reality_sim_core::filter::{Purpose, Stream};

    use super::*;

    /// Pictures say the height to within 2 cm, and it varies by another amount; whatever is believed first, that is found.
    #[test]
    fn the_noise_of_the_mount_is_found_whatever_is_believed_first() {
        let stream = Stream::new(5, Purpose::Initialise, 0, 0);
        for true_m in [0.03_f64, 0.01, 0.002] {
            for believed in [0.1, 0.03, 0.004] {
                let mut noise = Noise { height_m: believed, ..Noise::unknown() };
                for _ in 0..20 {
                    let square = noise.height_m * noise.height_m;
                    let of_picture = 0.02_f64 * 0.02;
                    let gain = square / (square + of_picture);
                    let drawn: Vec<Vector3<f64>> = (0..2000)
                        .map(|index| {
                            let normals = stream.normals(index);
                            let seen = true_m * normals[0] + 0.02 * normals[1];
                            Vector3::new(gain * seen, 0.0, 0.0)
                        })
                        .collect();
                    let variances = vec![Vector3::new(gain * of_picture, 1e-9, 1e-9); drawn.len()];
                    noise = noise.learned(&drawn, &variances);
                }
                // The mean square of 2000 draws has a standard deviation of its value times √(2 / 2000).
                let scatter = true_m * true_m + 0.02 * 0.02;
                let error = noise.height_m.powi(2) - true_m * true_m;
                assert!(error.abs() < 4.0 * scatter / 1000.0_f64.sqrt(), "{} for {true_m}", noise.height_m);
            }
        }
    }
}
