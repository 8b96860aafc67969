//! Cameras, fields and recordings as a model says that they truly are: the loop from a recording's gap back to everything that
//! uses a camera.

use glam::{DMat3, DVec2, DVec3};
use reality_sim_core::{
    field::FieldDimensions,
    mount::MountPose,
    pose::{CameraPose, Motion2, Pose2, wrap_angle},
    sequence::{CameraSetup, FrameRecord, Mounting, Photometry, Sequence},
};

use crate::{
    chain::Chain,
    model::{Model, ModelError},
    surface::Surface,
    trajectory::{Trajectory, TrajectoryError},
};

/// Number of steps by which a reported motion is solved for the true one; every known effect is affine and takes one.
const SOLVING_STEPS: usize = 4;
/// Step of numerical derivatives, metres and radians.
const STEP: f64 = 1e-4;
/// Determinant of the derivatives below which an odometry tells nothing of the motion: an odometry at its nominal values has
/// 1.
const LEAST_DETERMINANT: f64 = 1e-6;

/// Camera and field as a model corrects them.
#[derive(Debug, Clone)]
pub struct Corrected {
    chain: Chain,
    text: String,
    stated: CameraSetup,
}

/// Reason why a recording cannot be corrected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CorrectionError {
    /// The model leaves no valid camera or field.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model moves the pictures in time, and the reference poses define no trajectory.
    #[error("the reference poses form no trajectory, along which the model could move the pictures' times")]
    Trajectory(#[from] TrajectoryError),
}

impl Model {
    /// Returns the camera and the field that the model makes of stated ones. Fails where it leaves no valid ones.
    pub fn corrected(&self, setup: &CameraSetup, field: &FieldDimensions) -> Result<Corrected, ModelError> {
        let chain = Chain::new(setup, field, self)?;
        Ok(Corrected { chain, text: self.to_toml(), stated: setup.clone() })
    }

    /// Returns a recording as the model says that it truly is: lens, height and field; pitch and roll of the frames; the
    /// reference poses, at the middle of the exposure; the odometry. Its pictures stay as they are.
    pub fn correct(&self, sequence: &Sequence) -> Result<Sequence, CorrectionError> {
        self.corrected(&sequence.setup, &sequence.field)?.sequence(sequence)
    }
}

impl Corrected {
    /// Returns the camera with its light as it was stated.
    pub fn setup(&self) -> CameraSetup {
        let level = MountPose { height_m: self.stated.mount_height_m, pitch_rad: 0.0, roll_rad: 0.0 };
        CameraSetup {
            camera: self.chain.camera().clone(),
            mount_height_m: self.mount_pose(level).height_m,
            photometry: self.stated.photometry,
        }
    }

    /// Returns the camera with its light as far as a camera's file can tell it: gamma, black level, noise, blur, and the
    /// brightness of lines and carpet under a constant gain.
    pub fn setup_with_light(&self) -> CameraSetup {
        CameraSetup {
            photometry: self.stated.photometry.map(|stated| self.photometry(stated)),
            ..self.setup()
        }
    }

    /// Returns the field.
    pub fn field(&self) -> &FieldDimensions {
        self.chain.field()
    }

    /// Returns the simulated camera.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Returns where the camera is against the stated poses; `None` where that depends on the pose.
    pub fn mounting(&self) -> Option<Mounting> {
        Mounting::of_poses(|pose| self.chain.mounted(pose))
    }

    /// Returns the true mount pose for a stated one.
    pub fn mount_pose(&self, stated: MountPose) -> MountPose {
        MountPose::of(self.chain.mounted(stated.at(Pose2::default())))
    }

    /// Returns the true motion for one that the odometry reported over a time.
    pub fn true_motion(&self, reported: Motion2, duration_s: f64) -> Motion2 {
        let report = |motion| coordinates(self.chain.odometry(motion_of(motion), duration_s));
        let wanted = coordinates(reported);
        let mut motion = wanted;
        for _ in 0..SOLVING_STEPS {
            let now = report(motion);
            let column = |axis: DVec3| (report(motion + STEP * axis) - now) / STEP;
            let slope = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
            if slope.determinant().abs() < LEAST_DETERMINANT {
                return reported;
            }
            motion += slope.inverse() * (wanted - now);
        }
        motion_of(motion)
    }

    /// Returns a recording of the stated camera with everything corrected but its pictures.
    pub fn sequence(&self, stated: &Sequence) -> Result<Sequence, CorrectionError> {
        let mut corrected = stated.clone();
        (corrected.setup, corrected.field) = (self.setup(), self.field().clone());
        corrected.corrected_by = Some(self.text.clone());
        self.correct_reference_poses(&mut corrected)?;
        self.correct_odometry(&mut corrected.frames);
        for frame in &mut corrected.frames {
            let mount = MountPose {
                height_m: stated.setup.mount_height_m,
                pitch_rad: frame.pitch_rad,
                roll_rad: frame.roll_rad,
            };
            let MountPose { pitch_rad, roll_rad, .. } = self.mount_pose(mount);
            (frame.pitch_rad, frame.roll_rad) = (pitch_rad, roll_rad);
        }
        Ok(corrected)
    }

