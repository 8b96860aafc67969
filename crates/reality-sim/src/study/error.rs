//! Reasons why a recording has no findings.

use std::{any::Any, sync::Arc};

use reality_sim_core::sequence::SequenceError;
use reality_sim_db::DbError;
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
    Temporary(Arc<std::io::Error>),
    /// The library failed where it must not.
    #[error("a defect of the library, which its authors would like to hear of: {words}")]
    Defect {
        /// Message of the panic.
        words: String,
    },
}

impl StudyError {
    /// Returns whether the machine failed, and the same study may succeed on another one.
    pub fn is_of_machine(&self) -> bool {
        match self {
            Self::Temporary(_) => true,
            Self::PictureSet(error) => error.is_of_disk(),
            _ => false,
        }
    }

    /// Makes an error of what a panic left.
    pub(super) fn defect(panic: &(dyn Any + Send)) -> Self {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let words = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Self::Defect { words: words.unwrap_or_else(|| "without a message".to_owned()) }
    }
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
    Temporary(std::io::Error),
);
