//! Residuals in bins, and how well the bins of some frames predict the residuals of others.

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
    inference::hypothesis_test::series_p_value,
    inference::split::stretch,
    measurement::quantity::{Channel, Quantity},
    thresholds::{PatternThresholds, Thresholds},
};

const THRESHOLDS: PatternThresholds = Thresholds::DEFAULT.diagnostics.patterns;

/// Sums of a bin: information and score of its mean. The mean offset of lines in the picture is a vector; every other mean is
/// a number, in the first component.
#[derive(Debug, Clone, Copy)]
struct Bin {
    information: DMat2,
    score: DVec2,
    /// Number of measurements.
    count: f64,
}

impl Default for Bin {
    fn default() -> Self {
        Self { information: DMat2::ZERO, score: DVec2::ZERO, count: 0.0 }
    }
}

impl Bin {
    /// Creates a bin of carpet blocks by their median, which is robust against objects on a part of the carpet.
    fn of_blocks(values: &mut [f64]) -> Self {
        let count = values.len() as f64;
        let information = DMat2::from_diagonal(DVec2::new(count, 0.0));
        Self { information, score: DVec2::new(count * median(values.iter().copied()), 0.0), count }
    }

    /// Returns the mean with a prior of mean zero that counts as much as `prior` measurements.
    fn mean(&self, prior: f64) -> DVec2 {
        (self.information + DMat2::from_diagonal(DVec2::splat(prior))).inverse() * self.score
    }
}

impl std::ops::AddAssign for Bin {
    fn add_assign(&mut self, other: Self) {
        self.information += other.information;
        self.score += other.score;
        self.count += other.count;
    }
}

/// Residuals of a source in the bins of a locus, frame by frame.
pub(super) struct Binned {
    pub(super) source: Source,
    pub(super) locus: Locus,
    frames: Vec<BTreeMap<Cell, Bin>>,
    /// Bins of all frames together.
    all: BTreeMap<Cell, Bin>,
}

impl Binned {
    /// Bins residuals of a recording that starts at `start_s`.
    pub(super) fn new(
        frames: &[FrameResiduals<'_>],
        sigmas: &BTreeMap<Quantity, f64>,
        (source, locus): (Source, Locus),
        start_s: f64,
    ) -> Self {
        let frames: Vec<BTreeMap<Cell, Bin>> =
            frames.iter().map(|frame| bins(frame, sigmas, (source, locus), start_s)).collect();
        let all = merged(frames.iter());
        Self { source, locus, frames, all }
    }

    /// Returns the number of cells that are seen often enough to be tested.
    pub(super) fn tested(&self) -> usize {
        let seen = |cell: &&Cell| self.frames.iter().filter(|frame| frame.contains_key(cell)).count();
        self.all.keys().filter(|cell| seen(cell) >= THRESHOLDS.least_frames).count()
    }

    /// Returns the cells that are seen often enough, each with the p-value of its mean.
    pub(super) fn p_values(&self) -> impl Iterator<Item = (Cell, f64)> {
        self.all.keys().filter_map(|cell| Some((*cell, p_value(&self.frames, *cell)?)))
    }

    /// Returns the length of a cell's mean, in standard deviations of a residual.
    pub(super) fn mean(&self, cell: Cell) -> f64 {
        self.all[&cell].mean(THRESHOLDS.prior_measurements).length()
    }

    /// Returns the gain in log-likelihood of all frames, each predicted by the means of other frames.
    pub(super) fn held_out_gain(&self) -> Gain {
        sum_of(&(0..self.frames.len()).map(|index| self.gain(index)).collect::<Vec<f64>>())
    }

    /// Returns the gain of a frame that is predicted by the means of other frames.
    fn gain(&self, index: usize) -> f64 {
        let count = self.frames.len();
        let fold = stretch(index, count, THRESHOLDS.folds);
        let others = self.frames.iter().enumerate().filter(|(other, _)| match self.locus {
            // A pattern over time is predicted by neighbouring frames, not by other times.
            Locus::Time => other % 2 != index % 2,
            _ => stretch(*other, count, THRESHOLDS.folds) != fold,
        });
        let others = merged(others.map(|(_, bins)| bins));
        let gain = |(cell, bin): (&Cell, &Bin)| {
            let mean =
                others.get(cell).map_or(DVec2::ZERO, |others| others.mean(THRESHOLDS.prior_measurements));
            mean.dot(bin.score) - 0.5 * mean.dot(bin.information * mean)
        };
        self.frames[index].iter().map(gain).sum()
    }

    /// Returns the root mean square of the largest means, in standard deviations: of the bins with a tenth of all
    /// measurements.
    pub(super) fn largest(&self) -> f64 {
        let mut means: Vec<(f64, f64)> = self
            .all
            .values()
            .map(|bin| (bin.mean(THRESHOLDS.prior_measurements).length(), bin.count))
            .collect();
        means.sort_by(|a, b| b.0.total_cmp(&a.0));
        let wanted = THRESHOLDS.largest_share * means.iter().map(|(_, count)| count).sum::<f64>();
        let (mut squares, mut counted) = (0.0, 0.0);
        for (mean, count) in means {
            if counted < wanted {
                squares += mean * mean * count;
                counted += count;
            }
        }
        f64::sqrt(squares / f64::max(counted, 1.0))
    }
}

/// Adds up the bins of several frames.
fn merged<'a>(frames: impl Iterator<Item = &'a BTreeMap<Cell, Bin>>) -> BTreeMap<Cell, Bin> {
    let mut all: BTreeMap<Cell, Bin> = BTreeMap::new();
    for bins in frames {
        bins.iter().for_each(|(cell, bin)| *all.entry(*cell).or_default() += *bin);
    }
    all
}

