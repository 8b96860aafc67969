//! Refinement of one picture's pose: all six degrees of freedom are fitted to sub-pixel line offsets, with the mount
//! pose as a prior.

use glam::DVec3;
use nalgebra::{Matrix6, Vector6};

use super::{
    calibration::{ByCalibration, CalibrationUncertainty, Coupling, lens_parameters},
    config::RefineConfig,
    measure::{LineOffset, MeasureConfig, measure_offsets},
    pose_steps::{PoseDerivatives, moved, pose_difference},
};
use crate::{
    camera::Camera,
    field::{FieldDimensions, LineSample, sample_lines, visible_samples},
    mount::{MountPose, MountPoseSigma},
    pose::{CameraPose, wrap_angle},
    preprocess::Texture,
    statistics::{robust_sigma, tukey_weight},
};

/// How far from its projection a line is searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// Search ranges of [`RefineConfig::wide_search_px`].
    Wide,
    /// Search ranges of [`RefineConfig::narrow_search_px`].
    Narrow,
}

/// Pose fitted to one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseFit {
    /// Fitted pose.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch and roll (metres and radians), given the picture and the mount pose. It contains
    /// the calibration's part.
    pub covariance: Matrix6<f64>,
    /// Part of the covariance that comes from the uncertainty of the calibration, 0 where none is stated. Neighbouring pictures
    /// share this error: it does not average out.
    pub of_calibration: Matrix6<f64>,
    /// How the pose moves with the parameters of the calibration.
    pub by_calibration: ByCalibration,
    /// Inverse covariance of the six numbers, given the picture alone.
    pub information: Matrix6<f64>,
    /// Robust standard deviation of the residual line offsets, pixels.
    pub residual_px: f64,
    /// Fraction of the samples in view whose line was found.
    pub found: f64,
    /// Number of offsets in the fit.
    pub offsets: usize,
}

impl PoseFit {
    /// Returns the fit with the part of its covariance that comes from the uncertainty of the calibration; `None` takes lens and
    /// mount as exact. It replaces the part that was there.
    ///
    /// # Panics
    ///
    /// If the uncertainty has more parameters than any lens.
    pub fn with_calibration(self, calibration: Option<&CalibrationUncertainty>) -> Self {
        let of_calibration = calibration
            .map_or_else(Matrix6::zeros, |calibration| self.by_calibration.covariance(calibration));
        Self { covariance: self.covariance - self.of_calibration + of_calibration, of_calibration, ..self }
    }

    /// Returns the gradient, at a pose, of the log-likelihood of the picture alone. At the fitted pose the picture and the
    /// mount pose pull against each other with equal force, so that the picture's pull there is known from the mount pose's.
    pub(super) fn pull_of_picture(
        &self,
        pose: CameraPose,
        mount: MountPose,
        mount_information: &Matrix6<f64>,
    ) -> Vector6<f64> {
        self.information * pose_difference(pose, self.pose)
            + mount_information * mount_error(self.pose, mount)
    }

    /// Returns the fit turned by 180° about the field's centre, where x and y change their signs.
    pub fn mirrored(self) -> Self {
        let signs = Matrix6::from_diagonal(&Vector6::new(-1.0, -1.0, 1.0, 1.0, 1.0, 1.0));
        let turned = |matrix: Matrix6<f64>| signs * matrix * signs;
        Self {
            pose: self.pose.mirrored(),
            covariance: turned(self.covariance),
            of_calibration: turned(self.of_calibration),
            by_calibration: self.by_calibration.turned(&signs),
            information: turned(self.information),
            ..self
        }
    }
}

/// Fits poses to pictures of one camera on one field.
#[derive(Debug, Clone)]
pub struct Refiner {
    camera: Camera,
    field: FieldDimensions,
    samples: Vec<LineSample>,
    config: RefineConfig,
    mount_sigma: MountPoseSigma,
    calibration: Option<CalibrationUncertainty>,
}

impl Refiner {
    /// Prepares fits to pictures of this camera on this field. `mount_sigma` is the uncertainty of the mount poses.
    pub fn new(
        camera: &Camera,
        field: &FieldDimensions,
        config: RefineConfig,
        mount_sigma: MountPoseSigma,
    ) -> Self {
        let clearance_m = config.min_clearance_line_widths * field.line_width_m;
        let samples = sample_lines(field, config.spacing_m)
            .into_iter()
            .filter(|sample| sample.clearance_m > clearance_m)
            .collect();
        Self { camera: camera.clone(), field: field.clone(), samples, config, mount_sigma, calibration: None }
    }

