//! Poses of recordings.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::{exceptions::PyValueError, prelude::*};
use reality_sim::{
    Sequence,
    tagging::{TagSettings, Tagged, TaggedPose, covariance_rows, tag as tag_with},
};

use crate::{error::failed, interruptible::interruptible, pose::numbers};

/// Poses of the pictures of a recording.
#[pyclass(frozen, get_all, module = "reality_sim")]
pub struct Tags {
    timestamps_s: Py<PyArray1<f64>>,
    poses: Py<PyArray2<f64>>,
    covariances: Py<PyArray3<f64>>,
    is_sure: Py<PyArray1<bool>>,
    is_settled: Py<PyArray1<bool>>,
    lines_within_5px: f64,
    lines_within_10px: f64,
    completeness: f64,
    verdict: String,
    error: Option<Py<TagErrors>>,
}

/// Errors of poses against the recording's reference poses.
#[pyclass(frozen, get_all, module = "reality_sim")]
pub struct TagErrors {
    frames: usize,
    mean_m: f64,
    median_m: f64,
    p95_m: f64,
    max_m: f64,
    mean_yaw_rad: f64,
    lost_frames: usize,
}

/// Finds the camera pose of every picture of a recording, with settings in JSON.
#[pyfunction]
pub fn tag(py: Python<'_>, recording: PathBuf, settings: &str) -> PyResult<Tags> {
    let settings: TagSettings = serde_json::from_str(settings)
        .map_err(|error| PyValueError::new_err(format!("settings: {error}")))?;
    let (sequence, tagged) = interruptible(py, move || {
        let sequence = Sequence::open(&recording).map_err(failed)?;
        sequence.check_pictures().map_err(failed)?;
        let mut tagged = tag_with(&sequence, &[settings]).map_err(failed)?;
        // One for each of the settings.
        PyResult::Ok((sequence, tagged.remove(0)))
    })??;
    Tags::of(py, &sequence, &tagged)
}

impl Tags {
    fn of(py: Python<'_>, sequence: &Sequence, tagged: &Tagged) -> PyResult<Self> {
        let count = tagged.poses.len();
        let times_s = sequence.frames.iter().map(|frame| frame.timestamp_s).collect();
        let row = |tagged: &TaggedPose| {
            let (x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad) = numbers(tagged.pose);
            [x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad]
        };
        let matrix = |tagged: &TaggedPose| {
            tagged.covariance.as_ref().map_or([[f64::NAN; 6]; 6], covariance_rows).into_iter().flatten()
        };
        let poses: Vec<f64> = tagged.poses.iter().flat_map(row).collect();
        let covariances: Vec<f64> = tagged.poses.iter().flat_map(matrix).collect();
        let flags = |flag: fn(&reality_sim::LocalizedFrame) -> bool| {
            PyArray1::from_vec(py, tagged.frames.iter().map(flag).collect()).unbind()
        };
        let quality = tagged.quality();
        let error = tagged.error.map(|error| TagErrors {
            frames: error.frames,
            mean_m: error.mean_m,
            median_m: error.median_m,
            p95_m: error.p95_m,
            max_m: error.max_m,
            mean_yaw_rad: error.mean_yaw_rad,
            lost_frames: error.lost_frames,
        });
        Ok(Self {
            timestamps_s: PyArray1::from_vec(py, times_s).unbind(),
            poses: PyArray1::from_vec(py, poses).reshape([count, 6])?.unbind(),
            covariances: PyArray1::from_vec(py, covariances).reshape([count, 6, 6])?.unbind(),
            is_sure: flags(|frame| frame.sure),
            is_settled: flags(|frame| frame.settled),
            lines_within_5px: quality.lines_within_5px,
            lines_within_10px: quality.lines_within_10px,
            completeness: quality.completeness,
            verdict: quality.sentence(),
            error: error.map(|error| Py::new(py, error)).transpose()?,
        })
    }
}