/// Returns the p-value of a cell's mean by its scatter from frame to frame; of a vector, the smaller one of its components',
/// corrected for their number. None for a cell that is seen too rarely.
fn p_value(frames: &[BTreeMap<Cell, Bin>], cell: Cell) -> Option<f64> {
    let bins: Vec<&Bin> = frames.iter().filter_map(|frame| frame.get(&cell)).collect();
    if bins.len() < THRESHOLDS.least_frames {
        return None;
    }
    let mut total = Bin::default();
    bins.iter().for_each(|bin| total += **bin);
    let mean = total.mean(1e-6);
    let components: [fn(DVec2) -> f64; 2] = [|v| v.x, |v| v.y];
    let seen = components.iter().filter(|pick| pick(total.information.diagonal()) > 0.0);
    let p_values: Vec<f64> = seen
        .map(|pick| {
            let deviations: Vec<f64> =
                bins.iter().map(|bin| pick(bin.score - bin.information * mean)).collect();
            series_p_value(pick(total.score), &deviations)
        })
        .collect();
    let smallest = p_values.iter().copied().fold(1.0, f64::min);
    smallest.is_finite().then_some((p_values.len() as f64 * smallest).min(1.0))
}

/// Returns the bins of a frame.
fn bins(
    frame: &FrameResiduals<'_>,
    sigmas: &BTreeMap<Quantity, f64>,
    (source, locus): (Source, Locus),
    start_s: f64,
) -> BTreeMap<Cell, Bin> {
    let channel = source.channel;
    let mut bins: BTreeMap<Cell, Bin> = BTreeMap::new();
    // Levels of the carpet are represented by the median of a cell.
    let mut blocks: BTreeMap<Cell, Vec<f64>> = BTreeMap::new();
    for (measurement, value) in frame.measurements.iter().zip(&frame.values) {
        let sigma = sigmas.get(&measurement.quantity);
        let Some(&sigma) = sigma.filter(|_| source.has(measurement) && value.is_finite()) else {
            continue;
        };
        let cell = locus.cell(measurement, frame, start_s);
        // Outliers on the carpet are objects on it and no pattern; outliers of lines count with a clipped value.
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
            (Channel::Geometry | Channel::Color, Locus::Picture) => measurement.normal,
            // A line that is seen late is displaced against its motion, whichever way its normal points.
            (Channel::Geometry, Locus::Speed) => DVec2::X * measurement.speed_px_s.signum(),
            _ => DVec2::X,
        };
        *bins.entry(cell).or_default() += Bin {
            information: DMat2::from_cols(direction * direction.x, direction * direction.y),
            score: residual * direction,
            count: 1.0,
        };
    }
    for (cell, mut values) in blocks {
        bins.insert(cell, Bin::of_blocks(&mut values));
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    #[test]
    fn means_of_noise_along_two_axes_are_as_rarely_significant_as_their_p_value_says() {
        const DRAWS: usize = 60_000;
        const CELL: Cell = (0, 0);
        for frames in [6, 12, 45] {
            let mut noise = Noise(frames as u64);
            let mut bin = || Bin {
                information: DMat2::IDENTITY,
                score: DVec2::new(noise.next(), noise.next()),
                count: 1.0,
            };
            let p_values: Vec<f64> = (0..DRAWS)
                .map(|_| {
                    let bins: Vec<BTreeMap<Cell, Bin>> =
                        (0..frames).map(|_| BTreeMap::from([(CELL, bin())])).collect();
                    p_value(&bins, CELL).unwrap()
                })
                .collect();
            for level in [1e-2, 1e-3] {
                let ratio = p_values.iter().filter(|p| **p < level).count() as f64 / (DRAWS as f64 * level);
                assert!((1.0 / 1.5..1.5).contains(&ratio), "{frames} frames, {level}: {ratio}");
            }
        }
    }

    #[test]
    fn an_axis_that_no_line_shows_is_not_tested() {
        let scores = [0.9, 1.1, 1.0, 0.8, 1.2, 1.0, 1.1, 0.9];
        let bins = |information: DMat2| -> Vec<BTreeMap<Cell, Bin>> {
            let bin = |score: f64| Bin { information, score: DVec2::new(score, 0.0), count: 1.0 };
            scores.iter().map(|score| BTreeMap::from([((0, 0), bin(*score))])).collect()
        };
        let one = p_value(&bins(DMat2::from_diagonal(DVec2::X)), (0, 0)).unwrap();
        let two = p_value(&bins(DMat2::IDENTITY), (0, 0)).unwrap();
        assert!((two / one - 2.0).abs() < 1e-3, "{one} {two}");
    }
}
