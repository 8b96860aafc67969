//! Localization of a camera from its pictures of a soccer field: camera models, the field, recordings, preprocessing,
//! observation models and the particle filter of Reality Sim, on the CPU.
//!
//! | what | where |
//! |---|---|
//! | poses, motions, the rotation convention | [`pose::CameraPose`], [`pose::Pose2`], [`pose::Motion2`] |
//! | lens models, projection both ways with derivatives | [`camera::Camera`], [`camera::Distortion`] |
//! | a field's dimensions, its lines as curves, league presets | [`field::FieldDimensions`] |
//! | recordings on disk, read, validated and written | [`sequence::Sequence`], [`sequence::SequenceError`] |
//! | grey values, the field's border, evidence for lines | [`preprocess::Preprocessor`], [`preprocess::Prepared`] |
//! | the weight of a pose, given a picture | [`observation::Scorer`], [`observation::ObservationKind`] |
//! | particles: motion, weights, resampling, estimate | [`filter::ParticleFilter`], [`filter::FilterConfig`] |
//! | an exhaustive search of the field | [`search::GlobalSearch`] |
//! | sub-pixel fits with covariance, whole trajectories | [`refine::Refiner`], [`refine::smooth_trajectory`] |
//! | everything together, picture by picture | [`localization::Localizer`], [`localization::Observation`] |
//! | how well poses and pictures agree, in pixels | [`quality::LineMeter`], [`quality::RecordingQuality`] |
//! | a picture warped from others | [`warp::Warper`], [`warp::blend`] |
//! | the devices that compute | [`backend::Backend`], [`backend::CpuBackend`] |
//!
//! All quantities are in metres, radians and seconds; the unit is part of the name. The frames are defined in [`pose`]:
//! the world has its origin at the field's centre, x towards the opponent's goal and z up; a camera's x points right, y
//! down, z into the scene.
//!
//! ```
//! use glam::DVec3;
//! use reality_sim_core::{
//!     camera::{Camera, Distortion},
//!     field::FieldDimensions,
//!     pose::{CameraPose, Pose2},
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let camera = Camera::new([640, 480], [320.0, 320.0, 319.5, 239.5], Distortion::Pinhole)?;
//! let field = FieldDimensions::preset("spl").ok_or("there is such a preset")?;
//!
//! // On the own half of the halfway line, half a metre above the carpet, looking at the opponent's goal, a little down.
//! let pose = CameraPose::new(Pose2::new(-1.0, 0.0, 0.0), 0.5, 0.3, 0.0);
//! let goal_in_world = DVec3::new(0.5 * field.length_m, 0.0, 0.0);
//! let pixel = camera.project(pose.camera_from_world(goal_in_world))?;
//! let ground_in_world = camera.unproject_to_ground(pose, pixel)?;
//! assert!((ground_in_world - goal_in_world.truncate()).length() < 1e-9);
//!
//! // The same pose for those who compute with nalgebra.
//! let world_from_camera = nalgebra::Isometry3::from(pose);
//! assert!((world_from_camera.translation.z - 0.5).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```

pub mod backend;
mod backend_error;
pub mod camera;
mod device_choice;
pub mod field;
pub mod filter;
mod goal_colors;
mod isometry;
pub mod localization;
pub mod mount;
pub mod names;
pub mod observation;
pub mod pose;
pub mod preprocess;
pub mod quality;
pub mod refine;
pub mod search;
pub mod sequence;
mod setters;
pub mod statistics;
pub mod warp;

#[cfg(test)]
mod test_scene;