    fn correct_reference_poses(&self, sequence: &mut Sequence) -> Result<(), TrajectoryError> {
        let of_frames = sequence.frames.iter();
        let of_frames = of_frames.filter_map(|frame| Some((frame.timestamp_s, frame.reference_pose?)));
        let between = sequence.poses_between_frames.iter().map(|stamped| (stamped.timestamp_s, stamped.pose));
        let mut known: Vec<(f64, CameraPose)> = of_frames.chain(between).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_timed = self.chain.is_timed() && !known.is_empty();
        let trajectory = is_timed.then(|| Trajectory::near(&known)).transpose()?;
        let corrected = |timestamp_s: f64, stated: CameraPose| match &trajectory {
            Some(trajectory) => {
                let pose = self.chain.pose(trajectory, timestamp_s, 0.5);
                CameraPose { yaw_rad: wrap_angle(pose.yaw_rad), ..pose }
            }
            None => self.chain.mounted(stated),
        };
        for frame in &mut sequence.frames {
            frame.reference_pose = frame.reference_pose.map(|stated| corrected(frame.timestamp_s, stated));
        }
        for stamped in &mut sequence.poses_between_frames {
            stamped.pose = corrected(stamped.timestamp_s, stamped.pose);
        }
        Ok(())
    }

    /// Corrects the odometry step by step. A pose at the origin starts it anew, as in a recording in which it was reset.
    fn correct_odometry(&self, frames: &mut [FrameRecord]) {
        let mut last: Option<(f64, Pose2, Pose2)> = None;
        for frame in frames {
            let Some(stated) = frame.odometry else { continue };
            let time_s = frame.timestamp_s;
            let pose = match last {
                Some((before_s, before, corrected)) if stated != Pose2::default() => {
                    let motion = before.motion_to(stated);
                    corrected.moved(self.true_motion(motion, time_s - before_s))
                }
                _ => stated,
            };
            frame.odometry = Some(pose);
            last = Some((time_s, stated, pose));
        }
    }

    fn photometry(&self, stated: Photometry) -> Photometry {
        let noise = self.chain.noise();
        // Whatever changes over time cannot be told by one brightness of lines and carpet.
        let gains = [0.0, 1.0, 1e6].map(|time_s| self.chain.gain(time_s));
        let is_constant = gains.iter().all(|gain| *gain == gains[0]);
        let gain = if is_constant { gains[0] } else { [1.0; 3] };
        let brightened = |rgb: [f64; 3], surface: Surface| {
            let factor = self.chain.reflectance(surface);
            std::array::from_fn(|channel| rgb[channel] * gain[channel] * factor)
        };
        let black_level = self.chain.respond(0.0);
        let center = DVec2::new(self.chain.camera().cx, self.chain.camera().cy);
        let blur = sampled_sigma_px(self.chain.psf_variance_px2(center));
        let known =
            |stated: Option<f64>, value: f64| stated.map(|_| value).or((value > 0.0).then_some(value));
        Photometry {
            line_linear_rgb: stated.line_linear_rgb.map(|rgb| brightened(rgb, Surface::Line)),
            carpet_linear_rgb: stated.carpet_linear_rgb.map(|rgb| brightened(rgb, Surface::Carpet)),
            black_level: known(stated.black_level, black_level),
            noise_shot: known(stated.noise_shot, noise.shot),
            noise_read: known(stated.noise_read, noise.read_variance.max(0.0).sqrt()),
            psf_sigma_px: known(stated.psf_sigma_px, blur),
            gamma: self.chain.tone().gamma,
            trust: stated.trust,
        }
    }
}

fn coordinates(motion: Motion2) -> DVec3 {
    DVec3::new(motion.forward_m, motion.left_m, motion.turn_rad)
}

fn motion_of(DVec3 { x: forward_m, y: left_m, z: turn_rad }: DVec3) -> Motion2 {
    Motion2 { forward_m, left_m, turn_rad }
}

/// Returns the standard deviation of the sampled Gaussian kernel with this variance, by bisection: the inverse of
/// [`crate::sampled_variance_px2`].
pub fn sampled_sigma_px(variance_px2: f64) -> f64 {
    if variance_px2 <= 0.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0 + variance_px2.sqrt());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if crate::chain::sampled_variance_px2(middle) < variance_px2 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
