//! What the effects in the model leave, with tolerances and poses fitted.
//!
//! Residuals are binned by where and when they were measured. Bins that keep their mean from one part of the recording
//! to the others are no chance: as for effects, frames are judged by the means of the other parts.

use std::collections::BTreeMap;

use glam::{DMat2, DVec2};

use crate::{
    inference::gain::{Gain, sum_of},
    inference::hypothesis_test::two_sided,
    inference::model_error::ModelError,
    inference::split::stretch,
    linear_model::system::median,
    measurement::quantity::{Channel, Quantity},
    measurement::scalar::Measurement,
    report::text,
};

/// Columns and rows of the picture's grid.
pub(crate) const GRID: [usize; 2] = [8, 6];
/// Cells of speed, of the root of the picture's widths a second: narrow ones where it is slow.
const SPEED_CELL: f64 = 0.2;
/// Side of a cell of the field, metres.
pub(crate) const FIELD_CELL_M: f64 = 1.0;
/// Parts of the recording that are judged by the others.
const FOLDS: usize = 4;
/// A residual counts at most this many standard deviations.
const CLIP: f64 = 4.0;
/// A pattern is significant where its gain on unseen frames is this many standard deviations above zero.
const LEAST_SCORE: f64 = 3.2;
/// Weight of the assumption that there is no pattern, in rows.
const SHRINK: f64 = 20.0;

/// What residuals are binned by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Locus {
    /// Place in the picture.
    Picture,
    /// Place on the field.
    Field,
    /// When.
    Time,
    /// How fast what is seen moves across the line.
    Speed,
}

/// A pattern that no effect of the library explains.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pattern {
    pub(crate) channel: Channel,
    pub(crate) locus: Locus,
    pub(crate) gain: Gain,
    /// Root mean square of the pattern where it is strongest: the tenth of the rows with the largest means.
    pub(crate) size: f64,
    /// The bin whose mean is least likely chance.
    pub(crate) strongest: (i32, i32),
    /// How unlikely that is, corrected for all bins of all patterns.
    pub(crate) p_value: f64,
    /// Mean there.
    pub(crate) strongest_size: f64,
    /// What is smaller does not matter.
    material: f64,
}

impl Pattern {
    fn is_all_over(&self) -> bool {
        self.gain.score() > LEAST_SCORE && self.size > self.material
    }

    /// Where it is, in words.
    pub(crate) fn place(&self) -> String {
        match self.locus {
            Locus::Picture => {
                format!("in the picture, strongest {}", text::picture_place(self.strongest, GRID))
            }
            Locus::Field => {
                let corner =
                    DVec2::new(f64::from(self.strongest.0), f64::from(self.strongest.1)) * FIELD_CELL_M;
                format!("on the field, strongest {}", text::field_place(corner.x, corner.y, FIELD_CELL_M))
            }
            Locus::Time => format!("over time, strongest {} s after the start", self.strongest.0),
            Locus::Speed => {
                let widths_per_s = (SPEED_CELL * (f64::from(self.strongest.0) + 0.5)).powi(2);
                format!("as the picture moves, strongest where it moves by {widths_per_s:.2} widths a second")
            }
        }
    }

    /// The larger of its size all over and in one place, as far as each is significant.
    pub(crate) fn reported_size(&self) -> f64 {
        if self.p_value < LIKELY_CHANCE {
            self.strongest_size.max(if self.is_all_over() { self.size } else { 0.0 })
        } else {
            self.size
        }
    }

    fn is_significant(&self) -> bool {
        let in_one_place = self.p_value < LIKELY_CHANCE && self.strongest_size > self.material;
        self.is_all_over() || in_one_place
    }
}

/// A place is seen in so many frames at least.
const LEAST_FRAMES: usize = 6;
/// What no effect explains is no chance below this, all that is tested of its kind considered; it has to be large besides.
pub(crate) const LIKELY_CHANCE: f64 = 0.02;

/// A frame's residuals after the fit.
pub(crate) struct Residuals<'a> {
    pub(crate) measurements: &'a [Measurement],
    pub(crate) values: Vec<f64>,
    pub(crate) time_s: f64,
    /// The place on the field that the camera is above, metres.
    pub(crate) camera: DVec2,
    pub(crate) size: [u32; 2],
}

