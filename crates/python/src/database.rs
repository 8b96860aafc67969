//! Databases of pictures.

use std::{path::PathBuf, str::FromStr, sync::Arc};

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::{
    Archive, CameraPose, Synthesizer,
    sensor::Model,
    synthesis::{MethodKind, SynthesisConfig},
    warp::CpuWarper,
};

use crate::{
    error::{failed, no_picture},
    lens::Lens,
    pictures::rgb,
    pose::{Numbers, camera_pose, numbers},
};

/// Pictures by pose, in one file.
#[pyclass(frozen, module = "reality_sim")]
#[derive(Debug)]
pub struct Database {
    pub path: PathBuf,
    /// Effects of the sensor beside those of the database's camera.
    pub model: Option<Model>,
    pub archive: Arc<Archive>,
    pub synthesizer: Arc<Synthesizer>,
}

#[pymethods]
impl Database {
    #[new]
    #[pyo3(signature = (path, cache_bytes = 1 << 30, *, clean = false, best_effort = false, neighbours = 6, model = None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        cache_bytes: usize,
        clean: bool,
        best_effort: bool,
        neighbours: usize,
        model: Option<PathBuf>,
    ) -> PyResult<Self> {
        let limit = reality_sim::warp::MAX_SOURCES;
        if !(1..=limit).contains(&neighbours) {
            return Err(PyValueError::new_err(format!("neighbours: is {neighbours}: give 1 to {limit}")));
        }
        py.detach(|| {
            let archive = Archive::open(&path, cache_bytes).map_err(|error| no_picture(&error))?;
            if clean && !archive.has_clean_stage() {
                let database = path.display().to_string();
                return Err(no_picture(&reality_sim::SynthesisError::NoCleanStage { database }));
            }
            let (archive, model) = match model {
                Some(file) => {
                    let model = Model::read(&file).map_err(failed)?;
                    let archive = archive.with_model(&model).map_err(|error| failed(error.in_file(&file)))?;
                    (archive, Some(model))
                }
                None => (archive, None),
            };
            let mut config = SynthesisConfig::new(&archive).with_sources(neighbours);
            if best_effort {
                config = config.best_effort();
            }
            let lens = archive.setup().camera.clone();
            let archive = Arc::new(archive);
            let synthesizer =
                Synthesizer::with(archive.clone(), lens, Arc::new(CpuWarper), config).with_clean(clean);
            Ok(Self { path, model, archive, synthesizer: Arc::new(synthesizer) })
        })
    }

    /// Returns the picture at a pose.
    #[pyo3(signature = (pose, method = "auto", *, out = None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        pose: Vec<f64>,
        method: &str,
        out: Option<Bound<'py, PyArray3<u8>>>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let pose = camera_pose(&pose, self.archive.usual_pose())?;
        let method = named::<MethodKind>(method)?;
        let [width, height] = self.size();
        let draw = |pixels: &mut [u8]| {
            self.synthesizer.image_into(pose, &method, pixels).map_err(|error| no_picture(&error)).map(|_| ())
        };
        let Some(out) = out else {
            let mut pixels = vec![0; 3 * width as usize * height as usize];
            py.detach(|| draw(&mut pixels))?;
            return rgb(py, pixels, [width, height]);
        };
        let shape = [height as usize, width as usize, 3];
        if out.shape() != shape {
            return Err(PyValueError::new_err(format!(
                "out: has the shape {:?}: give one of {shape:?}",
                out.shape()
            )));
        }
        if !out.is_c_contiguous() {
            let reason = "out: its memory has gaps or another order: give a C-contiguous array";
            return Err(PyValueError::new_err(reason));
        }
        {
            let mut pixels =
                out.try_readwrite().map_err(|_| PyValueError::new_err("out: is in use, or read-only"))?;
            let pixels = pixels.as_slice_mut()?;
            py.detach(|| draw(pixels))?;
        }
        Ok(out)
    }

    /// Returns the poses of all pictures: a row of x, y, yaw, height, pitch and roll for each.
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let row = |CameraPose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad }: CameraPose| {
            [x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad]
        };
        let rows: Vec<f64> = self.archive.images().iter().flat_map(|image| row(image.pose)).collect();
        PyArray1::from_vec(py, rows).reshape([self.archive.images().len(), 6])
    }

    #[getter]
    fn usual_pose(&self) -> Numbers {
        numbers(self.archive.usual_pose())
    }

    #[getter]
    fn lens(&self) -> Lens {
        Lens(self.synthesizer.camera().clone())
    }

    #[getter]
    fn field_size(&self) -> (f64, f64) {
        let field = self.archive.field();
        (field.length_m, field.width_m)
    }

    #[getter]
    fn cached_bytes(&self) -> usize {
        self.archive.cached_bytes()
    }

    #[getter]
    fn path(&self) -> &PathBuf {
        &self.path
    }

    fn __len__(&self) -> usize {
        self.archive.images().len()
    }

    fn __repr__(&self) -> String {
        format!("Database({:?}, {} pictures)", self.path, self.archive.images().len())
    }
}

impl Database {
    /// Returns the source of pictures of a size, width and height in pixels: the same lens with more or fewer pixels.
    pub fn of_size(&self, size: Option<[u32; 2]>) -> PyResult<Arc<Synthesizer>> {
        let own = self.size();
        let Some([width, height]) = size.filter(|size| *size != own) else {
            return Ok(self.synthesizer.clone());
        };
        // Rounded to whole pixels.
        let [across, down] = [width, height].map(f64::from);
        let wanted_height = across * f64::from(own[1]) / f64::from(own[0]);
        if (down - wanted_height).abs() > 1.0 {
            return Err(PyValueError::new_err(format!(
                "size: {width} x {height} has other proportions than the camera's pictures, {} x {}: give a height of {wanted_height:.0}",
                own[0], own[1]
            )));
        }
        let lens = self.synthesizer.camera().resized([width, height]).map_err(failed)?;
        let (config, clean) = (*self.synthesizer.config(), self.synthesizer.is_clean());
        let resized =
            Synthesizer::with(self.archive.clone(), lens, Arc::new(CpuWarper), config).with_clean(clean);
        Ok(Arc::new(resized))
    }

    /// Returns width and height of its pictures, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.synthesizer.camera().width, self.synthesizer.camera().height]
    }
}

/// Finds something by its name.
pub fn named<T: FromStr<Err: std::fmt::Display>>(name: &str) -> PyResult<T> {
    name.parse().map_err(|error: T::Err| PyValueError::new_err(error.to_string()))
}
