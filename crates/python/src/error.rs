//! Exceptions.

use pyo3::{PyErr, create_exception, exceptions::PyRuntimeError};
use reality_sim::{SynthesisError, simulator::LookError};

create_exception!(reality_sim, Error, PyRuntimeError, "Something that Reality Sim cannot do.");
create_exception!(
    reality_sim,
    NoPicture,
    Error,
    "No picture at a pose, because too little was recorded near it."
);

/// Makes an exception of any error.
pub fn failed(error: impl std::error::Error) -> PyErr {
    Error::new_err(with_causes(&error))
}

/// Makes an exception of an error of pictures.
pub fn no_picture(error: &SynthesisError) -> PyErr {
    let words = with_causes(error);
    if error.is_refusal() { NoPicture::new_err(words) } else { Error::new_err(words) }
}

/// Makes an exception of an error of a simulator's camera.
pub fn no_look(error: &LookError) -> PyErr {
    let words = with_causes(error);
    if error.is_refusal() { NoPicture::new_err(words) } else { Error::new_err(words) }
}

/// Joins the messages of an error and its causes, each of them once.
pub fn with_causes(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let next = error.to_string();
        if !words.contains(&next) {
            words = format!("{words}: {next}");
        }
        cause = error.source();
    }
    words
}
