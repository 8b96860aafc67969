//! The particle filter itself, one picture at a time.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Estimator, KldConfig, MotionNoise, PlanarSigma, Purpose, Resampling, Stream, best_index,
    effective_sample_size, normalise, spread_m, weighted_mean,
};
use crate::{
    backend_error::BackendError,
    mount::{MountPose, MountPoseSigma},
    observation::Scorer,
    pose::{CameraPose, Motion2, Pose2},
    setters::setters,
};

/// Settings of the particle filter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct FilterConfig {
    /// Number of particles, 800: the paper's Table 2; with [`FilterConfig::adaptive`], the maximum number. Where the
    /// particles do all the work, 50 lose a fifth of a walk's pictures, and from 1600 on more do not help
    /// (`docs/figures/tables.md`).
    pub particles: usize,
    /// Number of weighing and resampling iterations per picture, 5: the paper's T.
    pub iterations: u32,
    /// Resampling scheme, residual as in the paper.
    pub resampling: Resampling,
    /// How the pose is estimated from the particles, by the best one as in the paper.
    pub estimator: Estimator,
    /// Random seed, 0: the same seed gives the same result.
    pub seed: u64,
    /// Noise of the motion between pictures.
    pub noise: MotionNoise,
    /// Factor by which the diffusion shrinks from one iteration to the next, 0.6: after five iterations it is an eighth, so
    /// that the last one searches a few millimetres.
    pub shrink: f64,
    /// Settings for adapting the number of particles to their spread; `None`, the default, keeps it constant as in the
    /// paper.
    pub adaptive: Option<KldConfig>,
    /// Spread of the particles in height, pitch and roll; `None`, the default, gives every particle the mount pose of joints
    /// and IMU as in the paper.
    pub mount_sigma: Option<MountPoseSigma>,
}

setters!(FilterConfig {
    with_particles: particles = usize,
    with_iterations: iterations = u32,
    with_resampling: resampling = Resampling,
    with_estimator: estimator = Estimator,
    with_seed: seed = u64,
    with_noise: noise = MotionNoise,
    with_shrink: shrink = f64,
    with_adaptive: adaptive = Option<KldConfig>,
    with_mount_sigma: mount_sigma = Option<MountPoseSigma>,
});

impl Default for FilterConfig {
    fn default() -> Self {
        Self {
            particles: 800,
            iterations: 5,
            resampling: Resampling::default(),
            estimator: Estimator::default(),
            seed: 0,
            noise: MotionNoise::default(),
            shrink: 0.6,
            adaptive: None,
            mount_sigma: None,
        }
    }
}

/// Estimate of the filter after a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterEstimate {
    /// Estimated pose.
    pub pose: CameraPose,
    /// Log-weight of the best particle.
    pub log_weight: f64,
    /// Effective sample size of the last iteration.
    pub effective_sample_size: f64,
    /// Root mean squared distance of the weighted particles from the pose, metres.
    pub spread_m: f64,
    /// Number of particles in the last iteration.
    pub particles: usize,
}

/// Minimum distance of an alternative from any better particle, metres and radians: a fit that starts at one does not end at
/// the other. The shader has the same numbers.
const ALTERNATIVE_DISTANCE: PlanarSigma = PlanarSigma { position_m: 0.12, yaw_rad: 0.08 };
/// Maximum number of alternatives.
const ALTERNATIVES: usize = 6;

/// Particles that follow a recording.
#[derive(Debug, Clone)]
pub struct ParticleFilter {
    config: FilterConfig,
    particles: Vec<CameraPose>,
    frame: u32,
    /// Number of times that particles were placed anew in this frame: each time needs random numbers of its own.
    placements: u32,
    /// Best particles of this frame's first iteration that lie apart from each other.
    alternatives: Vec<CameraPose>,
}

impl ParticleFilter {
    /// Returns a filter with particles around a start pose.
    pub fn new(config: FilterConfig, start: Pose2, sigma: PlanarSigma) -> Self {
        let mut filter = Self::empty(config);
        filter.initialize(&[(start, 1.0)], sigma);
        filter
    }

