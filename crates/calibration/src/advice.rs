//! Which pictures to add: places from which the lines would tell most of what is still uncertain.

use nalgebra::{DMatrix, Matrix6};
use rayon::prelude::*;
use reality_sim_core::{
    field::FieldDimensions,
    mount::MountPose,
    pose::{CameraPose, Pose2},
};

use crate::{
    noise::Noise,
    parameter::Parameter,
    picture::{Gradients, Lines},
    state::State,
    uncertainty::{Cells, gradients},
};

/// Number of pictures that are advised from each place.
const PICTURES: f64 = 10.0;

/// Part of the lines in view that is usually found: robots and people hide some.
const FOUND: f64 = 0.6;

/// Distance between the places that are compared, metres.
const STEP_M: f64 = 1.0;

/// Number of headings that are compared at each place.
const HEADINGS: u32 = 8;

/// Turns of the head that are compared, radians down from the usual pitch.
const NODS_RAD: [f64; 3] = [-0.2, 0.0, 0.3];

/// Number of places that are advised.
const ADVISED: usize = 2;

/// Least improvement that is worth a walk: the uncertainty falls by a tenth.
const WORTH: f64 = 0.9;

/// Place from which more pictures would help.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advice {
    /// Pose of the camera, in one of the two equal halves of the field.
    pub pose: CameraPose,
    /// Number of pictures.
    pub pictures: u32,
    /// Root mean square of the projection's uncertainty over the picture, before and after, pixels.
    pub rms_px: [f64; 2],
}

/// What is known of lens and mount.
pub(crate) struct Known<'a> {
    pub state: &'a State,
    pub parameters: &'a [Parameter],
    pub covariance: &'a DMatrix<f64>,
    pub noise: Noise,
    /// Usual pitch and roll, as stated.
    pub usual: MountPose,
}

/// Returns the places from which pictures help most, best first, each after the ones before it.
pub(crate) fn advise(known: &Known<'_>, lines: &Lines, field: &FieldDimensions) -> Vec<Advice> {
    let Some(mut information) = known.covariance.clone().try_inverse() else { return Vec::new() };
    let measure = Measure::new(known);
    let views: Vec<(CameraPose, DMatrix<f64>)> = places(known, field)
        .into_par_iter()
        .filter_map(|pose| Some((pose, PICTURES * known.information_from(pose, lines)?)))
        .collect();
    let mut advised = Vec::new();
    let mut before = measure.rms_px(known.covariance);
    for _ in 0..ADVISED {
        let rms = |added: &DMatrix<f64>| {
            (&information + added)
                .try_inverse()
                .map_or(f64::INFINITY, |covariance| measure.rms_px(&covariance))
        };
        let is_new = |pose: &CameraPose| advised.iter().all(|advice: &Advice| advice.pose != *pose);
        let best = views
            .par_iter()
            .filter(|(pose, _)| is_new(pose))
            .map(|(pose, added)| (rms(added), *pose, added))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((after, pose, added)) = best.filter(|(after, ..)| *after < WORTH * before) else { break };
        advised.push(Advice { pose, pictures: PICTURES as u32, rms_px: [before, after] });
        information += added;
        before = after;
    }
    advised
}

/// Returns poses all over one half of the field.
fn places(known: &Known<'_>, field: &FieldDimensions) -> Vec<CameraPose> {
    let along = |half: f64| {
        let steps = (half / STEP_M).floor() as i32;
        (-steps..=steps).map(move |step| f64::from(step) * STEP_M)
    };
    let mut poses = Vec::new();
    for x_m in along(0.5 * field.length_m).filter(|x_m| *x_m <= 0.0) {
        for y_m in along(0.5 * field.width_m) {
            for heading in 0..HEADINGS {
                let yaw_rad = std::f64::consts::TAU * f64::from(heading) / f64::from(HEADINGS);
                let place = Pose2::new(x_m, y_m, reality_sim_core::pose::wrap_angle(yaw_rad));
                poses.extend(NODS_RAD.map(|nod_rad| {
                    let stated = MountPose { pitch_rad: known.usual.pitch_rad + nod_rad, ..known.usual };
                    known.state.mount_pose(stated).at(place)
                }));
            }
        }
    }
    poses
}

/// Mean over the picture of what the parameters' errors do to the projection.
struct Measure(DMatrix<f64>);

impl Measure {
    fn new(known: &Known<'_>) -> Self {
        let count = known.parameters.len();
        let (mut sum, mut cells) = (DMatrix::zeros(count, count), 0.0);
        for pixel in Cells::of(known.state).middles() {
            if let Some(gradients) = gradients(known.state, known.parameters, pixel) {
                sum += gradients.transpose() * &gradients;
                cells += 1.0;
            }
        }
        Self(sum / f64::max(cells, 1.0))
    }

    fn rms_px(&self, covariance: &DMatrix<f64>) -> f64 {
        (&self.0 * covariance).trace().max(0.0).sqrt()
    }
}

impl Known<'_> {
    /// Returns what one picture from a pose would tell of the parameters; `None` if it shows too little.
    fn information_from(&self, pose: CameraPose, lines: &Lines) -> Option<DMatrix<f64>> {
        let visible = lines.visible(self.state, pose);
        let config = lines.config();
        if visible.len() < 3 * config.min_offsets {
            return None;
        }
        let weight = FOUND / (self.noise.offset_px * self.noise.offset_px * self.noise.repeats);
        let at = Gradients::new(self.state, pose, self.parameters);
        let count = self.parameters.len();
        let mut of_pose: Matrix6<f64> = self.noise.information() + Matrix6::identity() * 1e-6;
        let (mut of_parameters, mut between) = (DMatrix::zeros(count, count), DMatrix::zeros(6, count));
        for sample in &visible {
            let Some((by_pose, by_parameters)) = at.of_sample(sample) else { continue };
            of_pose += weight * by_pose * by_pose.transpose();
            of_parameters.ger(weight, &by_parameters, &by_parameters, 1.0);
            between.ger(weight, &by_pose, &by_parameters, 1.0);
        }
        self.add_mount(&mut of_parameters, &mut between);
        let inverse = of_pose.cholesky()?.inverse();
        Some(of_parameters - between.transpose() * inverse * between)
    }

    /// Adds that joints and IMU hold the pose to the mount.
    fn add_mount(&self, of_parameters: &mut DMatrix<f64>, between: &mut DMatrix<f64>) {
        let information = self.noise.information();
        let of_mount = [Parameter::Height, Parameter::MountPitch, Parameter::MountRoll];
        for (axis, parameter) in of_mount.into_iter().enumerate() {
            let Some(column) = self.parameters.iter().position(|other| *other == parameter) else { continue };
            let weight = information[(axis + 3, axis + 3)];
            of_parameters[(column, column)] += weight;
            between[(axis + 3, column)] -= weight;
        }
    }
}
