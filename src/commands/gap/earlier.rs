//! `gap --reference`: an earlier recording, against which a later one is compared.

use reality_sim::{
    Sequence,
    gap::{
        Options, Recording, analyse,
        report::{Report, text::summary},
        shown_photometry,
    },
    sensor::Model,
    sequence::Photometry,
};
use serde::Serialize;

use super::{GapArgs, poses};

/// What an earlier recording shows of its camera.
pub struct Earlier {
    /// Effects that it shows.
    pub model: Model,
    /// Brightness and blur that it shows beside them.
    pub photometry: Photometry,
    pub told: Told,
}

/// What the report says of the earlier recording.
#[derive(Debug, Serialize)]
pub struct Told {
    recording: String,
    effects: Vec<String>,
    summary: String,
}

impl Earlier {
    /// Analyses the earlier recording, whose poses are found in the same way as the later one's.
    pub fn new(args: &GapArgs, sequence: &Sequence, options: &Options) -> anyhow::Result<Self> {
        let poses = poses::reference(args, sequence)?;
        let recording = Recording::new(sequence, &poses.poses, poses.source, None)?;
        let analysis = analyse(&recording, &Model::default(), options, &|_| ())?;
        let photometry = shown_photometry(&recording, &analysis.model)?;
        let told = Told {
            recording: sequence.name.clone(),
            effects: analysis.report.effects.iter().map(|effect| effect.id.clone()).collect(),
            summary: summary(&analysis.report),
        };
        Ok(Self { model: analysis.model, photometry, told })
    }
}

/// Report on what has changed since an earlier recording.
#[derive(Serialize)]
pub struct SinceReport<'a> {
    #[serde(flatten)]
    pub report: &'a Report,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<&'a Told>,
}

impl Told {
    /// Returns what the report's findings are compared with, as a sentence.
    pub fn sentence(&self) -> String {
        let Self { recording, effects, summary } = self;
        let known = if effects.is_empty() {
            String::new()
        } else {
            format!(" Its effects are in the model: {}.", effects.join(", "))
        };
        format!("What follows has changed since {recording}, of which this was found: {summary}{known}")
    }
}
