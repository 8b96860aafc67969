//! Things that a simulator adds to a picture.

use std::sync::Arc;

use numpy::{
    PyReadonlyArray2, PyReadonlyArray3,
    ndarray::{ArrayView2, ArrayView3},
};
use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::{
    Pose2,
    glam::{DVec2, DVec3, Vec3},
    sensor::linear_from_srgb,
    simulator::{self, Class, CubeFace, CubeLayer, CubeSide, NO_CUBE_OBJECT, PixelBox, Sphere},
};

use crate::pose::camera_pose;

/// Something that is drawn over the recorded scene.
#[pyclass(frozen, subclass, module = "reality_sim")]
#[derive(Debug)]
pub struct Layer(pub Arc<dyn simulator::Layer>);

/// Ball of one colour.
#[pyclass(frozen, extends = Layer, module = "reality_sim")]
#[derive(Debug)]
pub struct Ball;

#[pymethods]
impl Ball {
    #[new]
    #[pyo3(signature = (x_m, y_m, z_m = None, *, radius_m = 0.065, color = [255, 128, 0], gloss = 0.0, velocity_m_s = [0.0; 3], name = "ball"))]
    #[expect(clippy::too_many_arguments, reason = "Python's keywords")]
    fn new(
        x_m: f64,
        y_m: f64,
        z_m: Option<f64>,
        radius_m: f64,
        color: [u8; 3],
        gloss: f32,
        velocity_m_s: [f64; 3],
        name: &str,
    ) -> PyResult<PyClassInitializer<Self>> {
        finite("Ball", &[x_m, y_m, z_m.unwrap_or(0.0), velocity_m_s[0], velocity_m_s[1], velocity_m_s[2]])?;
        positive("radius_m", radius_m)?;
        let mut ball = simulator::Ball::on_ground(x_m, y_m, radius_m, reflectance(color));
        ball.center_in_world.z = z_m.unwrap_or(radius_m);
        let ball = ball.glossy(gloss).named(name).moving(DVec3::from_array(velocity_m_s));
        Ok(PyClassInitializer::from(Layer(Arc::new(ball))).add_subclass(Self))
    }
}

/// Robot of simple parts.
#[pyclass(frozen, extends = Layer, module = "reality_sim")]
#[derive(Debug)]
pub struct Humanoid;

#[pymethods]
impl Humanoid {
    #[new]
    #[pyo3(signature = (x_m, y_m, yaw_rad, *, height_m = 0.58, color = [40, 90, 220], gait_rad = None, velocity_m_s = [0.0; 2], name = "robot"))]
    #[expect(clippy::too_many_arguments, reason = "Python's keywords")]
    fn new(
        x_m: f64,
        y_m: f64,
        yaw_rad: f64,
        height_m: f64,
        color: [u8; 3],
        gait_rad: Option<f64>,
        velocity_m_s: [f64; 2],
        name: &str,
    ) -> PyResult<PyClassInitializer<Self>> {
        finite("Humanoid", &[x_m, y_m, yaw_rad, gait_rad.unwrap_or(0.0), velocity_m_s[0], velocity_m_s[1]])?;
        positive("height_m", height_m)?;
        let robot =
            simulator::Humanoid::standing(Pose2::new(x_m, y_m, yaw_rad), height_m, reflectance(color));
        let mut robot = robot.named(name);
        robot.gait_rad = gait_rad;
        robot.velocity_in_world = DVec2::from_array(velocity_m_s);
        Ok(PyClassInitializer::from(Layer(Arc::new(robot))).add_subclass(Self))
    }
}

/// Pinhole pictures on the sides of a cube around the camera.
#[pyclass(frozen, extends = Layer, module = "reality_sim")]
#[derive(Debug)]
pub struct Cube;

/// Face as Python gives it: side, columns of the whole side, first column and row of the window, and the window's sRGB, depths in
/// metres and objects.
type Face<'py> = (
    String,
    u32,
    [u32; 2],
    PyReadonlyArray3<'py, u8>,
    PyReadonlyArray2<'py, f32>,
    PyReadonlyArray2<'py, i32>,
);

