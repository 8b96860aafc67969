//! Database of one recording alone, for as long as it is needed.

use std::sync::Arc;

use reality_sim_core::{
    localization::LocalizerConfig, observation::ObservationKind, pose::CameraPose, sequence::Sequence,
};
use reality_sim_pipeline::{Event, FilterPlan, HoldBack, Plan, PoseChoice};
use reality_sim_synthesis::Archive;

use super::StudyError;

/// Bytes of decoded pictures that are kept.
pub(super) const CACHE_BYTES: usize = 512 << 20;

/// Name of the database's file, by which data sets and messages call it: that of its folder is another one each time.
pub(super) const FILE: &str = "recording.db";

/// How a recording becomes a database.
#[derive(Debug, Clone, Copy)]
pub(super) struct Building {
    /// Whether the filter finds the poses even if the recording has reference poses.
    pub tag: bool,
    /// Seed of the filter.
    pub seed: u64,
    /// Whether what stood there is found.
    pub clean: bool,
    /// Pictures that are left out.
    pub hold_back: Option<HoldBack>,
}

/// Database of a recording.
pub(super) struct Built {
    pub archive: Arc<Archive>,
    /// Pictures that were left out, with their poses.
    pub held_back: Vec<(usize, CameraPose)>,
    /// Holds the file until the archive is no longer needed.
    _folder: tempfile::TempDir,
}

impl Built {
    /// Stores a recording in a file that is removed with the value.
    pub(super) fn new(sequence: &Sequence, building: Building) -> Result<Self, StudyError> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join(FILE);
        let choice = if building.tag { PoseChoice::Filter } else { PoseChoice::ReferenceElseFilter };
        let config = LocalizerConfig::new(ObservationKind::Contrast).with_seed(building.seed);
        let mut plan = Plan::new([Arc::new(sequence.clone())], choice)
            .with_filter(FilterPlan::default().with_config(config))
            .with_database(&file)
            .with_clean_stage(building.clean);
        if let Some(hold_back) = building.hold_back {
            plan = plan.with_hold_back(hold_back);
        }
        let mut held_back = Vec::new();
        for event in plan.start() {
            if let Event::PosesFound { poses, .. } = event? {
                held_back = poses.held_back;
            }
        }
        let archive = Arc::new(Archive::open(&file, CACHE_BYTES)?);
        Ok(Self { archive, held_back, _folder: folder })
    }
}
