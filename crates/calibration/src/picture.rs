//! One picture of the recording, and the lines that are measured in it.

use glam::{DMat3, DVec2, DVec3};
use nalgebra::{DVector, Vector6};
use reality_sim_core::{
    field::{FieldDimensions, LineSample, VisibleSample, sample_lines, visible_samples},
    mount::MountPose,
    pose::CameraPose,
    preprocess::{Prepared, Texture},
    refine::{LineOffset, MeasureConfig, RefineConfig, measure_offsets, moved},
};

use crate::{parameter::Parameter, state::State};

/// Step of the numeric derivatives by the numbers of a pose, metres and radians.
const STEP: f64 = 1e-5;

/// Picture that lines are measured in.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    /// Frame of the recording, counted from 0.
    pub frame: usize,
    /// Whiteness.
    pub texture: Texture,
    /// Usual difference between lines and carpet, grey levels.
    pub contrast: f64,
    /// Pitch and roll as the recording states them; the height is not used.
    pub stated: MountPose,
}

impl Picture {
    /// Takes what is measured of a prepared picture.
    pub fn new(frame: usize, prepared: &Prepared, stated: MountPose) -> Self {
        let texture = Texture::pack(&prepared.whiteness);
        Self { frame, texture, contrast: f64::from(prepared.levels.contrast()), stated }
    }
}

/// A line found beside its projection: the offset between the two, and its derivatives.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Distance from the projected to the measured centre across the line, pixels.
    pub offset_px: f64,
    /// Derivatives of the projection, along the same direction, by x, y, yaw, height, pitch and roll.
    pub by_pose: Vector6<f64>,
    /// Derivatives by the parameters.
    pub by_parameters: DVector<f64>,
    /// Where the line is projected, pixels.
    pub pixel: DVec2,
    /// Line of the field, by its place in [`FieldDimensions::curves`].
    pub curve: usize,
}

/// Lines of a field, prepared for measuring them.
#[derive(Debug, Clone)]
pub(crate) struct Lines {
    field: FieldDimensions,
    samples: Vec<LineSample>,
    config: RefineConfig,
}

/// Lines measured in one picture.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    /// Lines that were found.
    pub rows: Vec<Row>,
    /// Number of places at which one was looked for.
    pub looked_at: usize,
}

impl Lines {
    /// Prepares the lines of a field.
    pub fn new(field: &FieldDimensions, config: RefineConfig) -> Self {
        let clearance_m = config.min_clearance_line_widths * field.line_width_m;
        let samples = sample_lines(field, config.spacing_m);
        let samples = samples.into_iter().filter(|sample| sample.clearance_m > clearance_m).collect();
        Self { field: field.clone(), samples, config }
    }

    /// Returns the settings with which lines are measured.
    pub fn config(&self) -> &RefineConfig {
        &self.config
    }

    /// Returns the places at which a camera sees lines.
    pub fn visible(&self, state: &State, pose: CameraPose) -> Vec<VisibleSample> {
        visible_samples(&self.field, &self.samples, &state.camera, pose, self.config.spacing_px)
    }

    /// Measures the lines in a picture, at most so many pixels from where they are projected.
    pub fn measure(
        &self,
        picture: &Picture,
        (state, pose): (&State, CameraPose),
        parameters: &[Parameter],
        search_px: f64,
    ) -> Measured {
        let visible = self.visible(state, pose);
        let config = MeasureConfig { search_px, min_contrast: self.config.min_contrast * picture.contrast };
        let offsets = measure_offsets(&picture.texture, &visible, config);
        let gradients = Gradients::new(state, pose, parameters);
        let rows = offsets.iter().filter_map(|offset| gradients.row(offset)).collect();
        Measured { rows, looked_at: visible.len() }
    }
}

/// Derivatives at one pose.
pub(crate) struct Gradients<'a> {
    state: &'a State,
    parameters: &'a [Parameter],
    pose: CameraPose,
    camera_from_world: DMat3,
    /// Poses a step behind and a step ahead in each number.
    beside: [[(DMat3, DVec3); 2]; 6],
}