#[pymethods]
impl Cube {
    #[new]
    #[pyo3(signature = (pose, faces, objects, occluders = Vec::new()))]
    fn new(
        py: Python<'_>,
        pose: Vec<f64>,
        faces: Vec<Face<'_>>,
        objects: Vec<(String, String)>,
        occluders: Vec<[f64; 4]>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let pose = camera_pose(&pose, reality_sim::CameraPose::default())?;
        let given = faces.iter().map(GivenFace::new).collect::<PyResult<Vec<_>>>()?;
        let faces = py.detach(|| given.iter().map(GivenFace::copied).collect());
        let objects = objects.into_iter().map(|(class, name)| Ok((class_named(&class)?, name)));
        let objects = objects.collect::<PyResult<Vec<_>>>()?;
        let Some(mut layer) = CubeLayer::new(pose, faces, objects) else {
            return Err(PyValueError::new_err(
                "faces: picture, depths and objects of a face differ in size, or reach beyond its side",
            ));
        };
        let sphere =
            |[x, y, z, radius_m]: [f64; 4]| Sphere { center_in_world: DVec3::new(x, y, z), radius_m };
        layer.occluders = occluders.into_iter().map(sphere).collect();
        Ok(PyClassInitializer::from(Layer(Arc::new(layer))).add_subclass(Self))
    }
}

/// Face whose arrays are Python's memory.
struct GivenFace<'a> {
    side: CubeSide,
    size: u32,
    window: PixelBox,
    srgb: ArrayView3<'a, u8>,
    depth_m: ArrayView2<'a, f32>,
    objects: ArrayView2<'a, i32>,
}

impl<'a> GivenFace<'a> {
    fn new((side, size, [left, top], srgb, depth_m, objects): &'a Face<'_>) -> PyResult<Self> {
        let (srgb, depth_m, objects) = (srgb.as_array(), depth_m.as_array(), objects.as_array());
        let (rows, columns) = (srgb.shape()[0] as u32, srgb.shape()[1] as u32);
        let window = PixelBox {
            left: *left,
            top: *top,
            right: left.saturating_add(columns),
            bottom: top.saturating_add(rows),
        };
        Ok(Self { side: side_named(side)?, size: *size, window, srgb, depth_m, objects })
    }

    fn copied(&self) -> CubeFace {
        let of = |number: &i32| u16::try_from(*number).unwrap_or(NO_CUBE_OBJECT);
        let colors: Vec<u8> = self.srgb.iter().copied().collect();
        CubeFace {
            side: self.side,
            size: self.size,
            window: self.window,
            srgb: colors.as_chunks().0.to_vec(),
            depth_m: self.depth_m.iter().copied().collect(),
            object_of: self.objects.iter().map(of).collect(),
        }
    }
}

fn side_named(name: &str) -> PyResult<CubeSide> {
    Ok(match name {
        "forward" => CubeSide::Forward,
        "left" => CubeSide::Left,
        "right" => CubeSide::Right,
        "up" => CubeSide::Up,
        "down" => CubeSide::Down,
        "backward" => CubeSide::Backward,
        _ => {
            let sides = "forward, left, right, up, down or backward";
            return Err(PyValueError::new_err(format!("{name:?} is no side of a cube: give {sides}")));
        }
    })
}

fn class_named(name: &str) -> PyResult<Class> {
    Class::ALL.into_iter().find(|class| class.name() == name).ok_or_else(|| {
        let names: Vec<&str> = Class::ALL.iter().map(|class| class.name()).collect();
        PyValueError::new_err(format!("{name:?} is no class: give one of {}", names.join(", ")))
    })
}

/// Returns the reflectance of what has this colour, sRGB, in white light as bright as full white.
fn reflectance(srgb: [u8; 3]) -> Vec3 {
    Vec3::from_array(srgb.map(linear_from_srgb))
}

fn finite(what: &str, numbers: &[f64]) -> PyResult<()> {
    match numbers.iter().all(|number| number.is_finite()) {
        true => Ok(()),
        false => Err(PyValueError::new_err(format!("{what}: a place, angle or velocity is no number"))),
    }
}

fn positive(name: &str, number: f64) -> PyResult<()> {
    if number.is_finite() && number > 0.0 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name}: is {number}: give a number above 0")))
}