    /// Returns a filter without particles.
    pub fn empty(config: FilterConfig) -> Self {
        Self { config, particles: Vec::new(), frame: 0, placements: 0, alternatives: Vec::new() }
    }

    /// Returns the particles after the last iteration.
    pub fn particles(&self) -> &[CameraPose] {
        &self.particles
    }

    /// Returns the best particles of the last update's first iteration that lie apart from each other, best first:
    /// other poses from which the picture may have been taken.
    pub fn alternatives(&self) -> &[CameraPose] {
        &self.alternatives
    }

    /// Returns the settings in use.
    pub fn config(&self) -> &FilterConfig {
        &self.config
    }

    /// Turns all particles by 180° about the field's centre.
    pub fn mirror(&mut self) {
        self.particles.iter_mut().for_each(|particle| *particle = particle.mirrored());
    }

    /// Replaces all particles by new ones around several poses, in proportion to the weights of the poses.
    pub fn initialize(&mut self, modes: &[(Pose2, f64)], sigma: PlanarSigma) {
        self.particles =
            placed(&self.config, modes, sigma, self.stream(Purpose::Initialise, self.placements));
        self.placements += 1;
    }

    /// Moves the particles to the next picture. Without odometry they stay where they are and only spread, as in the paper.
    pub fn predict(&mut self, motion: Option<Motion2>) {
        self.frame += 1;
        self.placements = 0;
        let sigma = self.config.noise.sigma(motion);
        let stream = self.stream(Purpose::Predict, 0);
        self.particles.par_iter_mut().enumerate().for_each(|(index, particle)| {
            let planar = particle.planar().moved(motion.unwrap_or_default());
            *particle = particle.with_planar(diffused(planar, sigma, &stream.normals(index as u32)));
        });
    }

    /// Weighs and resamples T times, against the picture that the scorer has loaded. `sigma` is the diffusion of the first
    /// iteration. Fails if the scorer's device does.
    pub fn update(
        &mut self,
        scorer: &dyn Scorer,
        mount: MountPose,
        sigma: PlanarSigma,
    ) -> Result<FilterEstimate, BackendError> {
        let mut best: Option<(CameraPose, f64)> = None;
        let mut last = (Vec::new(), Vec::new());
        for iteration in 0..self.config.iterations.max(1) {
            let scale = self.config.shrink.powi(iteration as i32);
            self.diffuse(iteration, scale, sigma, mount);
            let log_weights = self.log_weights(scorer, mount)?;
            if let Some(index) = best_index(&log_weights)
                && best.is_none_or(|(_, largest)| log_weights[index] > largest)
            {
                best = Some((self.particles[index], log_weights[index]));
            }
            if iteration == 0 {
                self.alternatives = alternatives(&self.particles, &log_weights);
            }
            let weights = normalise(&log_weights);
            let count = self.config.adaptive.map_or(self.config.particles, |adaptive| {
                adaptive.particles_needed(&self.particles, self.config.particles)
            });
            let chosen =
                self.config.resampling.resample(&weights, count, self.stream(Purpose::Resample, iteration));
            let survivors = chosen.iter().map(|&index| self.particles[index]).collect();
            last = (std::mem::replace(&mut self.particles, survivors), weights);
        }
        Ok(self.summarise(best, &last.0, &last.1, mount))
    }

    fn summarise(
        &self,
        best: Option<(CameraPose, f64)>,
        particles: &[CameraPose],
        weights: &[f64],
        mount: MountPose,
    ) -> FilterEstimate {
        // Without any usable weight, all particles are equally good.
        let (best, log_weight) = best.unwrap_or_else(|| {
            (particles.first().copied().unwrap_or(mount.at(Pose2::default())), f64::NEG_INFINITY)
        });
        let pose = match self.config.estimator {
            Estimator::Best => best,
            Estimator::Mean => weighted_mean(particles, weights, None).unwrap_or(best),
            Estimator::Cluster => weighted_mean(particles, weights, Some(best)).unwrap_or(best),
        };
        FilterEstimate {
            pose,
            log_weight,
            effective_sample_size: effective_sample_size(weights),
            spread_m: spread_m(particles, weights, pose),
            particles: particles.len(),
        }
    }

