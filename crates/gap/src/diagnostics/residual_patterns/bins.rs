//! Residuals in bins, and what bins of some frames foretell of others.

use std::collections::BTreeMap;

use glam::{DMat2, DVec2};

use super::{
    locus::{Cell, Locus},
    source::Source,
};
use reality_sim_core::statistics::median;

use crate::{
    diagnostics::detector::FrameResiduals,
    inference::gain::{Gain, sum_of},
    inference::hypothesis_test::two_sided,
    inference::split::stretch,
    measurement::quantity::{Channel, Quantity},
    thresholds::{PatternThresholds, Thresholds},
};

const THRESHOLDS: PatternThresholds = Thresholds::DEFAULT.diagnostics.patterns;

/// Sums of a bin: information and score of a mean vector. Offsets of lines have two numbers a bin, all else has one.
#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    information: DMat2,
    score: DVec2,
    rows: f64,
}

impl Bin {
    /// By their median: a thing that stands on a part of the carpet does not move it.
    fn of_blocks(values: &mut [f64]) -> Self {
        let rows = values.len() as f64;
        let information = DMat2::from_diagonal(DVec2::new(rows, 0.0));
        Self { information, score: DVec2::new(rows * median(values.iter().copied()), 0.0), rows }
    }

    fn mean(&self, shrink: f64) -> DVec2 {
        (self.information + DMat2::from_diagonal(DVec2::splat(shrink))).inverse() * self.score
    }
}

impl std::ops::AddAssign for Bin {
    fn add_assign(&mut self, other: Self) {
        self.information += other.information;
        self.score += other.score;
        self.rows += other.rows;
    }
}

/// Residuals of a source in bins, frame by frame.
pub(super) struct Binned {
    pub(super) source: Source,
    pub(super) locus: Locus,
    frames: Vec<BTreeMap<Cell, Bin>>,
    /// All frames together.
    all: BTreeMap<Cell, Bin>,
}

impl Binned {
    pub(super) fn new(
        frames: &[FrameResiduals<'_>],
        sigmas: &BTreeMap<Quantity, f64>,
        (source, locus): (Source, Locus),
        start_s: f64,
    ) -> Self {
        let frames: Vec<BTreeMap<Cell, Bin>> =
            frames.iter().map(|frame| bins(frame, sigmas, (source, locus), start_s)).collect();
        let all = together(frames.iter());
        Self { source, locus, frames, all }
    }

    /// Returns the number of cells that are seen often enough to be tested.
    pub(super) fn tested(&self) -> usize {
        let seen = |cell: &&Cell| self.frames.iter().filter(|frame| frame.contains_key(cell)).count();
        self.all.keys().filter(|cell| seen(cell) >= THRESHOLDS.least_frames).count()
    }

    /// Returns the cells that are seen often enough, each with how unlikely its mean is chance.
    pub(super) fn p_values(&self) -> impl Iterator<Item = (Cell, f64)> {
        self.all.keys().filter_map(|cell| Some((*cell, p_value(&self.frames, *cell)?)))
    }

    /// Returns the size of a cell's mean, in standard deviations.
    pub(super) fn mean(&self, cell: Cell) -> f64 {
        self.all[&cell].mean(THRESHOLDS.prior_measurements).length()
    }

    /// Returns what frames gain by the means of others.
    pub(super) fn held_out_gain(&self) -> Gain {
        sum_of(&(0..self.frames.len()).map(|index| self.gain(index)).collect::<Vec<f64>>())
    }

    /// What a frame gains by the means of others.
    fn gain(&self, index: usize) -> f64 {
        let count = self.frames.len();
        let fold = stretch(index, count, THRESHOLDS.folds);
        let others = self.frames.iter().enumerate().filter(|(other, _)| match self.locus {
            // A time's pattern is judged by the frames next to it, not by other times.
            Locus::Time => other % 2 != index % 2,
            _ => stretch(*other, count, THRESHOLDS.folds) != fold,
        });
        let others = together(others.map(|(_, bins)| bins));
        let gain = |(cell, bin): (&Cell, &Bin)| {
            let mean =
                others.get(cell).map_or(DVec2::ZERO, |others| others.mean(THRESHOLDS.prior_measurements));
            mean.dot(bin.score) - 0.5 * mean.dot(bin.information * mean)
        };
        self.frames[index].iter().map(gain).sum()
    }

    /// Returns the root mean square of the tenth of the rows with the largest means, in standard deviations.
    pub(super) fn largest(&self) -> f64 {
        let mut means: Vec<(f64, f64)> = self
            .all
            .values()
            .map(|bin| (bin.mean(THRESHOLDS.prior_measurements).length(), bin.rows))
            .collect();
        means.sort_by(|a, b| b.0.total_cmp(&a.0));
        let wanted = THRESHOLDS.largest_share * means.iter().map(|(_, rows)| rows).sum::<f64>();
        let (mut squares, mut rows) = (0.0, 0.0);
        for (mean, count) in means {
            if rows < wanted {
                squares += mean * mean * count;
                rows += count;
            }
        }
        f64::sqrt(squares / f64::max(rows, 1.0))
    }
}

fn together<'a>(frames: impl Iterator<Item = &'a BTreeMap<Cell, Bin>>) -> BTreeMap<Cell, Bin> {
    let mut all: BTreeMap<Cell, Bin> = BTreeMap::new();
    for bins in frames {
        bins.iter().for_each(|(place, bin)| *all.entry(*place).or_default() += *bin);
    }
    all
}

