//! The gap workflow on recordings with hidden effects, made by a ray caster that shares no code with what is fitted.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "../common/mod.rs"]
mod common;
mod controls;
mod earlier;
mod effects;
mod halls;
mod mistakes;
mod program;
mod reference;

use reality_sim::{
    Sequence,
    gap::{Analysis, Options, Recording, ReferenceSource, analyse, report::Report},
    sensor::Model,
};
use reality_sim_hidden::{Hidden, Recipe};
use tempfile::TempDir;

/// Records a small sequence with these effects.
fn record(seed: u64, effects: &[Hidden]) -> (TempDir, Sequence) {
    recorded(&Recipe { effects: effects.to_vec(), ..small(seed) })
}

/// Returns a recipe of 32 small pictures: with 24, six of these tests miss what is hidden.
fn small(seed: u64) -> Recipe {
    Recipe { frames: 32, size: [320, 240], ..Recipe::new(seed) }
}

fn recorded(recipe: &Recipe) -> (TempDir, Sequence) {
    let folder = tempfile::tempdir().unwrap();
    let sequence = recipe.record(folder.path()).unwrap();
    (folder, sequence)
}

fn analysed(sequence: &Sequence, model: &Model, options: &Options) -> Analysis {
    analyse(&recording_of(sequence), model, options, &|_| ()).unwrap()
}

fn recording_of(sequence: &Sequence) -> Recording<'_> {
    Recording::new(sequence, &sequence.reference_poses().collect::<Vec<_>>(), ReferenceSource::Measured, None)
        .unwrap()
}

fn reported(sequence: &Sequence) -> Report {
    analysed(sequence, &Model::default(), &Options::default()).report
}

fn named(report: &Report) -> Vec<&str> {
    report.effects.iter().map(|effect| effect.id.as_str()).collect()
}

/// Asserts that the estimate of a parameter is within four of its standard deviations of the truth.
fn assert_size(report: &Report, id: &str, parameter: &str, truth: f64) {
    // The hidden defocus is a disc; the library's Gaussian with the same edges is a tenth wider.
    let form = if id == "defocus" { 0.15 * truth } else { 0.0 };
    let effect = report.effects.iter().find(|effect| effect.id == id).unwrap();
    let estimate = &effect.parameters[parameter];
    let off = ((estimate.value - truth).abs() - form) / estimate.sigma;
    assert!(off < 4.0, "{id}: {} ± {} for {truth}", estimate.value, estimate.sigma);
}
