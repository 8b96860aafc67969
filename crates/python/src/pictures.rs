//! Pictures as arrays: rows, columns, channels. Memory is handed over to numpy, never copied.

use numpy::{Element, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

/// Makes an array of rows and columns.
pub fn plane<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    [width, height]: [u32; 2],
) -> PyResult<Bound<'_, PyArray2<T>>> {
    PyArray1::from_vec(py, values).reshape([height as usize, width as usize])
}

/// Makes an array of rows, columns and three channels.
pub fn rgb(py: Python<'_>, bytes: Vec<u8>, [width, height]: [u32; 2]) -> PyResult<Bound<'_, PyArray3<u8>>> {
    PyArray1::from_vec(py, bytes).reshape([height as usize, width as usize, 3])
}