    /// Sets the uncertainty of the calibration, which becomes part of every pose's covariance; `None` takes lens and mount
    /// as exact.
    ///
    /// # Panics
    ///
    /// If the uncertainty is that of a lens with another number of parameters.
    pub fn with_calibration(self, calibration: Option<CalibrationUncertainty>) -> Self {
        if let Some(calibration) = &calibration {
            assert_eq!(
                calibration.covariance().nrows(),
                lens_parameters(&self.camera) + 3,
                "parameters of lens and mount"
            );
        }
        Self { calibration, ..self }
    }

    /// Returns the uncertainty of the mount pose.
    pub fn mount_sigma(&self) -> MountPoseSigma {
        self.mount_sigma
    }

    /// Fits a picture, starting from a first guess. Returns `None` if too few lines are found for six degrees of
    /// freedom.
    pub fn fit(
        &self,
        texture: &Texture,
        guess: CameraPose,
        mount: MountPose,
        contrast: f64,
        reach: Reach,
    ) -> Option<PoseFit> {
        let ranges_px = match reach {
            Reach::Wide => self.config.wide_search_px,
            Reach::Narrow => self.config.narrow_search_px,
        };
        let mut pose = guess;
        let mut last = None;
        let mut next = Some(0);
        while let Some(round) = next {
            let visible =
                visible_samples(&self.field, &self.samples, &self.camera, pose, self.config.spacing_px);
            let measure = MeasureConfig {
                search_px: ranges_px[round],
                min_contrast: self.config.min_contrast * contrast,
            };
            let offsets = measure_offsets(texture, &visible, measure);
            if offsets.len() < self.config.min_offsets {
                return None;
            }
            let step = self.solve(pose, &offsets, mount)?;
            let from = pose;
            pose = moved(pose, &step.step);
            if !pose.is_finite() || pose.height_m < self.config.min_height_ratio * mount.height_m {
                return None;
            }
            next = self.next_round(&ranges_px, round, step.moved_px());
            last = Some((from, step, offsets.len(), visible.len()));
        }
        let (from, step, offsets, visible) = last?;
        let fit = PoseFit {
            pose,
            covariance: step.covariance,
            of_calibration: Matrix6::zeros(),
            by_calibration: self.by_calibration(from, &step),
            information: step.information,
            residual_px: step.residual_px,
            found: offsets as f64 / visible.max(1) as f64,
            offsets,
        };
        Some(fit.with_calibration(self.calibration.as_ref()))
    }

    /// Returns the round after one whose step moved the lines by at most `moved_px`; `None` if the pose is found.
    ///
    /// A step leaves less to move than it moved: a round is left out if a narrower one after it searches far enough, and no
    /// other is needed once one of the narrowest has left the lines where they are.
    fn next_round(&self, ranges_px: &[f64; 5], round: usize, moved_px: f64) -> Option<usize> {
        let [.., narrowest_px] = *ranges_px;
        if ranges_px[round] <= narrowest_px && moved_px < self.config.still_px {
            return None;
        }
        let needed_px = self.config.search_per_move * moved_px;
        let is_needed = |next: &usize| {
            let after = ranges_px.get(next + 1);
            !after.is_some_and(|&after_px| after_px < ranges_px[*next] && after_px >= needed_px)
        };
        (round + 1..ranges_px.len()).find(is_needed)
    }

    /// Runs iteratively reweighted Gauss–Newton steps on one set of offsets.
    fn solve(&self, pose: CameraPose, offsets: &[LineOffset], mount: MountPose) -> Option<Step> {
        let derivatives = PoseDerivatives::at(pose);
        let rows: Vec<(Vector6<f64>, LineOffset)> = offsets
            .iter()
            .filter_map(|offset| Some((self.gradient(pose, &derivatives, offset)?, *offset)))
            .collect();
        let prior = self.mount_sigma.information();
        let mount_error = mount_error(pose, mount);
        let mut step = Vector6::zeros();
        let mut sigma =
            robust_sigma(rows.iter().map(|(_, offset)| offset.offset_px)).max(self.config.offset_sigma_px);
        let mut information = Matrix6::zeros();
        for _ in 0..self.config.iterations {
            let mut right = Vector6::zeros();
            information = Matrix6::zeros();
            for (gradient, offset) in &rows {
                let weight = self.weight(gradient, offset, &step, sigma);
                information += weight * gradient * gradient.transpose();
                right += weight * offset.offset_px * gradient;
            }
            step = (information + prior).cholesky()?.solve(&(right - prior * mount_error));
            sigma = robust_sigma(rows.iter().map(|(g, o)| o.offset_px - g.dot(&step)))
                .max(self.config.offset_sigma_px);
        }
        let covariance = (information + prior).try_inverse()?;
        Some(Step { step, covariance, information, residual_px: sigma, rows })
    }

