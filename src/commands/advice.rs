//! Options and commands that remedy errors of the library, which knows nothing of a command line.

use std::error::Error;

#[cfg(feature = "gpu")]
use reality_sim::gpu::GpuError;
use reality_sim::{
    LocalizationError, SynthesisError,
    backend::BackendError,
    dataset::DatasetError,
    db::{DbError, DbFault, index::NoNeighbours},
    gap::RecordingError,
    pipeline::PipelineError,
    sequence::{Fault, SequenceError},
};
#[cfg(feature = "viewer")]
use reality_sim_viewer::ViewerError;

/// Error of the library that options or commands of the program may remedy.
trait Remedied: Error + Sized + 'static {
    /// Returns what to type, in a few words; `None` if the message says everything.
    fn remedy(&self) -> Option<&'static str>;

    /// Returns the remedy of any error, if it is one of this type.
    fn remedy_of(error: &(dyn Error + 'static)) -> Option<&'static str> {
        error.downcast_ref::<Self>()?.remedy()
    }
}

/// The errors that have remedies. Those that another one wraps transparently are asked by the wrapping one.
const REMEDIES: &[fn(&(dyn Error + 'static)) -> Option<&'static str>] = &[
    PipelineError::remedy_of,
    SequenceError::remedy_of,
    SynthesisError::remedy_of,
    LocalizationError::remedy_of,
    RecordingError::remedy_of,
    DbError::remedy_of,
    DatasetError::remedy_of,
    BackendError::remedy_of,
    #[cfg(feature = "gpu")]
    GpuError::remedy_of,
    #[cfg(feature = "viewer")]
    ViewerError::remedy_of,
];

/// Returns what to type to remedy an error, in a few words; `None` if its message says everything.
pub fn advice(error: &anyhow::Error) -> Option<&'static str> {
    error.chain().find_map(|cause| REMEDIES.iter().find_map(|remedy_of| remedy_of(cause)))
}

impl Remedied for PipelineError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Device(error) => error.remedy(),
            Self::Localization(error) => error.remedy(),
            Self::Database(error) => error.remedy(),
            Self::Hall(error) => error.remedy(),
            _ => None,
        }
    }
}

impl Remedied for SequenceError {
    fn remedy(&self) -> Option<&'static str> {
        let is_of_camera = self.path.file_name().is_some_and(|name| name == "camera.toml");
        let lacks = match &self.fault {
            Fault::Missing => true,
            Fault::MissingKey { key } => key == "mount",
            _ => false,
        };
        (is_of_camera && lacks).then_some(
            "reality-sim calibrate SEQUENCE --out SEQUENCE/camera.toml finds the camera in the pictures",
        )
    }
}

impl Remedied for SynthesisError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Database(error) => error.remedy(),
            Self::Backend(error) => error.remedy(),
            Self::Empty { .. } | Self::NoCleanStage { .. } => {
                Some("`reality-sim build RECORDING --out DATABASE`")
            }
            Self::NoNeighbours { reason: NoNeighbours::OutOfReach { .. }, .. }
            | Self::TooLittleSeen { .. } => Some("`--best-effort`"),
            Self::OtherSize { .. } | Self::TooFewPoints { .. } => {
                Some("`--method plane` or `--method blend`")
            }
            _ => None,
        }
    }
}

impl Remedied for LocalizationError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Backend(error) => error.remedy(),
            _ => None,
        }
    }
}

impl Remedied for RecordingError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::TooFewFrames { .. } => Some("`--frames`, `--poses`"),
            _ => None,
        }
    }
}

impl Remedied for DbError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Database { fault: DbFault::Missing, .. } => {
                Some("`reality-sim build RECORDING --out DATABASE`")
            }
            Self::Database { fault: DbFault::NoSuchSequence { .. }, .. } => {
                Some("`reality-sim info` lists those that it holds")
            }
            Self::Database { fault: DbFault::Older { .. }, .. } => {
                Some("`reality-sim build`, with one of its recordings, opens it for writing")
            }
            _ => None,
        }
    }
}

impl Remedied for DatasetError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::MorePictures { .. } => Some("`--count`"),
            Self::NothingNear { .. } => Some("`--within`"),
            Self::TooLittleSeen { .. } => Some("`--best-effort`"),
            _ => None,
        }
    }
}

impl Remedied for BackendError {
    #[cfg(feature = "gpu")]
    fn remedy(&self) -> Option<&'static str> {
        GpuError::remedy_of(self.get_ref())
    }

    #[cfg(not(feature = "gpu"))]
    fn remedy(&self) -> Option<&'static str> {
        None
    }
}

#[cfg(feature = "gpu")]
impl Remedied for GpuError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::NoSuchAdapter { .. } => Some("`reality-sim doctor` lists them"),
            _ => Some("`--backend cpu`"),
        }
    }
}

#[cfg(feature = "viewer")]
impl Remedied for ViewerError {
    fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::NoGraphics(_) => Some("`reality-sim doctor` lists those that are there"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;

    fn empty() -> SynthesisError {
        SynthesisError::Empty { database: "walk.db".to_owned() }
    }

    #[test]
    fn a_remedy_is_found_behind_context() {
        let error = Err::<(), _>(empty()).context("walk.db").expect_err("it is one");
        assert!(advice(&error).is_some_and(|words| words.contains("--out")));
    }

    #[test]
    fn a_remedy_is_found_in_a_transparent_error() {
        let error = PipelineError::Hall(empty());
        assert_eq!(advice(&error.into()), empty().remedy());
    }

    #[test]
    fn other_errors_have_no_remedy() {
        assert_eq!(advice(&anyhow::anyhow!("something else")), None);
    }
}