/// Sizes below which a pattern does not matter, in the channel's unit.
fn material(channel: Channel, scale: f64) -> f64 {
    match channel {
        Channel::Geometry => 0.12,
        Channel::Photometry => 0.06,
        // A line's profile is not quite the one that is fitted: the error grows with the blur.
        Channel::Sharpness => 0.08_f64.max(0.06 * scale),
        // Centres of mass of blurred lines scatter with the flanks.
        Channel::Color => 0.08 + 0.04 * scale,
        Channel::Noise => 0.6,
        Channel::Motion => f64::INFINITY,
    }
}

/// Every significant pattern.
pub(crate) fn patterns(
    frames: &[Residuals<'_>],
    sigmas: &BTreeMap<Quantity, f64>,
    explained: &ModelError,
    from_s: f64,
) -> Vec<Pattern> {
    // The usual variance of the blur.
    let scale = middle(frames, Channel::Sharpness);
    let material = |channel: Channel| material(channel, scale) + explained.most_off(channel);
    let pairs =
        SOURCES.into_iter().flat_map(|source| source.loci().iter().map(move |&locus| (source, locus)));
    let binned: Vec<Binned> =
        pairs.map(|(source, locus)| Binned::new(frames, sigmas, (source, locus), from_s)).collect();
    let tested = binned.iter().map(Binned::tested).sum::<usize>() as f64;
    let found = binned.iter().filter_map(|binned| {
        binned.pattern(usual_sigma(frames, sigmas, binned.source), material(binned.source.channel), tested)
    });
    found.filter(Pattern::is_significant).collect()
}

/// Rows that are binned together.
#[derive(Debug, Clone, Copy)]
struct Source {
    channel: Channel,
    /// One quantity of the channel; all of them where none is given.
    quantity: Option<Quantity>,
}

impl Source {
    const fn whole(channel: Channel) -> Self {
        Self { channel, quantity: None }
    }

    const fn one(quantity: Quantity) -> Self {
        Self { channel: quantity.channel(), quantity: Some(quantity) }
    }

    /// What it is binned by. Where lines are and how sharp they are may change as the picture moves.
    fn loci(&self) -> &'static [Locus] {
        match self.channel {
            Channel::Geometry | Channel::Sharpness => {
                &[Locus::Picture, Locus::Field, Locus::Time, Locus::Speed]
            }
            _ => &[Locus::Picture, Locus::Field, Locus::Time],
        }
    }

    fn has(&self, row: &Measurement) -> bool {
        row.quantity.channel() == self.channel
            && self.quantity.is_none_or(|quantity| row.quantity == quantity)
    }
}

/// Red and blue are bent to opposite sides by a lens: together they would cancel.
const SOURCES: [Source; 6] = [
    Source::whole(Channel::Geometry),
    Source::whole(Channel::Photometry),
    Source::whole(Channel::Sharpness),
    Source::one(Quantity::RedOffset),
    Source::one(Quantity::BlueOffset),
    Source::whole(Channel::Noise),
];

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
        Self { information, score: DVec2::new(rows * median(values), 0.0), rows }
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

type Place = (i32, i32);

/// Residuals in bins, frame by frame.
struct Binned {
    source: Source,
    locus: Locus,
    frames: Vec<BTreeMap<Place, Bin>>,
    /// All frames together.
    all: BTreeMap<Place, Bin>,
}