/// How unlikely a bin's mean is chance, by its scatter from frame to frame; the less likely of its two numbers.
fn p_value(frames: &[BTreeMap<Cell, Bin>], place: Cell) -> Option<f64> {
    let bins: Vec<&Bin> = frames.iter().filter_map(|frame| frame.get(&place)).collect();
    if bins.len() < THRESHOLDS.least_frames {
        return None;
    }
    let total = bins.iter().fold(Bin::default(), |mut total, bin| {
        total += **bin;
        total
    });
    let mean = total.mean(1e-6);
    let axis = |pick: fn(DVec2) -> f64| {
        let scores: Vec<f64> = bins.iter().map(|bin| pick(bin.score - bin.information * mean)).collect();
        let scatter = sum_of(&scores).sigma;
        two_sided(pick(total.score) / scatter.max(1e-9), bins.len() as f64 - 1.0)
    };
    let smaller = axis(|v| v.x).min(axis(|v| v.y));
    smaller.is_finite().then_some(smaller)
}

fn bins(
    frame: &FrameResiduals<'_>,
    sigmas: &BTreeMap<Quantity, f64>,
    (source, locus): (Source, Locus),
    start_s: f64,
) -> BTreeMap<Cell, Bin> {
    let channel = source.channel;
    let mut bins: BTreeMap<Cell, Bin> = BTreeMap::new();
    // Of the carpet's brightness the middle one of a cell stands for all.
    let mut blocks: BTreeMap<Cell, Vec<f64>> = BTreeMap::new();
    for (row, value) in frame.measurements.iter().zip(&frame.values) {
        let sigma = sigmas.get(&row.quantity);
        let Some(&sigma) = sigma.filter(|_| source.has(row) && value.is_finite()) else {
            continue;
        };
        let cell = locus.cell(row, frame, start_s);
        // Other things on the carpet are no pattern of it; what is odd about a line is.
        if matches!(channel, Channel::Photometry | Channel::Noise)
            && value.abs() > THRESHOLDS.clip_sigmas * sigma
        {
            continue;
        }
        if channel == Channel::Photometry {
            blocks.entry(cell).or_default().push(value / sigma);
            continue;
        }
        let residual = (value / sigma).clamp(-THRESHOLDS.clip_sigmas, THRESHOLDS.clip_sigmas);
        let direction = match (channel, locus) {
            (Channel::Geometry | Channel::Color, Locus::Picture) => row.normal,
            // A line that is seen late is off to where it came from, whichever way its normal points.
            (Channel::Geometry, Locus::Speed) => DVec2::X * row.speed_px_s.signum(),
            _ => DVec2::X,
        };
        *bins.entry(cell).or_default() += Bin {
            information: DMat2::from_cols(direction * direction.x, direction * direction.y),
            score: residual * direction,
            rows: 1.0,
        };
    }
    for (cell, mut values) in blocks {
        bins.insert(cell, Bin::of_blocks(&mut values));
    }
    bins
}
