//! Workflows that are examined.

use std::error::Error;

use clap::ValueEnum;
use reality_sim::{
    Sequence,
    gap::{
        Options, Recording, RecordingError, ReferenceSource, Simplification, analyse, gap_of,
        report::{Report, Verdict},
    },
    sensor::Model,
};
use serde::{Deserialize, Serialize};

/// Workflow that is examined: that of `gap`, or a simpler one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Workflow {
    /// As it is
    Gap,
    /// All parameters free, dropped by the Bayesian information criterion
    InformationCriterion,
    /// Effects are added as long as cross-validation prefers it
    CrossValidation,
    /// Reference poses are taken to be exact
    ExactPoses,
    /// Carpet and paint have one reflectance each
    EvenSurfaces,
    /// The largest gain is named, whatever else explains as much
    LargestGain,
}

impl Workflow {
    /// Returns what the tables call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gap => "the workflow",
            Self::InformationCriterion => "all parameters free, dropped by BIC",
            Self::CrossValidation => "cross-validation and a look",
            Self::ExactPoses => "without the poses' errors",
            Self::EvenSurfaces => "without fields of reflectance",
            Self::LargestGain => "without ties",
        }
    }

    fn simplification(self) -> Option<Simplification> {
        match self {
            Self::Gap => None,
            Self::InformationCriterion => Some(Simplification::InformationCriterion),
            Self::CrossValidation => Some(Simplification::CrossValidation),
            Self::ExactPoses => Some(Simplification::ExactPoses),
            Self::EvenSurfaces => Some(Simplification::EvenSurfaces),
            Self::LargestGain => Some(Simplification::LargestGain),
        }
    }

    /// Runs the workflow on a recording with its reference poses.
    pub fn examine(self, sequence: &Sequence, options: &Options) -> Result<Report, Box<dyn Error>> {
        let recording = open(sequence)?;
        let recording = match self.simplification() {
            Some(simplification) => recording.simplified(simplification),
            None => recording,
        };
        let mut report = analyse(&recording, &Model::default(), options, &|_| ())?.report;
        if self == Self::InformationCriterion {
            // Whoever drops terms by a criterion looks at no residuals.
            report.unexplained.clear();
            report.verdict = if report.effects.is_empty() { Verdict::None } else { Verdict::Named };
        }
        Ok(report)
    }
}

/// Returns the gap that a model leaves.
pub fn gap_left(sequence: &Sequence, model: &Model, options: &Options) -> Result<f64, Box<dyn Error>> {
    Ok(gap_of(&open(sequence)?, model, options)?.before)
}

fn open(sequence: &Sequence) -> Result<Recording<'_>, RecordingError> {
    let poses: Vec<_> = sequence.reference_poses().collect();
    Recording::new(sequence, &poses, ReferenceSource::Measured, None)
}