impl Binned {
    fn new(
        frames: &[Residuals<'_>],
        sigmas: &BTreeMap<Quantity, f64>,
        (source, locus): (Source, Locus),
        from_s: f64,
    ) -> Self {
        let frames: Vec<BTreeMap<Place, Bin>> =
            frames.iter().map(|frame| bins(frame, sigmas, source, locus, from_s)).collect();
        let all = together(frames.iter());
        Self { source, locus, frames, all }
    }

    /// How many bins are seen often enough to be tested.
    fn tested(&self) -> usize {
        let seen = |place: &&Place| self.frames.iter().filter(|frame| frame.contains_key(place)).count();
        self.all.keys().filter(|place| seen(place) >= LEAST_FRAMES).count()
    }

    /// What a frame gains by the means of others.
    fn gain(&self, index: usize) -> f64 {
        let count = self.frames.len();
        let fold = stretch(index, count, FOLDS);
        let others = self.frames.iter().enumerate().filter(|(other, _)| match self.locus {
            // A time's pattern is judged by the frames next to it, not by other times.
            Locus::Time => other % 2 != index % 2,
            _ => stretch(*other, count, FOLDS) != fold,
        });
        let others = together(others.map(|(_, bins)| bins));
        let gain = |(place, bin): (&Place, &Bin)| {
            let mean = others.get(place).map_or(DVec2::ZERO, |others| others.mean(SHRINK));
            mean.dot(bin.score) - 0.5 * mean.dot(bin.information * mean)
        };
        self.frames[index].iter().map(gain).sum()
    }

    /// Root mean square of the tenth of the rows with the largest means, in standard deviations.
    fn largest(&self) -> f64 {
        let mut means: Vec<(f64, f64)> =
            self.all.values().map(|bin| (bin.mean(SHRINK).length(), bin.rows)).collect();
        means.sort_by(|a, b| b.0.total_cmp(&a.0));
        let wanted = 0.1 * means.iter().map(|(_, rows)| rows).sum::<f64>();
        let (mut squares, mut rows) = (0.0, 0.0);
        for (mean, count) in means {
            if rows < wanted {
                squares += mean * mean * count;
                rows += count;
            }
        }
        f64::sqrt(squares / f64::max(rows, 1.0))
    }

    /// `tested` bins in all are what p-values are corrected for.
    fn pattern(&self, sigma: f64, material: f64, tested: f64) -> Option<Pattern> {
        // Of the places that are no chance the one with the largest mean; where all may be chance, the least likely.
        let places = self.all.iter().filter_map(|(place, bin)| {
            let p_value = (tested * p_value(&self.frames, *place)?).min(1.0);
            let rank = if p_value < LIKELY_CHANCE { 1.0 + bin.mean(SHRINK).length() } else { 1.0 - p_value };
            Some((rank, p_value, *place))
        });
        let (_, p_value, strongest) = places.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let gains: Vec<f64> = (0..self.frames.len()).map(|index| self.gain(index)).collect();
        Some(Pattern {
            channel: self.source.channel,
            locus: self.locus,
            gain: sum_of(&gains),
            size: sigma * self.largest(),
            strongest,
            p_value,
            material,
            strongest_size: sigma * self.all[&strongest].mean(SHRINK).length(),
        })
    }
}

fn together<'a>(frames: impl Iterator<Item = &'a BTreeMap<Place, Bin>>) -> BTreeMap<Place, Bin> {
    let mut all: BTreeMap<Place, Bin> = BTreeMap::new();
    for bins in frames {
        bins.iter().for_each(|(place, bin)| *all.entry(*place).or_default() += *bin);
    }
    all
}