impl<'a> Gradients<'a> {
    pub fn new(state: &'a State, pose: CameraPose, parameters: &'a [Parameter]) -> Self {
        let placed =
            |pose: CameraPose| (pose.rotation_world_from_camera().transpose(), pose.position_in_world());
        let beside = std::array::from_fn(|axis| {
            [-STEP, STEP].map(|step| {
                let mut change = Vector6::zeros();
                change[axis] = step;
                placed(moved(pose, &change))
            })
        });
        let camera_from_world = placed(pose).0;
        Self { state, parameters, pose, camera_from_world, beside }
    }

    fn row(&self, offset: &LineOffset) -> Option<Row> {
        let (by_pose, by_parameters) = self.of_sample(&offset.visible)?;
        let visible = &offset.visible;
        Some(Row {
            offset_px: offset.offset_px,
            by_pose,
            by_parameters,
            pixel: visible.pixel,
            curve: visible.sample.curve,
        })
    }

    /// Returns the derivatives of a sample's projection across its line, by the pose and by the parameters.
    pub fn of_sample(&self, visible: &VisibleSample) -> Option<(Vector6<f64>, DVector<f64>)> {
        let (point, normal) = (visible.sample.point_in_world.extend(0.0), visible.normal_in_image);
        let in_camera = self.camera_from_world * (point - self.pose.position_in_world());
        let (_, [du, dv]) = self.state.camera.project_with_gradients(in_camera).ok()?;
        let across = normal.x * du + normal.y * dv;
        let by_pose = Vector6::from_fn(|axis, _| {
            let [behind, ahead] = self.beside[axis].map(|(rotation, place)| rotation * (point - place));
            across.dot(ahead - behind) / (2.0 * STEP)
        });
        let lens = self.state.lens_gradients(self.parameters, in_camera)?;
        let by_parameters = DVector::from_iterator(lens.len(), lens.iter().map(|lens| normal.dot(*lens)));
        Some((by_pose, by_parameters))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use reality_sim_core::{
        camera::{Camera, Distortion, OpencvFisheye},
        pose::Pose2,
    };

    use super::*;

    const PARAMETERS: [Parameter; 5] = [
        Parameter::FocalLength,
        Parameter::AspectRatio,
        Parameter::PrincipalX,
        Parameter::PrincipalY,
        Parameter::Distortion(1),
    ];

    fn state() -> State {
        let distortion = Distortion::OpencvFisheye(OpencvFisheye { k: [-0.05, 0.008, -0.001, 0.0] });
        let camera = Camera::new([640, 480], [215.0, 217.0, 321.0, 243.0], distortion).unwrap();
        State { camera, height_m: 0.5, pitch_rad: 0.01, roll_rad: -0.02 }
    }

    proptest! {
        /// The truth projects the point with a state and a pose that have moved.
        #[test]
        fn derivatives_are_those_of_the_projection(x in -2.0..2.0_f64, y in -1.5..1.5_f64, yaw in -3.0..3.0_f64, pitch in 0.0..0.6_f64) {
            let (state, pose) = (state(), CameraPose::new(Pose2::new(x, y, yaw), 0.5, pitch, 0.03));
            let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
            let lines = Lines::new(&field, RefineConfig::default());
            let gradients = Gradients::new(&state, pose, &PARAMETERS);
            for visible in lines.visible(&state, pose).iter().step_by(7) {
                let across = |state: &State, pose: CameraPose| {
                    let point = pose.camera_from_world(visible.sample.point_in_world.extend(0.0));
                    state.camera.project_unbounded(point).unwrap().dot(visible.normal_in_image)
                };
                let (by_pose, by_parameters) = gradients.of_sample(visible).unwrap();
                for (index, parameter) in PARAMETERS.iter().enumerate() {
                    let moved = |step: f64| state.stepped(&[*parameter], &DVector::from_element(1, step)).unwrap();
                    let truth = (across(&moved(1e-5), pose) - across(&moved(-1e-5), pose)) / 2e-5;
                    prop_assert!((by_parameters[index] - truth).abs() < 1e-4 * (1.0 + truth.abs()), "{parameter:?}");
                }
                for axis in 0..6 {
                    let beside = |step: f64| {
                        let mut change = Vector6::zeros();
                        change[axis] = step;
                        across(&state, moved(pose, &change))
                    };
                    let truth = (beside(1e-6) - beside(-1e-6)) / 2e-6;
                    prop_assert!((by_pose[axis] - truth).abs() < 1e-3 * (1.0 + truth.abs()), "axis {axis}");
                }
            }
        }
    }
}
