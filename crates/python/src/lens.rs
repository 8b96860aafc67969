//! Lenses.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ndarray::Array2};
use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::{
    Camera,
    glam::{DVec2, DVec3},
};

/// Lens and size of a camera's pictures.
#[pyclass(frozen, module = "reality_sim")]
#[derive(Debug)]
pub struct Lens(pub Camera);

#[pymethods]
impl Lens {
    #[getter]
    fn model(&self) -> &'static str {
        self.0.distortion.colmap_name()
    }

    #[getter]
    fn width(&self) -> u32 {
        self.0.width
    }

    #[getter]
    fn height(&self) -> u32 {
        self.0.height
    }

    #[getter]
    fn focal_lengths(&self) -> (f64, f64) {
        (self.0.fx, self.0.fy)
    }

    #[getter]
    fn principal_point(&self) -> (f64, f64) {
        (self.0.cx, self.0.cy)
    }

    #[getter]
    fn distortion(&self) -> Vec<f64> {
        self.0.distortion.parameters()
    }

    /// Returns the largest angle from the optical axis that a corner of the picture shows, radians.
    #[getter]
    fn widest_angle_rad(&self) -> f64 {
        let Camera { width, height, .. } = self.0;
        let (right, bottom) = (f64::from(width) - 0.5, f64::from(height) - 0.5);
        let corners = [(-0.5, -0.5), (right, -0.5), (-0.5, bottom), (right, bottom)];
        let angle = |(u, v)| {
            self.0
                .unproject(DVec2::new(u, v))
                .map_or(self.0.max_angle_rad(), |ray| ray.angle_between(DVec3::Z))
        };
        corners.into_iter().map(angle).fold(0.0, f64::max)
    }

    /// Projects points in the camera's axes to pixels; NaN where the lens does not see them.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points_in_camera: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = points_in_camera.as_array();
        if points.ncols() != 3 {
            return Err(PyValueError::new_err(format!(
                "points: have {} columns: give x, y, z",
                points.ncols()
            )));
        }
        let mut pixels = Array2::from_elem((points.nrows(), 2), f64::NAN);
        py.detach(|| {
            for (point, mut pixel) in points.rows().into_iter().zip(pixels.rows_mut()) {
                if let Ok(seen) = self.0.project_unbounded(DVec3::new(point[0], point[1], point[2])) {
                    (pixel[0], pixel[1]) = (seen.x, seen.y);
                }
            }
        });
        Ok(PyArray2::from_owned_array(py, pixels))
    }

    /// Returns the unit directions in the camera's axes that are seen at pixels; NaN where the lens sees nothing.
    fn unproject<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pixels = pixels.as_array();
        if pixels.ncols() != 2 {
            return Err(PyValueError::new_err(format!("pixels: have {} columns: give u, v", pixels.ncols())));
        }
        let ray = |pixel: DVec2| self.0.unproject(pixel).unwrap_or(DVec3::NAN).to_array();
        let rays: Vec<f64> = py.detach(|| {
            pixels.rows().into_iter().flat_map(|pixel| ray(DVec2::new(pixel[0], pixel[1]))).collect()
        });
        PyArray1::from_vec(py, rays).reshape([pixels.nrows(), 3])
    }

    fn __repr__(&self) -> String {
        let Camera { width, height, fx, fy, cx, cy, .. } = &self.0;
        format!(
            "Lens({}, {width} x {height}, fx={fx}, fy={fy}, cx={cx}, cy={cy}, {:?})",
            self.model(),
            self.distortion()
        )
    }
}