/// Residuals are counted in standard deviations of their own groups: that of all rows together, root mean square.
fn usual_sigma(frames: &[Residuals<'_>], sigmas: &BTreeMap<Quantity, f64>, source: Source) -> f64 {
    let rows = frames.iter().flat_map(|frame| frame.measurements).filter(|row| source.has(row));
    let squares = rows.filter_map(|row| Some(sigmas.get(&row.quantity)?.powi(2)));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// The median of a channel's measurements.
fn middle(frames: &[Residuals<'_>], channel: Channel) -> f64 {
    let rows =
        frames.iter().flat_map(|frame| frame.measurements).filter(|row| row.quantity.channel() == channel);
    let mut values: Vec<f64> = rows.map(|row| row.measured).filter(|value| value.is_finite()).collect();
    median(&mut values)
}

/// How unlikely a bin's mean is chance, by its scatter from frame to frame; the less likely of its two numbers.
fn p_value(frames: &[BTreeMap<(i32, i32), Bin>], place: (i32, i32)) -> Option<f64> {
    let bins: Vec<&Bin> = frames.iter().filter_map(|frame| frame.get(&place)).collect();
    if bins.len() < LEAST_FRAMES {
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
    frame: &Residuals<'_>,
    sigmas: &BTreeMap<Quantity, f64>,
    source: Source,
    locus: Locus,
    from_s: f64,
) -> BTreeMap<(i32, i32), Bin> {
    let channel = source.channel;
    let mut bins: BTreeMap<(i32, i32), Bin> = BTreeMap::new();
    // Of the carpet's brightness the middle one of a place stands for all.
    let mut blocks: BTreeMap<(i32, i32), Vec<f64>> = BTreeMap::new();
    for (row, value) in frame.measurements.iter().zip(&frame.values) {
        let sigma = sigmas.get(&row.quantity);
        let Some(&sigma) = sigma.filter(|_| source.has(row) && value.is_finite()) else {
            continue;
        };
        let place = match locus {
            Locus::Picture => picture_cell(row.pixel, frame.size),
            Locus::Field => {
                ((row.ground.x / FIELD_CELL_M).floor() as i32, (row.ground.y / FIELD_CELL_M).floor() as i32)
            }
            Locus::Time => (((frame.time_s - from_s) / 1.0).floor() as i32, 0),
            Locus::Speed => {
                let widths_per_s = row.speed_px_s.abs() / f64::from(frame.size[0]);
                ((widths_per_s.sqrt() / SPEED_CELL).floor() as i32, 0)
            }
        };
        // Other things on the carpet are no pattern of it; what is odd about a line is.
        if matches!(channel, Channel::Photometry | Channel::Noise) && value.abs() > CLIP * sigma {
            continue;
        }
        if channel == Channel::Photometry {
            blocks.entry(place).or_default().push(value / sigma);
            continue;
        }
        let residual = (value / sigma).clamp(-CLIP, CLIP);
        let direction = match (channel, locus) {
            (Channel::Geometry | Channel::Color, Locus::Picture) => row.normal,
            // A line that is seen late is off to where it came from, whichever way its normal points.
            (Channel::Geometry, Locus::Speed) => DVec2::X * row.speed_px_s.signum(),
            _ => DVec2::X,
        };
        *bins.entry(place).or_default() += Bin {
            information: DMat2::from_cols(direction * direction.x, direction * direction.y),
            score: residual * direction,
            rows: 1.0,
        };
    }
    for (place, mut values) in blocks {
        bins.insert(place, Bin::of_blocks(&mut values));
    }
    bins
}

/// The cell of the picture's grid.
pub(crate) fn picture_cell(pixel: DVec2, size: [u32; 2]) -> (i32, i32) {
    let cell = |value: f64, size: u32, cells: usize| {
        ((value + 0.5) / f64::from(size) * cells as f64).clamp(0.0, cells as f64 - 1.0) as i32
    };
    (cell(pixel.x, size[0], GRID[0]), cell(pixel.y, size[1], GRID[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        measurement::quantity::ColorChannel,
        testing::{carpet_measurement, measurement},
    };

    const SIGMA: f64 = 0.05;
    const SIZE: [u32; 2] = [320, 240];

    /// Pictures five a second whose residuals are these, by the picture's number and the row's.
    fn frames(
        rows: &[Vec<Measurement>],
        residual: impl Fn(u32, u32, &Measurement) -> f64,
    ) -> Vec<Residuals<'_>> {
        let framed = (0..).zip(rows).map(|(frame, rows)| Residuals {
            measurements: rows,
            values: (0..).zip(rows).map(|(index, row)| residual(frame, index, row)).collect(),
            time_s: 0.2 * f64::from(frame),
            camera: DVec2::ZERO,
            size: SIZE,
        });
        framed.collect()
    }

    /// Patterns of the carpet's brightness in 24 pictures, where a block's residual is noise and this, by the picture's
    /// number, the place in the picture and that on the field.
    fn found(residual: impl Fn(u32, DVec2, DVec2) -> f64) -> Vec<Pattern> {
        let noise = |frame: u32, index: u32| {
            let mut state = u64::from(frame * 7919 + index).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            state ^= state >> 29;
            state = state.wrapping_mul(0xBF58_476D_1CE4_E5B9);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let rows_of = |frame: u32| -> Vec<Measurement> {
            (0..1200_u32)
                .map(|index| {
                    let pixel = 8.0 * DVec2::new(f64::from(index % 40), f64::from(index / 40));
                    // The robot walks along the field.
                    carpet_measurement(pixel, pixel / 80.0 + DVec2::new(0.2 * f64::from(frame), 0.0))
                })
                .collect()
        };
        let all: Vec<Vec<Measurement>> = (0..24).map(rows_of).collect();
        let frames = frames(&all, |frame, index, row| {
            0.1 * noise(frame, index) + residual(frame, row.pixel, row.ground)
        });
        let sigmas = BTreeMap::from([(Quantity::CarpetLevel(ColorChannel::Green), SIGMA)]);
        patterns(&frames, &sigmas, &ModelError::default(), 0.0)
    }

    #[test]
    fn red_and_blue_that_are_off_to_opposite_sides_are_two_patterns() {
        let rows: Vec<Measurement> = (0..1200_u32)
            .flat_map(|index| {
                let pixel = 8.0 * DVec2::new(f64::from(index % 40), f64::from(index / 40));
                [Quantity::RedOffset, Quantity::BlueOffset].map(|quantity| Measurement {
                    pixel,
                    normal: DVec2::X,
                    ..measurement(quantity)
                })
            })
            .collect();
        let sign = |quantity: Quantity| if quantity == Quantity::RedOffset { 1.0 } else { -1.0 };
        let off = |row: &Measurement| sign(row.quantity) * 0.004 * (row.pixel.x - 160.0);
        let frames: Vec<Residuals<'_>> = (0..24)
            .map(|frame| Residuals {
                measurements: &rows,
                values: rows.iter().map(off).collect(),
                time_s: 0.2 * f64::from(frame),
                camera: DVec2::ZERO,
                size: SIZE,
            })
            .collect();
        let sigmas = BTreeMap::from([(Quantity::RedOffset, SIGMA), (Quantity::BlueOffset, SIGMA)]);
        let found = patterns(&frames, &sigmas, &ModelError::default(), 0.0);
        let in_picture = found.iter().filter(|pattern| pattern.locus == Locus::Picture);
        assert_eq!(in_picture.count(), 2, "{found:?}");
    }

    #[test]
    fn lines_that_are_seen_late_are_off_by_how_fast_the_picture_moves() {
        // Half of the lines' normals point to where the picture moves, half away; quick ones are seen in turns anywhere.
        let rows_of = |frame: u32| -> Vec<Measurement> {
            (0..300_u32)
                .map(|index| {
                    let quick = (index + frame).is_multiple_of(3);
                    let speed_px_s =
                        if quick { 100.0 } else { 10.0 } * if index.is_multiple_of(2) { 1.0 } else { -1.0 };
                    let pixel = DVec2::new(f64::from(8 * index % 320), f64::from(8 * (index / 40)));
                    Measurement {
                        pixel,
                        ground: pixel / 80.0,
                        speed_px_s,
                        ..measurement(Quantity::LineOffset)
                    }
                })
                .collect()
        };
        let all: Vec<Vec<Measurement>> = (0..24).map(rows_of).collect();
        let frames = frames(&all, |_, _, row| 0.004 * row.speed_px_s);
        let sigmas = BTreeMap::from([(Quantity::LineOffset, 0.2)]);
        let found = patterns(&frames, &sigmas, &ModelError::default(), 0.0);
        let loci: Vec<Locus> = found.iter().map(|pattern| pattern.locus).collect();
        assert_eq!(loci, [Locus::Speed], "{found:?}");
        assert!((found[0].reported_size() - 0.4).abs() < 0.02, "{}", found[0].reported_size());
        // 100 of 320 pixels are 0.31 widths, in the cell around 0.25.
        assert!(found[0].place().contains("by 0.25 widths a second"), "{}", found[0].place());
    }

    #[test]
    fn noise_has_no_pattern() {
        assert_eq!(found(|_, _, _| 0.0), []);
    }

    #[test]
    fn dirt_on_the_lens_is_found_where_it_is_with_its_size() {
        let dirt = |pixel: DVec2| -0.15 * f64::from(u8::from(pixel.distance(DVec2::new(60.0, 180.0)) < 45.0));
        let found = found(|_, pixel, _| dirt(pixel));
        let pattern = found.iter().find(|pattern| pattern.locus == Locus::Picture).unwrap();
        assert_eq!(pattern.strongest, picture_cell(DVec2::new(60.0, 180.0), SIZE));
        assert!((pattern.reported_size() - 0.15).abs() < 0.03, "{}", pattern.reported_size());
        assert!(pattern.place().contains("in the picture"), "{}", pattern.place());
    }

    #[test]
    fn a_stain_on_the_field_is_found_on_the_field() {
        let stain =
            |ground: DVec2| if (ground.floor() - DVec2::new(4.0, 1.0)).length() < 0.1 { -0.15 } else { 0.0 };
        let found = found(|_, _, ground| stain(ground));
        let pattern = found.iter().find(|pattern| pattern.locus == Locus::Field).unwrap();
        assert_eq!(pattern.strongest, (4, 1));
    }

    #[test]
    fn a_thing_on_a_part_of_a_place_is_no_pattern_of_it() {
        let thing = |ground: DVec2| {
            let inside = ground - ground.floor();
            if ground.floor() == DVec2::new(4.0, 1.0) && inside.x < 0.4 { -0.15 } else { 0.0 }
        };
        assert_eq!(found(|_, _, ground| thing(ground)), []);
    }

    #[test]
    fn what_is_too_small_to_matter_is_not_told() {
        assert_eq!(found(|_, pixel, _| if pixel.x < 160.0 { 0.02 } else { -0.02 }), []);
    }
}