    /// Returns the weight of an offset when the pose has moved by a step.
    fn weight(
        &self,
        gradient: &Vector6<f64>,
        offset: &LineOffset,
        step: &Vector6<f64>,
        sigma_px: f64,
    ) -> f64 {
        // Densely spaced samples share their errors: only one in `repeats` of them is independent.
        let repeats = (self.config.correlation_px / self.config.spacing_px).max(1.0);
        let scale = 1.0 / (sigma_px * sigma_px * repeats);
        scale * tukey_weight((offset.offset_px - gradient.dot(step)) / sigma_px)
    }

    /// Returns how the pose moves with the parameters of the calibration.
    fn by_calibration(&self, pose: CameraPose, step: &Step) -> ByCalibration {
        let mut coupling = Coupling::of_mount(lens_parameters(&self.camera), &self.mount_sigma.information());
        for (gradient, offset) in &step.rows {
            let weight = self.weight(gradient, offset, &step.step, step.residual_px);
            coupling.add(&self.camera, pose, offset, gradient, weight);
        }
        coupling.by_calibration(&step.covariance)
    }

    /// Returns the derivatives of the sample's offset along its normal by the six numbers of the pose, pixels per metre
    /// and per radian.
    fn gradient(
        &self,
        pose: CameraPose,
        derivatives: &PoseDerivatives,
        offset: &LineOffset,
    ) -> Option<Vector6<f64>> {
        let point = offset.visible.sample.point_in_world.extend(0.0);
        let (_, [du, dv]) = self.camera.project_with_gradients(pose.camera_from_world(point)).ok()?;
        let along_normal: DVec3 =
            offset.visible.normal_in_image.x * du + offset.visible.normal_in_image.y * dv;
        Some(Vector6::from(derivatives.of_point(point).map(|derivative| along_normal.dot(derivative))))
    }
}

struct Step {
    step: Vector6<f64>,
    covariance: Matrix6<f64>,
    information: Matrix6<f64>,
    residual_px: f64,
    /// Offsets with their derivatives.
    rows: Vec<(Vector6<f64>, LineOffset)>,
}

impl Step {
    /// Returns the farthest move of a line along its normal, pixels.
    fn moved_px(&self) -> f64 {
        self.rows.iter().map(|(gradient, _)| gradient.dot(&self.step).abs()).fold(0.0, f64::max)
    }
}

