//! Number of particles by KLD-sampling: Fox, "KLD-sampling: adaptive particle filters", NIPS 2001.

use std::collections::HashSet;

use serde::{Deserialize, Serialize};

use crate::{pose::CameraPose, setters::setters};

/// Settings of the adaptive particle number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct KldConfig {
    /// Minimum number of particles, 100: with 50, particles alone lose a fifth of a walk's pictures
    /// (`docs/figures/tables.md`).
    pub min_particles: usize,
    /// Allowed Kullback–Leibler distance between the particles and the true distribution, 0.05: in the range that Fox
    /// examined.
    pub epsilon: f64,
    /// Upper quantile of the standard normal distribution with which the bound holds, 2.326: 99 % as in Fox.
    pub z: f64,
    /// Size of a bin, 0.05 m: about the basin of one line's width.
    pub bin_m: f64,
    /// Size of a bin, 0.05 rad: the same at a distance of one metre.
    pub bin_rad: f64,
}

setters!(KldConfig {
    with_min_particles: min_particles = usize,
    with_epsilon: epsilon = f64,
    with_z: z = f64,
    with_bin_m: bin_m = f64,
    with_bin_rad: bin_rad = f64,
});

impl Default for KldConfig {
    fn default() -> Self {
        Self { min_particles: 100, epsilon: 0.05, z: 2.326, bin_m: 0.05, bin_rad: 0.05 }
    }
}

impl KldConfig {
    /// Returns the number of particles needed for a cloud that fills as many bins as this one, at most `max_particles`.
    pub fn particles_needed(&self, cloud: &[CameraPose], max_particles: usize) -> usize {
        let bins: HashSet<[i64; 3]> = cloud
            .iter()
            .map(|pose| {
                let bin = |value: f64, size: f64| (value / size).floor() as i64;
                [bin(pose.x_m, self.bin_m), bin(pose.y_m, self.bin_m), bin(pose.yaw_rad, self.bin_rad)]
            })
            .collect();
        let needed = match bins.len() {
            0 | 1 => 0.0,
            count => {
                let free = (count - 1) as f64;
                let a = 2.0 / (9.0 * free);
                free / (2.0 * self.epsilon) * (1.0 - a + a.sqrt() * self.z).powi(3)
            }
        };
        (needed.ceil() as usize).max(self.min_particles).min(max_particles.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_cloud_needs_more_particles_than_a_tight_one() {
        let config = KldConfig::default();
        let cloud = |spacing: f64| -> Vec<CameraPose> {
            (0..500).map(|i| CameraPose { x_m: spacing * f64::from(i), ..Default::default() }).collect()
        };
        assert_eq!(config.particles_needed(&cloud(0.0), 10_000), config.min_particles);
        let (tight, wide) =
            (config.particles_needed(&cloud(0.001), 10_000), config.particles_needed(&cloud(0.05), 10_000));
        assert!(tight < wide && wide <= 10_000, "{tight} {wide}");
        assert_eq!(config.particles_needed(&cloud(0.05), 700), 700, "never above the limit");
    }
}
