//! Adjustment of the parameters and of all poses together, so that the projected lines meet the measured ones: reweighted
//! Gauss–Newton steps on normal equations from which the poses are eliminated, as in every bundle adjustment (Triggs et al.,
//! "Bundle adjustment – a modern synthesis", 2000). Given the parameters, the pictures do not depend on each other.

use nalgebra::{DMatrix, DVector, Matrix6, Vector3, Vector6};
use rayon::prelude::*;
use reality_sim_core::{
    pose::{CameraPose, wrap_angle},
    refine::{moved, pose_difference},
    statistics::{TUKEY, robust_sigma, tukey_weight},
};

use crate::{
    correlation::Correlation,
    noise::Noise,
    parameter::Parameter,
    picture::{Lines, Measured, Picture, Row},
    state::State,
};

/// Number of steps on one set of measured lines: further ones change nothing that matters.
const STEPS: usize = 4;

/// Smallest number of lines in a picture that is used: four for each number of its pose.
const LEAST_ROWS: usize = 24;

/// Smallest part of the lines in view that must be found in a picture that is used: at wrong places it is about a quarter.
const LEAST_FOUND: f64 = 0.3;

/// A picture and where it was taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub picture: &'a Picture,
    pub pose: CameraPose,
}

/// What was known of the parameters beforehand.
#[derive(Debug, Clone)]
pub(crate) struct Prior {
    pub mean: DVector<f64>,
    pub sigma: DVector<f64>,
}

impl Prior {
    /// Returns what is known before any picture: the state itself, to within each parameter's usual range.
    pub fn around(state: &State, parameters: &[Parameter]) -> Self {
        let of = |value: &dyn Fn(Parameter) -> f64| {
            DVector::from_iterator(parameters.len(), parameters.iter().map(|parameter| value(*parameter)))
        };
        Self {
            mean: of(&|parameter| match parameter {
                Parameter::Distortion(_) => 0.0,
                parameter => state.value(parameter),
            }),
            sigma: of(&|parameter| parameter.prior_sigma(&state.camera, state.height_m)),
        }
    }

    /// Returns the prior with another range for the parameters of the lens, as a multiple of the usual one.
    pub fn scaled(mut self, parameters: &[Parameter], lens: f64) -> Self {
        for (sigma, parameter) in self.sigma.iter_mut().zip(parameters) {
            *sigma *= if parameter.is_of_lens() { lens } else { 1.0 };
        }
        self
    }
}

/// Result of an adjustment.
#[derive(Debug, Clone)]
pub(crate) struct Adjusted {
    pub state: State,
    /// Poses of the pictures.
    pub poses: Vec<CameraPose>,
    /// Whether each picture was used.
    pub used: Vec<bool>,
    /// Inverse covariance of the parameters, if lines erred independently.
    pub information: DMatrix<f64>,
    /// Sum over the pictures of the squared pull of each on the parameters.
    pub pulls: DMatrix<f64>,
    pub noise: Noise,
    /// Where lines were measured in the pictures used, pixels.
    pub measured: Vec<glam::DVec2>,
}

/// An adjustment in progress.
pub(crate) struct Adjustment<'a> {
    pub lines: &'a Lines,
    pub parameters: &'a [Parameter],
    pub prior: Prior,
    pub noise: Noise,
}

