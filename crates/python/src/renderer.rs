//! The simulator's camera.

use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use reality_sim::{
    glam::DVec2,
    simulator::{self, Camera, Class, PixelBox, labels::Labels},
};

use crate::{
    database::{Database, named},
    error::{failed, no_look},
    layers::Layer,
    lens::Lens,
    pictures::{plane, rgb},
    pose::{Numbers, camera_pose, numbers},
};

/// Camera that a simulator moves over a recorded field.
#[pyclass(module = "reality_sim")]
#[derive(Debug)]
pub struct Renderer {
    camera: Camera,
    frame: simulator::Frame,
}

#[pymethods]
impl Renderer {
    #[new]
    #[pyo3(signature = (database, *, method = "auto", size = None, labels = false, decoding_ahead = true))]
    fn new(
        py: Python<'_>,
        database: &Database,
        method: &str,
        size: Option<[u32; 2]>,
        labels: bool,
        decoding_ahead: bool,
    ) -> PyResult<Self> {
        let method = named(method)?;
        let synthesizer = database.of_size(size)?;
        let camera = py.detach(|| {
            let camera =
                Camera::with(synthesizer, method).with_labels(labels).with_decoding_ahead(decoding_ahead);
            match &database.model {
                Some(model) => camera.with_model(model).map_err(failed),
                None => Ok(camera),
            }
        })?;
        Ok(Self { camera, frame: simulator::Frame::default() })
    }

    /// Returns what the camera sees at a pose: the recorded scene with the layers in it.
    #[pyo3(signature = (pose, layers = Vec::new(), *, time_s = 0.0))]
    fn look(
        &mut self,
        py: Python<'_>,
        pose: Vec<f64>,
        layers: Vec<PyRef<'_, Layer>>,
        time_s: f64,
    ) -> PyResult<Frame> {
        let usual = self.camera.synthesizer().archive().usual_pose();
        let pose = camera_pose(&pose, usual)?;
        let layers: Vec<_> = layers.iter().map(|layer| layer.0.clone()).collect();
        self.camera.set_time_s(time_s);
        let Self { camera, frame } = self;
        py.detach(|| {
            let layers: Vec<&dyn simulator::Layer> = layers.iter().map(AsRef::as_ref).collect();
            camera.look(pose, &layers, frame).map_err(|error| no_look(&error))
        })?;
        Frame::taken(py, frame)
    }

    #[getter]
    fn lens(&self) -> Lens {
        Lens(self.camera.synthesizer().camera().clone())
    }

    /// Forgets the path so far.
    fn forget_path(&mut self) {
        self.camera.forget_path();
    }
}

/// Thing that a picture shows.
#[pyclass(frozen, get_all, module = "reality_sim")]
pub struct SeenObject {
    name: String,
    class_name: &'static str,
    /// Columns and rows, the last ones excluded: left, top, right, bottom.
    visible: Option<(u32, u32, u32, u32)>,
    whole: Option<(u32, u32, u32, u32)>,
    visible_pixels: u32,
    visibility: f64,
    truncation: f32,
}

/// Picture with what is known of its pixels.
#[pyclass(frozen, get_all, module = "reality_sim")]
pub struct Frame {
    pose: Numbers,
    picture: Py<PyArray3<u8>>,
    covered: f64,
    objects: Vec<Py<SeenObject>>,
    object_of: Py<PyArray2<u16>>,
    object_distance_m: Py<PyArray2<f32>>,
    labels: Option<Py<FrameLabels>>,
}

/// Kind, place on the field in metres, pixel if it is in the picture, and whether nothing stands before it.
type SeenCrossing = (&'static str, (f64, f64), Option<(f64, f64)>, bool);

/// Labels of a picture.
#[pyclass(frozen, get_all, module = "reality_sim")]
pub struct FrameLabels {
    classes: Py<PyArray2<u8>>,
    instances: Py<PyArray2<u16>>,
    distance_m: Py<PyArray2<f32>>,
    trust: Py<PyArray2<u8>>,
    /// Kind and points of every white line in view, pixels.
    lines: Vec<(&'static str, Vec<(f64, f64)>)>,
    /// All crossings and marks of the field.
    crossings: Vec<SeenCrossing>,
    things: Vec<Py<SeenObject>>,
}

impl Frame {
    /// Takes the picture and everything as large out of a frame.
    fn taken(py: Python<'_>, frame: &mut simulator::Frame) -> PyResult<Self> {
        let size = [frame.picture.width(), frame.picture.height()];
        let picture = std::mem::take(&mut frame.picture).into_raw();
        let labels = std::mem::take(&mut frame.labels);
        let labels = (!labels.classes.is_empty()).then(|| FrameLabels::taken(py, labels)).transpose()?;
        Ok(Self {
            pose: numbers(frame.pose),
            picture: rgb(py, picture, size)?.unbind(),
            covered: frame.covered,
            objects: seen(py, &frame.objects)?,
            object_of: plane(py, std::mem::take(&mut frame.object_of), size)?.unbind(),
            object_distance_m: plane(py, std::mem::take(&mut frame.distance_m), size)?.unbind(),
            labels: labels.map(|labels| Py::new(py, labels)).transpose()?,
        })
    }
}

impl FrameLabels {
    fn taken(py: Python<'_>, labels: Labels) -> PyResult<Self> {
        let size = [labels.width, labels.height];
        let point = |place: DVec2| (place.x, place.y);
        let lines = labels
            .lines
            .iter()
            .map(|line| (line.kind.name(), line.pixels.iter().map(|pixel| point(*pixel)).collect()));
        let crossings = labels.crossings.iter().map(|seen| {
            let crossing = seen.crossing;
            (crossing.kind.name(), point(crossing.point_in_world), seen.pixel.map(point), seen.is_visible)
        });
        Ok(Self {
            lines: lines.collect(),
            crossings: crossings.collect(),
            things: seen(py, &labels.things)?,
            classes: plane(py, labels.classes.into_iter().map(Class::number).collect(), size)?.unbind(),
            instances: plane(py, labels.instances, size)?.unbind(),
            distance_m: plane(py, labels.distance_m, size)?.unbind(),
            trust: plane(py, labels.trust, size)?.unbind(),
        })
    }
}

fn seen(py: Python<'_>, objects: &[simulator::SeenObject]) -> PyResult<Vec<Py<SeenObject>>> {
    let corners = |area: PixelBox| (area.left, area.top, area.right, area.bottom);
    let object = |object: &simulator::SeenObject| SeenObject {
        name: object.name.clone(),
        class_name: object.class.name(),
        visible: object.visible.map(corners),
        whole: object.whole.map(corners),
        visible_pixels: object.visible_pixels,
        visibility: object.visibility(),
        truncation: object.truncation,
    };
    objects.iter().map(|seen| Py::new(py, object(seen))).collect()
}
