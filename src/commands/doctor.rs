//! `reality-sim doctor`: lists the graphics adapters and checks whether they compute what the CPU computes.

use std::{fmt::Write, sync::Arc, time::Instant};

use anyhow::bail;
use clap::Args;
use serde::Serialize;

use reality_sim::{
    backend::BackendError,
    gpu::{
        AdapterSummary, GpuContext, GpuError, SCORE_TOLERANCE, ScoreComparison, adapters, compare_filters,
        compare_scores, compare_warps,
    },
};

use super::output::{print, print_json};

/// Number of scenes on which every model and every lens is compared.
const SCENES: u64 = 4;

/// Number of pictures drawn for the comparison: one for each number of sources, zero included.
const PICTURES: u64 = 9;

/// Options of `doctor`.
#[derive(Debug, Args)]
pub struct DoctorArgs {
    /// Only the adapters whose name contains NAME
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    adapters: Vec<AdapterReport>,
    /// Remedy if there is no graphics card.
    #[serde(skip_serializing_if = "Option::is_none")]
    advice: Option<String>,
}

#[derive(Serialize)]
struct AdapterReport {
    #[serde(flatten)]
    summary: AdapterSummary,
    /// Time to open the device, without listing the adapters, seconds.
    start_seconds: f64,
    /// Largest relative difference of a pose's score from the CPU's.
    #[serde(skip_serializing_if = "Option::is_none")]
    worst_difference: Option<f64>,
    /// Number of the filter's updates with the same best particle as on the CPU, and of all updates.
    #[serde(skip_serializing_if = "Option::is_none")]
    same_best_particle: Option<[usize; 2]>,
    /// Number of pixels drawn from other pictures that agree with the CPU's to one grey level, and of all pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    same_pixels: Option<[usize; 2]>,
    agrees: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// Runs the command.
pub fn run(args: &DoctorArgs) -> anyhow::Result<()> {
    let wanted = args.adapter.as_deref().unwrap_or_default().to_lowercase();
    let found = adapters();
    let chosen = found.iter().filter(|adapter| adapter.name.to_lowercase().contains(&wanted));
    let reports: Vec<AdapterReport> = chosen.map(examine).collect();
    if reports.is_empty() && !found.is_empty() {
        let names: Vec<String> = found.into_iter().map(|adapter| adapter.name).collect();
        let wanted = args.adapter.clone().unwrap_or_default();
        return Err(GpuError::NoSuchAdapter { wanted, found: names.join(", ") }.into());
    }
    let advice = match reports.iter().any(|report| !report.summary.is_processor) {
        true => None,
        false if reports.is_empty() => Some(GpuError::NoAdapter.to_string()),
        false => Some(
            "there is no graphics card, only a driver that runs on the processor: install your card's Vulkan driver (on \
             Debian and Ubuntu mesa-vulkan-drivers for AMD and Intel, nvidia-driver for NVIDIA), or use the CPU"
                .to_owned(),
        ),
    };
    let report = Report { adapters: reports, advice };
    if args.json {
        print_json(&report)?;
    } else {
        print(&text(&report))?;
    }
    match report.adapters.iter().find(|adapter| !adapter.agrees) {
        Some(adapter) => bail!(
            "{}: computes something else than the CPU: update its driver, or use --backend cpu",
            adapter.summary.name
        ),
        None => Ok(()),
    }
}

fn examine(summary: &AdapterSummary) -> AdapterReport {
    let begin = Instant::now();
    let context = GpuContext::new(Some(&summary.name));
    let start_seconds = begin.elapsed().as_secs_f64();
    let comparisons = context.map_err(BackendError::from).and_then(|context| {
        let context = Arc::new(context);
        let scores = compare_scores(&context, SCENES)?;
        let filters = compare_filters(&context, SCENES)?;
        let warps = compare_warps(&context, PICTURES)?;
        Ok((scores, filters, warps))
    });
    let report = AdapterReport {
        summary: summary.clone(),
        start_seconds,
        worst_difference: None,
        same_best_particle: None,
        same_pixels: None,
        agrees: false,
        error: None,
    };
    match comparisons {
        Ok((scores, filters, warps)) => AdapterReport {
            worst_difference: Some(scores.iter().map(|comparison| comparison.worst).fold(0.0, f64::max)),
            same_best_particle: Some([filters.same_best, filters.updates]),
            same_pixels: Some([warps.pixels - warps.other_color, warps.pixels]),
            agrees: scores.iter().all(ScoreComparison::agrees) && filters.agrees() && warps.agrees(),
            ..report
        },
        Err(error) => AdapterReport { error: Some(error.to_string()), ..report },
    }
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    for adapter in &report.adapters {
        let AdapterSummary { name, backend, kind, driver, .. } = &adapter.summary;
        let mebibytes = |bytes: u64| bytes >> 20;
        let compared = adapter.same_best_particle.zip(adapter.same_pixels);
        let verdict = match (&adapter.error, adapter.worst_difference, compared) {
            (None, Some(worst), Some(([same, updates], [same_pixels, pixels]))) => format!(
                "{} the CPU: scores differ by {worst:.0e} at most, {SCORE_TOLERANCE:.0e} allowed; the best particle is the \
                 same in {same} of {updates} updates; {same_pixels} of {pixels} pixels drawn are the same to a grey level",
                if adapter.agrees { "compute as" } else { "DO NOT compute as" }
            ),
            (error, ..) => format!("failed: {}", error.as_deref().unwrap_or("not compared")),
        };
        // Writing into a string cannot fail.
        let _ = write!(
            text,
            "{name}\n  kind      {kind}, {backend}\n  driver    {driver}\n  limits    buffers of {} MiB, {} of them bound as \
             storage; {} workgroups along one dimension\n  start     {:.0} ms\n  kernels   {verdict}\n",
            mebibytes(adapter.summary.max_buffer_bytes),
            mebibytes(adapter.summary.max_storage_buffer_bytes),
            adapter.summary.max_workgroups,
            1e3 * adapter.start_seconds,
        );
    }
    if let Some(advice) = &report.advice {
        let _ = writeln!(text, "{advice}");
    }
    text
}