pub(super) fn mount_error(pose: CameraPose, mount: MountPose) -> Vector6<f64> {
    Vector6::new(
        0.0,
        0.0,
        0.0,
        pose.height_m - mount.height_m,
        pose.pitch_rad - mount.pitch_rad,
        wrap_angle(pose.roll_rad - mount.roll_rad),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{preprocess::whiteness, test_scene};

    /// Uses pictures of 320 × 240 pixels, in which a pixel is about 1 cm of carpet near the camera.
    #[test]
    fn a_disturbed_pose_is_found_again_in_all_six_degrees_of_freedom() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let refiner = Refiner::new(&camera, &field, RefineConfig::default(), MountPoseSigma::default());
        for pose in test_scene::poses() {
            let texture = Texture::pack(&whiteness(&test_scene::render(&camera, pose, &field)));
            let guess = moved(pose, &Vector6::new(0.02, -0.03, 0.015, 0.01, 0.006, -0.005));
            let fit = refiner.fit(&texture, guess, MountPose::of(guess), 160.0, Reach::Wide).unwrap();
            let error = pose_difference(pose, fit.pose);
            assert!(error.fixed_rows::<2>(0).norm() < 0.006, "{error:?}");
            assert!(error[2].abs() < 0.003 && error[3].abs() < 0.005, "{error:?}");
            assert!(error[4].abs() < 0.003 && error[5].abs() < 0.003, "{error:?}");
            assert!(fit.found > 0.4 && fit.residual_px < 0.4, "{fit:?}");
            let nees = (error.transpose() * fit.covariance.try_inverse().unwrap() * error)[0];
            // χ² with six degrees of freedom exceeds 30 once in 25,000 times.
            assert!(nees < 30.0, "covariance too small: {nees}");
        }
    }

    /// The truth is a fit with all rounds.
    #[test]
    fn rounds_left_out_change_a_pose_by_a_fraction_of_its_error() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let refiner = |config| Refiner::new(&camera, &field, config, MountPoseSigma::default());
        let few = refiner(RefineConfig::default());
        let all = refiner(RefineConfig::default().with_search_per_move(f64::MAX).with_still_px(0.0));
        for pose in test_scene::poses() {
            let texture = Texture::pack(&whiteness(&test_scene::render(&camera, pose, &field)));
            for far in [0.0, 0.3, 1.0] {
                let guess = moved(pose, &(far * Vector6::new(0.02, -0.03, 0.015, 0.01, 0.006, -0.005)));
                let mount = MountPose::of(guess);
                let [few, all] = [&few, &all]
                    .map(|refiner| refiner.fit(&texture, guess, mount, 160.0, Reach::Wide).unwrap());
                let off = pose_difference(all.pose, few.pose);
                let sigmas = (off.transpose() * all.covariance.try_inverse().unwrap() * off)[0].sqrt();
                // The error of a fit is √6 of them on average.
                assert!(sigmas < 0.6, "{sigmas} standard deviations");
                assert!(few.offsets.abs_diff(all.offsets) * 20 <= all.offsets, "{few:?} {all:?}");
            }
        }
    }

    /// The truth is a second fit, with a lens or a mount that is off.
    #[test]
    fn a_pose_moves_with_the_calibration_as_its_derivatives_say() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let fitted = |camera: &Camera, pose: CameraPose, mount: MountPose, texture: &Texture| {
            let refiner = Refiner::new(camera, &field, RefineConfig::default(), MountPoseSigma::default());
            refiner.fit(texture, pose, mount, 160.0, Reach::Wide).unwrap()
        };
        for pose in test_scene::poses() {
            let texture = Texture::pack(&whiteness(&test_scene::render(&camera, pose, &field)));
            let mount = MountPose::of(pose);
            let right = fitted(&camera, pose, mount, &texture);
            let mut other_lens = camera.clone();
            other_lens.fx += 0.1;
            let other_mount = MountPose { pitch_rad: mount.pitch_rad + 0.01, ..mount };
            let off = [
                (0, 0.1, fitted(&other_lens, pose, mount, &texture)),
                (lens_parameters(&camera) + 1, 0.01, fitted(&camera, pose, other_mount, &texture)),
            ];
            for (parameter, step, off) in off {
                let moved = pose_difference(right.pose, off.pose);
                let told: Vector6<f64> = step * right.by_calibration.derivatives().column(parameter);
                // In standard deviations of the picture's own fit: other lines are found from another pose.
                let information = right.covariance.try_inverse().unwrap();
                let sigmas = |step: Vector6<f64>| step.dot(&(information * step)).sqrt();
                let (off_by, told_by) = (sigmas(moved - told), sigmas(told));
                assert!(off_by < 0.4 + 0.3 * told_by, "{off_by} of {told_by}: {moved} instead of {told}");
            }
        }
    }

    #[test]
    fn nothing_is_fitted_where_no_line_is() {
        let (camera, field, pose) = (test_scene::fisheye(), test_scene::field(), test_scene::poses()[0]);
        let refiner = Refiner::new(&camera, &field, RefineConfig::default(), MountPoseSigma::default());
        let grey = Texture::pack(&image::GrayImage::from_pixel(320, 240, image::Luma([90])));
        assert!(refiner.fit(&grey, pose, MountPose::of(pose), 100.0, Reach::Wide).is_none());
        let nowhere = CameraPose { x_m: f64::NAN, ..pose };
        assert!(refiner.fit(&grey, nowhere, MountPose::of(pose), 100.0, Reach::Wide).is_none());
    }

    #[test]
    fn a_mirrored_fit_is_the_fit_of_the_mirrored_pose() {
        let fit = PoseFit {
            pose: test_scene::poses()[0],
            covariance: Matrix6::from_fn(|i, j| if i == j { 2.0 } else { 0.1 * (i + j) as f64 }),
            of_calibration: Matrix6::zeros(),
            by_calibration: ByCalibration::default(),
            information: Matrix6::identity(),
            residual_px: 0.1,
            found: 1.0,
            offsets: 9,
        };
        let (mirrored, again) = (fit.mirrored(), fit.mirrored().mirrored());
        assert_eq!(mirrored.covariance[(0, 1)], fit.covariance[(0, 1)], "x and y turn together");
        assert_eq!(mirrored.covariance[(0, 2)], -fit.covariance[(0, 2)], "yaw does not");
        assert!(pose_difference(fit.pose, again.pose).norm() < 1e-12);
    }
}
