//! Estimates of one pose from many particles.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::{
    names::{UnknownName, by_name},
    pose::CameraPose,
};

/// How the pose is estimated from the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Estimator {
    /// Particle with the largest weight in any iteration, as in the paper.
    #[default]
    Best,
    /// Weighted mean of all particles of the last iteration.
    Mean,
    /// Weighted mean of the particles around the best one.
    Cluster,
}

impl Estimator {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 3] = [Self::Best, Self::Mean, Self::Cluster];

    /// Its name in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Best => "best",
            Self::Mean => "mean",
            Self::Cluster => "cluster",
        }
    }

    /// What it is, in a line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Best => "The particle with the largest weight, as in the paper",
            Self::Mean => "Weighted mean of all particles",
            Self::Cluster => "Weighted mean of the particles around the best",
        }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Estimator {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("estimator", &Self::ALL, Self::name, name)
    }
}

/// Radius around the best particle within which particles form its cluster, metres.
const CLUSTER_RADIUS_M: f64 = 0.25;
/// Difference in heading from the best particle within which particles form its cluster, radians.
const CLUSTER_ANGLE_RAD: f64 = 0.25;

/// Returns the weighted mean of the particles (of those around `centre` only, if given); angles are averaged by their mean
/// direction. Returns `None` if no particle has any weight.
pub fn weighted_mean(
    particles: &[CameraPose],
    weights: &[f64],
    centre: Option<CameraPose>,
) -> Option<CameraPose> {
    let near = |pose: &CameraPose| {
        centre.is_none_or(|centre| {
            (pose.x_m - centre.x_m).hypot(pose.y_m - centre.y_m) <= CLUSTER_RADIUS_M
                && crate::pose::wrap_angle(pose.yaw_rad - centre.yaw_rad).abs() <= CLUSTER_ANGLE_RAD
        })
    };
    let mut total = 0.0;
    let mut sum = CameraPose::default();
    let (mut sin, mut cos) = (0.0, 0.0);
    for (pose, weight) in particles.iter().zip(weights).filter(|(pose, _)| near(pose)) {
        total += weight;
        sum.x_m += weight * pose.x_m;
        sum.y_m += weight * pose.y_m;
        sum.height_m += weight * pose.height_m;
        sum.pitch_rad += weight * pose.pitch_rad;
        sum.roll_rad += weight * pose.roll_rad;
        sin += weight * pose.yaw_rad.sin();
        cos += weight * pose.yaw_rad.cos();
    }
    (total > 0.0).then(|| CameraPose {
        x_m: sum.x_m / total,
        y_m: sum.y_m / total,
        yaw_rad: sin.atan2(cos),
        height_m: sum.height_m / total,
        pitch_rad: sum.pitch_rad / total,
        roll_rad: sum.roll_rad / total,
    })
}

/// Returns the root mean square distance of the weighted particles from a pose, metres.
pub fn spread_m(particles: &[CameraPose], weights: &[f64], from: CameraPose) -> f64 {
    let squared = |pose: &CameraPose| (pose.x_m - from.x_m).powi(2) + (pose.y_m - from.y_m).powi(2);
    particles.iter().zip(weights).map(|(pose, weight)| weight * squared(pose)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn headings_on_both_sides_of_the_cut_average_to_the_cut() {
        let pose = |yaw_rad| CameraPose { yaw_rad, ..Default::default() };
        let mean = weighted_mean(&[pose(PI - 0.1), pose(-PI + 0.1)], &[0.5, 0.5], None).unwrap();
        assert!((mean.yaw_rad.abs() - PI).abs() < 1e-12);
    }

    #[test]
    fn a_cluster_ignores_the_other_mode() {
        let pose = |x_m| CameraPose { x_m, ..Default::default() };
        let particles = [pose(1.0), pose(1.1), pose(-3.0)];
        let mean = weighted_mean(&particles, &[0.3, 0.3, 0.4], Some(pose(1.0))).unwrap();
        assert!((mean.x_m - 1.05).abs() < 1e-12);
        assert!(weighted_mean(&particles, &[0.0; 3], None).is_none());
    }
}
