//! Settings of a study.

use serde::{Deserialize, Serialize};

use super::{EvaluationSettings, PictureSetSettings};
use crate::{comparison::ComparisonSettings, tagging::TagSettings};

/// What is done with a recording, and how. In JSON `job` tells what, and the other keys have the names of the program's options.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "job", rename_all = "lowercase")]
pub enum StudySettings {
    /// Finds the poses of its pictures.
    Tag(TagSettings),
    /// Compares it with a model of its camera.
    Gap(ComparisonSettings),
    /// Compares pictures made from a database with its own.
    Evaluate(EvaluationSettings),
    /// Makes pictures with labels from it.
    Dataset(PictureSetSettings),
}
