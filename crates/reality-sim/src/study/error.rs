//! Reasons why a recording has no findings.

use std::{any::Any, error::Error, io, iter, sync::Arc};

use reality_sim_core::sequence::SequenceError;
use reality_sim_db::{DbError, DbFault};
use reality_sim_pipeline::PipelineError;
use reality_sim_synthesis::SynthesisError;

use crate::{comparison::ComparisonError, dataset::DatasetError, probing::ProbingError, tagging::TagError};

/// Reason why a recording has no findings with some settings.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(Arc<SequenceError>),
    /// It cannot be tagged.
    #[error(transparent)]
    Tagging(Arc<TagError>),
    /// It cannot be compared with a model.
    #[error(transparent)]
    Comparison(Arc<ComparisonError>),
    /// It cannot be stored, or has no poses.
    #[error(transparent)]
    Building(Arc<PipelineError>),
    /// The database cannot be used.
    #[error(transparent)]
    Database(Arc<DbError>),
    /// No pictures can be made.
    #[error(transparent)]
    Pictures(Arc<SynthesisError>),
    /// Pictures cannot be compared.
    #[error(transparent)]
    Probing(Arc<ProbingError>),
    /// No data set can be made.
    #[error(transparent)]
    PictureSet(Arc<DatasetError>),
    /// There is nothing to compare pictures with.
    #[error("{recording}: {fault}")]
    NoProbes {
        /// Name of the recording.
        recording: String,
        /// What is missing, and the remedy.
        fault: &'static str,
    },
    /// The files that a database is built in cannot be written.
    #[error("no temporary folder can be made ({0}): check the disk")]
    Temporary(Arc<io::Error>),
    /// The library failed where it must not.
    #[error("a defect of the library, which its authors would like to hear of: {words}")]
    Defect {
        /// Message of the panic.
        words: String,
    },
}

impl StudyError {
    /// Returns whether the machine failed, and the same study may succeed on another one, or later: its operating system refused
    /// something, or a database that only this study uses could not be written. That a file does not exist is no such failure.
    pub fn is_of_machine(&self) -> bool {
        let of_system = |cause: &(dyn Error + 'static)| {
            let refused = cause.downcast_ref::<io::Error>().is_some_and(is_refusal);
            refused || cause.downcast_ref::<DbFault>().is_some_and(DbFault::is_of_machine)
        };
        matches!(self, Self::Temporary(_))
            || iter::successors(self.source(), |&cause| cause.source()).any(of_system)
    }

    /// Makes an error of what a panic left.
    pub(super) fn defect(panic: &(dyn Any + Send)) -> Self {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let words = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Self::Defect { words: words.unwrap_or_else(|| "without a message".to_owned()) }
    }
}

/// Returns whether an operating system refused something that another one may do. Names that are too long are so everywhere.
fn is_refusal(error: &io::Error) -> bool {
    let is_same_everywhere = matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::InvalidFilename);
    error.raw_os_error().is_some() && !is_same_everywhere
}

macro_rules! from_shared {
    ($($variant:ident($error:ty)),+ $(,)?) => {
        $(impl From<$error> for StudyError {
            fn from(error: $error) -> Self {
                Self::$variant(Arc::new(error))
            }
        })+
    };
}

from_shared!(
    Recording(SequenceError),
    Tagging(TagError),
    Comparison(ComparisonError),
    Building(PipelineError),
    Database(DbError),
    Pictures(SynthesisError),
    Probing(ProbingError),
    PictureSet(DatasetError),
    Temporary(io::Error),
);