impl Adjustment<'_> {
    /// Adjusts state and poses, measuring the lines anew for each of these search ranges. Returns `None` if no picture shows
    /// enough lines or the equations cannot be solved.
    pub fn run(&self, state: &State, views: &[View<'_>], search_px: &[f64]) -> Option<Adjusted> {
        let mut state = state.clone();
        let mut views = views.to_vec();
        let mut result = None;
        let mut noise = self.noise;
        for &search_px in search_px {
            let measured = self.measure(&state, &views, search_px);
            let used: Vec<bool> = measured.iter().map(is_usable).collect();
            result = Some(self.solve(&mut state, &mut views, &measured, &used, &mut noise)?);
        }
        result
    }

    fn measure(&self, state: &State, views: &[View<'_>], search_px: f64) -> Vec<Measured> {
        let measure = |view: &View<'_>| {
            self.lines.measure(view.picture, (state, view.pose), self.parameters, search_px)
        };
        views.par_iter().map(measure).collect()
    }

    /// Takes some steps on one set of measured lines.
    fn solve(
        &self,
        state: &mut State,
        views: &mut [View<'_>],
        measured: &[Measured],
        used: &[bool],
        noise: &mut Noise,
    ) -> Option<Adjusted> {
        let (first_state, first_poses) = (state.clone(), poses(views));
        let rows = || measured.iter().zip(used).filter(|(_, used)| **used).flat_map(|(m, _)| &m.rows);
        rows().next()?;
        let floor = self.lines.config().offset_sigma_px;
        let mut residual = Residuals::of(measured);
        noise.offset_px = residual.sigma().max(floor);
        let mut system = System::of(&[], self.prior_terms(state));
        for _ in 0..STEPS {
            let blocks: Vec<Option<Block>> = (0..views.len())
                .into_par_iter()
                .map(|index| {
                    let block =
                        || self.block(state, views[index], &measured[index].rows, &residual.0[index], noise);
                    used[index].then(block).flatten()
                })
                .collect();
            system = System::of(&blocks, self.prior_terms(state));
            let step = system.step()?;
            *state = self.damped(state, &step)?;
            for (view, block) in views.iter_mut().zip(&blocks) {
                if let Some(block) = block {
                    view.pose = moved(view.pose, &block.step(&step));
                }
            }
            residual =
                Residuals::after(measured, (&first_state, &first_poses), (state, views), self.parameters);
            noise.offset_px = residual.sigma_of(used).max(floor);
            noise.repeats = self.repeats(measured, &residual, used, noise);
            *noise = self.learned(state, views, &blocks, noise);
        }
        Some(Adjusted {
            state: state.clone(),
            poses: poses(views),
            used: used.to_vec(),
            information: system.information,
            pulls: system.pulls,
            noise: *noise,
            measured: rows().map(|row| row.pixel).collect(),
        })
    }

    /// Returns the state after a step, or after a part of it where the whole leads to no camera.
    fn damped(&self, state: &State, step: &DVector<f64>) -> Option<State> {
        [1.0, 0.5, 0.25, 0.1].iter().find_map(|part| {
            let stepped = state.stepped(self.parameters, &(*part * step)).ok()?;
            (stepped.height_m > 0.0).then_some(stepped)
        })
    }

    fn prior_terms(&self, state: &State) -> (DMatrix<f64>, DVector<f64>) {
        let weights = self.prior.sigma.map(|sigma| 1.0 / (sigma * sigma));
        let value = |parameter: &Parameter| state.value(*parameter);
        let values = DVector::from_iterator(self.parameters.len(), self.parameters.iter().map(value));
        (DMatrix::from_diagonal(&weights), weights.component_mul(&(&self.prior.mean - values)))
    }

    /// Returns the normal equations of one picture.
    fn block(
        &self,
        state: &State,
        view: View<'_>,
        rows: &[Row],
        residuals: &[f64],
        noise: &Noise,
    ) -> Option<Block> {
        let count = self.parameters.len();
        let scale = 1.0 / (noise.offset_px * noise.offset_px * noise.repeats);
        let mut block = Block::zeros(count);
        for (row, &residual) in rows.iter().zip(residuals) {
            let weight = scale * tukey_weight(residual / noise.offset_px);
            block.add(&row.by_pose, &row.by_parameters, residual, weight);
        }
        let mount = MountTerm::new(state, view, self.parameters);
        let information = noise.information();
        for axis in 3..6 {
            let mut by_pose = Vector6::zeros();
            by_pose[axis] = 1.0;
            let by_parameters = mount.by_parameters.row(axis - 3).transpose();
            block.add(&by_pose, &by_parameters, mount.error[axis - 3], information[(axis, axis)]);
        }
        block.eliminated()
    }

    /// Returns how many measured points count as one: as many as in pictures without any fault of the lens, or as their errors
    /// show.
    fn repeats(&self, measured: &[Measured], residual: &Residuals, used: &[bool], noise: &Noise) -> f64 {
        let mut correlation = Correlation::default();
        let pictures = measured.iter().zip(&residual.0).zip(used).filter(|(_, used)| **used);
        pictures.for_each(|((m, residuals), _)| correlation.add(&m.rows, residuals, TUKEY * noise.offset_px));
        let config = self.lines.config();
        correlation.points_that_count_as_one().max(config.correlation_px / config.spacing_px)
    }

    /// Returns the noise of the mount pose as the fitted poses show it.
    fn learned(&self, state: &State, views: &[View<'_>], blocks: &[Option<Block>], noise: &Noise) -> Noise {
        let fitted = views.iter().zip(blocks).filter_map(|(view, block)| Some((view, block.as_ref()?)));
        let (deviations, variances): (Vec<Vector3<f64>>, Vec<Vector3<f64>>) = fitted
            .map(|(view, block)| {
                let error = MountTerm::new(state, *view, &[]).error;
                (error, Vector3::from_fn(|axis, _| block.inverse[(axis + 3, axis + 3)]))
            })
            .unzip();
        match deviations.len() {
            0..10 => *noise,
            _ => noise.learned(&deviations, &variances),
        }
    }
}

fn poses(views: &[View<'_>]) -> Vec<CameraPose> {
    views.iter().map(|view| view.pose).collect()
}

fn is_usable(measured: &Measured) -> bool {
    measured.rows.len() >= LEAST_ROWS && measured.rows.len() as f64 >= LEAST_FOUND * measured.looked_at as f64
}

/// Distances that remain between projected and measured lines, for each picture.
struct Residuals(Vec<Vec<f64>>);

impl Residuals {
    fn of(measured: &[Measured]) -> Self {
        Self(measured.iter().map(|m| m.rows.iter().map(|row| row.offset_px).collect()).collect())
    }

    /// Returns what remains, to first order, after state and poses have changed since the lines were measured.
    fn after(
        measured: &[Measured],
        (first_state, first_poses): (&State, &[CameraPose]),
        (state, views): (&State, &[View<'_>]),
        parameters: &[Parameter],
    ) -> Self {
        let change = |parameter: &Parameter| state.value(*parameter) - first_state.value(*parameter);
        let by_parameters = DVector::from_iterator(parameters.len(), parameters.iter().map(change));
        let of_picture = |index: usize| {
            let by_pose = pose_difference(first_poses[index], views[index].pose);
            let left =
                |row: &Row| row.offset_px - row.by_pose.dot(&by_pose) - row.by_parameters.dot(&by_parameters);
            measured[index].rows.iter().map(left).collect()
        };
        Self((0..measured.len()).map(of_picture).collect())
    }

    fn sigma(&self) -> f64 {
        robust_sigma(self.0.iter().flatten().copied())
    }

    fn used<'a>(&'a self, used: &'a [bool]) -> impl Iterator<Item = f64> + 'a {
        self.0
            .iter()
            .zip(used)
            .filter(|(_, used)| **used)
            .flat_map(|(of_picture, _)| of_picture.iter().copied())
    }

    fn sigma_of(&self, used: &[bool]) -> f64 {
        robust_sigma(self.used(used))
    }
}

/// How far a pose is from what joints and IMU tell through the mount, and how that depends on the mount's parameters.
struct MountTerm {
    /// What the mount says minus what the pose has: height, pitch and roll.
    error: Vector3<f64>,
    /// Derivatives of the pose minus the mount by the parameters.
    by_parameters: DMatrix<f64>,
}

impl MountTerm {
    fn new(state: &State, view: View<'_>, parameters: &[Parameter]) -> Self {
        let told = |state: &State| {
            let mount = state.mount_pose(view.picture.stated);
            Vector3::new(mount.height_m, mount.pitch_rad, mount.roll_rad)
        };
        let pose = view.pose;
        let here = told(state);
        let error = Vector3::new(
            here[0] - pose.height_m,
            here[1] - pose.pitch_rad,
            wrap_angle(here[2] - pose.roll_rad),
        );
        let mut by_parameters = DMatrix::zeros(3, parameters.len());
        for (column, parameter) in parameters.iter().enumerate() {
            let beside = |step: f64| {
                let mut state = state.clone();
                match parameter {
                    Parameter::Height => state.height_m += step,
                    Parameter::MountPitch => state.pitch_rad += step,
                    Parameter::MountRoll => state.roll_rad += step,
                    _ => return None,
                }
                Some(told(&state))
            };
            if let (Some(behind), Some(ahead)) = (beside(-1e-5), beside(1e-5)) {
                by_parameters.set_column(column, &((behind - ahead) / 2e-5));
            }
        }
        Self { error, by_parameters }
    }
}

/// Normal equations of one picture: of its pose, of the parameters, and between the two.
struct Block {
    of_pose: Matrix6<f64>,
    inverse: Matrix6<f64>,
    pose_right: Vector6<f64>,
    of_parameters: DMatrix<f64>,
    right: DVector<f64>,
    between: DMatrix<f64>,
}

impl Block {
    fn zeros(count: usize) -> Self {
        Self {
            of_pose: Matrix6::identity() * 1e-6,
            inverse: Matrix6::zeros(),
            pose_right: Vector6::zeros(),
            of_parameters: DMatrix::zeros(count, count),
            right: DVector::zeros(count),
            between: DMatrix::zeros(6, count),
        }
    }

    fn add(&mut self, by_pose: &Vector6<f64>, by_parameters: &DVector<f64>, residual: f64, weight: f64) {
        if weight == 0.0 {
            return;
        }
        self.of_pose += weight * by_pose * by_pose.transpose();
        self.pose_right += weight * residual * by_pose;
        self.of_parameters.ger(weight, by_parameters, by_parameters, 1.0);
        self.right.axpy(weight * residual, by_parameters, 1.0);
        self.between.ger(weight, by_pose, by_parameters, 1.0);
    }

    /// Inverts the part of the pose; `None` if it cannot be.
    fn eliminated(self) -> Option<Self> {
        let inverse = self.of_pose.cholesky()?.inverse();
        Some(Self { inverse, ..self })
    }

    /// Returns the information and the pull that are left for the parameters when the pose is free.
    fn reduced(&self) -> (DMatrix<f64>, DVector<f64>) {
        let carried = self.between.transpose() * self.inverse;
        (&self.of_parameters - &carried * &self.between, &self.right - carried * self.pose_right)
    }

    /// Returns the step of the pose that goes with a step of the parameters.
    fn step(&self, of_parameters: &DVector<f64>) -> Vector6<f64> {
        self.inverse * (self.pose_right - &self.between * of_parameters)
    }
}

/// Normal equations of the parameters.
struct System {
    information: DMatrix<f64>,
    right: DVector<f64>,
    pulls: DMatrix<f64>,
}

impl System {
    fn of(blocks: &[Option<Block>], (information, right): (DMatrix<f64>, DVector<f64>)) -> Self {
        let mut system = Self { pulls: information.clone(), information, right };
        for block in blocks.iter().flatten() {
            let (information, right) = block.reduced();
            system.information += information;
            system.pulls.ger(1.0, &right, &right, 1.0);
            system.right += right;
        }
        system
    }

    fn step(&self) -> Option<DVector<f64>> {
        if self.right.is_empty() {
            return Some(DVector::zeros(0));
        }
        Some(self.information.clone().cholesky()?.solve(&self.right))
    }
}