    /// Diffuses the particles. The first iteration leaves the planar poses alone, since prediction has spread them
    /// already, and starts from the mount pose.
    fn diffuse(&mut self, iteration: u32, scale: f64, sigma: PlanarSigma, mount: MountPose) {
        let stream = self.stream(Purpose::Diffuse, iteration);
        let mount_sigma = self.config.mount_sigma.unwrap_or(MountPoseSigma { height_m: 0.0, angle_rad: 0.0 });
        let planar = PlanarSigma { position_m: scale * sigma.position_m, yaw_rad: scale * sigma.yaw_rad };
        self.particles.par_iter_mut().enumerate().for_each(|(index, particle)| {
            let normals = stream.normals(index as u32);
            if iteration == 0 {
                *particle = mount.at(particle.planar());
            } else {
                *particle = particle.with_planar(diffused(particle.planar(), planar, &normals));
            }
            particle.height_m += scale * mount_sigma.height_m * normals[3];
            particle.pitch_rad += scale * mount_sigma.angle_rad * normals[4];
            particle.roll_rad += scale * mount_sigma.angle_rad * normals[5];
        });
    }

    fn log_weights(&self, scorer: &dyn Scorer, mount: MountPose) -> Result<Vec<f64>, BackendError> {
        let mut log_weights = scorer.log_weights(&self.particles)?;
        if let Some(mount_sigma) = self.config.mount_sigma {
            for (log_weight, particle) in log_weights.iter_mut().zip(&self.particles) {
                *log_weight += mount_sigma.log_prior(*particle, mount);
            }
        }
        Ok(log_weights)
    }

    fn stream(&self, purpose: Purpose, iteration: u32) -> Stream {
        Stream::new(self.config.seed, purpose, self.frame, iteration)
    }
}

/// Returns as many particles as the settings say, around several poses in proportion to their weights.
pub fn placed(
    config: &FilterConfig,
    modes: &[(Pose2, f64)],
    sigma: PlanarSigma,
    stream: Stream,
) -> Vec<CameraPose> {
    let weights: Vec<f64> = modes.iter().map(|(_, weight)| *weight).collect();
    let origin = MountPose { height_m: 0.0, pitch_rad: 0.0, roll_rad: 0.0 };
    Resampling::Systematic
        .resample(&weights, config.particles, stream)
        .into_iter()
        .enumerate()
        .map(|(index, mode)| origin.at(diffused(modes[mode].0, sigma, &stream.normals(index as u32))))
        .collect()
}

fn diffused(pose: Pose2, sigma: PlanarSigma, normals: &[f64; 6]) -> Pose2 {
    Pose2 {
        x_m: pose.x_m + sigma.position_m * normals[0],
        y_m: pose.y_m + sigma.position_m * normals[1],
        yaw_rad: crate::pose::wrap_angle(pose.yaw_rad + sigma.yaw_rad * normals[2]),
    }
}

/// Returns the best particles that lie apart from each other, best first.
pub fn alternatives(particles: &[CameraPose], log_weights: &[f64]) -> Vec<CameraPose> {
    let mut order: Vec<usize> = (0..particles.len()).filter(|&index| !log_weights[index].is_nan()).collect();
    order.sort_by(|&a, &b| log_weights[b].total_cmp(&log_weights[a]));
    let mut alternatives: Vec<CameraPose> = Vec::new();
    for pose in order.into_iter().map(|index| particles[index]) {
        let apart = alternatives.iter().all(|other| {
            (pose.x_m - other.x_m).hypot(pose.y_m - other.y_m) > ALTERNATIVE_DISTANCE.position_m
                || crate::pose::wrap_angle(pose.yaw_rad - other.yaw_rad).abs() > ALTERNATIVE_DISTANCE.yaw_rad
        });
        if apart {
            alternatives.push(pose);
            if alternatives.len() == ALTERNATIVES {
                break;
            }
        }
    }
    alternatives
}
