//! Lens and mount at one step of a calibration.

use glam::{DVec2, DVec3};
use nalgebra::DVector;
use reality_sim_core::{
    camera::{Camera, Distortion, InvalidCamera, Opencv, OpencvFisheye},
    mount::MountPose,
    sequence::Mounting,
};

use crate::parameter::Parameter;

/// Lens and mount.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State {
    /// Lens and size of the pictures.
    pub camera: Camera,
    /// Nominal height of the projection centre above the carpet, metres.
    pub height_m: f64,
    /// Turn of the camera against the stated pitch, radians.
    pub pitch_rad: f64,
    /// Turn of the camera against the stated roll, radians.
    pub roll_rad: f64,
}

impl State {
    /// Returns where the camera is against what the recording states.
    pub fn mounting(&self) -> Mounting {
        Mounting { pitch_rad: self.pitch_rad, roll_rad: self.roll_rad, ..Mounting::default() }
    }

    /// Returns the mount pose of a picture whose pitch and roll are stated.
    pub fn mount_pose(&self, stated: MountPose) -> MountPose {
        self.mounting().mount_pose(MountPose { height_m: self.height_m, ..stated })
    }

    /// Returns the value of a parameter.
    pub fn value(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::FocalLength => self.camera.fx,
            Parameter::AspectRatio => self.camera.fy / self.camera.fx,
            Parameter::PrincipalX => self.camera.cx,
            Parameter::PrincipalY => self.camera.cy,
            Parameter::Distortion(index) => {
                self.camera.distortion.parameters().get(index).copied().unwrap_or(0.0)
            }
            Parameter::Height => self.height_m,
            Parameter::MountPitch => self.pitch_rad,
            Parameter::MountRoll => self.roll_rad,
        }
    }

    /// Returns the state after a step in some parameters. Fails if there is no such camera.
    pub fn stepped(&self, parameters: &[Parameter], step: &DVector<f64>) -> Result<Self, InvalidCamera> {
        let mut values = Values::of(self);
        for (parameter, step) in parameters.iter().zip(step.iter()) {
            *values.of_parameter(*parameter) += step;
        }
        values.state(&self.camera)
    }

    /// Returns the derivatives of a pixel by the parameters of the lens among those given, 0 for the others; `None` if the
    /// camera does not see the point.
    pub fn lens_gradients(&self, parameters: &[Parameter], point_in_camera: DVec3) -> Option<Vec<DVec2>> {
        let all = self.camera.intrinsic_gradients(point_in_camera).ok()?;
        let aspect_ratio = self.camera.fy / self.camera.fx;
        let gradient = |parameter: &Parameter| match parameter {
            Parameter::FocalLength => all[0] + aspect_ratio * all[1],
            Parameter::AspectRatio => self.camera.fx * all[1],
            Parameter::PrincipalX => all[2],
            Parameter::PrincipalY => all[3],
            Parameter::Distortion(index) => all.get(4 + index).copied().unwrap_or_default(),
            Parameter::Height | Parameter::MountPitch | Parameter::MountRoll => DVec2::ZERO,
        };
        Some(parameters.iter().map(gradient).collect())
    }
}

/// Numbers of a state.
struct Values {
    focal_px: f64,
    aspect_ratio: f64,
    principal: DVec2,
    distortion: Vec<f64>,
    height_m: f64,
    pitch_rad: f64,
    roll_rad: f64,
}

impl Values {
    fn of(state: &State) -> Self {
        let camera = &state.camera;
        let mut distortion = camera.distortion.parameters();
        distortion.resize(5, 0.0);
        Self {
            focal_px: camera.fx,
            aspect_ratio: camera.fy / camera.fx,
            principal: DVec2::new(camera.cx, camera.cy),
            distortion,
            height_m: state.height_m,
            pitch_rad: state.pitch_rad,
            roll_rad: state.roll_rad,
        }
    }

    fn of_parameter(&mut self, parameter: Parameter) -> &mut f64 {
        match parameter {
            Parameter::FocalLength => &mut self.focal_px,
            Parameter::AspectRatio => &mut self.aspect_ratio,
            Parameter::PrincipalX => &mut self.principal.x,
            Parameter::PrincipalY => &mut self.principal.y,
            Parameter::Distortion(index) => &mut self.distortion[index.min(4)],
            Parameter::Height => &mut self.height_m,
            Parameter::MountPitch => &mut self.pitch_rad,
            Parameter::MountRoll => &mut self.roll_rad,
        }
    }

    fn state(self, like: &Camera) -> Result<State, InvalidCamera> {
        let d = &self.distortion;
        let distortion = match like.distortion {
            Distortion::Pinhole => Distortion::Pinhole,
            Distortion::Opencv(_) => {
                Distortion::Opencv(Opencv { k1: d[0], k2: d[1], p1: d[2], p2: d[3], k3: d[4] })
            }
            Distortion::OpencvFisheye(_) => {
                Distortion::OpencvFisheye(OpencvFisheye { k: [d[0], d[1], d[2], d[3]] })
            }
        };
        let intrinsics =
            [self.focal_px, self.focal_px * self.aspect_ratio, self.principal.x, self.principal.y];
        let camera = Camera::new([like.width, like.height], intrinsics, distortion)?;
        Ok(State {
            camera: camera.with_image_circle(like.image_circle),
            height_m: self.height_m,
            pitch_rad: self.pitch_rad,
            roll_rad: self.roll_rad,
        })
    }
}
