//! Report of a recording whose files hold a mistake, or whose pictures do not show the field: nothing is compared.

use std::collections::BTreeMap;

use reality_sim_sensor::Model;

use crate::{
    diagnostics::finding::Finding,
    recording::Recording,
    report::{
        analysis::Analysis,
        data::{Gap, PosesReport, Report, Verdict},
    },
};

/// Returns the analysis that says what is wrong with the files, with the model as it was given.
pub(super) fn stopped(recording: &Recording<'_>, model: &Model, seed: u64, fault: Finding) -> Analysis {
    let poses =
        PosesReport { source: recording.source, rotation_sigma_rad: [0.0; 3], position_sigma_m: [0.0; 3] };
    let report = Report {
        recording: recording.sequence.name.clone(),
        frames: recording.frames.len(),
        held_out_frames: 0,
        left_out: recording.left_out.iter().map(|path| path.display().to_string()).collect(),
        verdict: Verdict::Unknown,
        effects: Vec::new(),
        in_model: Vec::new(),
        unexplained: vec![fault],
        objects: Vec::new(),
        gap: Gap { before: 0.0, after: 0.0, floor: 0.0, channels: BTreeMap::new() },
        not_found: Vec::new(),
        unobservable: Vec::new(),
        poses,
        maps: BTreeMap::new(),
        shown_frame: recording.frames.as_slice().first().map_or(0, |frame| frame.index_in_sequence),
        seed,
        field: recording.sequence.field.clone(),
    };
    Analysis { report, model: model.clone() }
}
