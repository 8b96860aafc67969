//! Lines of the field that the pictures do not show.

use std::collections::{BTreeMap, BTreeSet};

use reality_sim_core::field::{Curve, FieldDimensions};

use crate::{
    diagnostics::detector::{Detector, FitResiduals, FrameResiduals},
    diagnostics::finding::{FieldLine, Finding},
    measurement::{
        curve_index::CurveIndex, frame::FrameMeasurements, lines::Line, quantity::Quantity, scalar::Subject,
    },
    thresholds::{MissingLineThresholds, Thresholds},
};

const THRESHOLDS: MissingLineThresholds = Thresholds::DEFAULT.diagnostics.missing_lines;

/// Detector of lines that the pictures do not show where the model predicts them.
pub(crate) struct MissingLines;

impl Detector for MissingLines {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        let frames: Vec<Seen<'_>> = fit
            .measurements
            .iter()
            .zip(&fit.frames)
            .map(|(measured, fitted)| Seen::new(measured, fitted))
            .collect();
        missing_lines(&frames, &fit.recording.sequence.field)
    }
}

/// Lines of a frame, with how far each was found from its place.
struct Seen<'a> {
    measured: &'a FrameMeasurements,
    /// Offset of each line that was found, after the fit of the frame's pose; pixels. Errors of a reference pose displace short
    /// lines by more than their width.
    offsets_px: Vec<f64>,
}

impl<'a> Seen<'a> {
    fn new(measured: &'a FrameMeasurements, fitted: &FrameResiduals<'_>) -> Self {
        let mut offsets_px: Vec<f64> = measured.lines.iter().map(|line| line.profile.offset_px).collect();
        for (measurement, &value) in fitted.measurements.iter().zip(&fitted.values) {
            if let Subject::Line(index) = measurement.subject
                && measurement.quantity == Quantity::LineOffset
                && value.is_finite()
            {
                offsets_px[index] = value;
            }
        }
        Self { measured, offsets_px }
    }

    /// Iterates over the lines that were found at their places.
    fn at_their_places(&self) -> impl Iterator<Item = &Line> {
        let lines = self.measured.lines.iter().zip(&self.offsets_px);
        lines
            .filter(|(line, offset_px)| line.is_expected && offset_px.abs() < THRESHOLDS.near_px)
            .map(|(line, _)| line)
    }
}

/// Numbers of pieces found and expected.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    found: f64,
    expected: f64,
}

/// Returns the lines of which clearly fewer pieces are found than of other lines. Thin lines are found less often than broad
/// ones, so pieces are compared with those of other lines that are as wide in the picture.
fn missing_lines(frames: &[Seen<'_>], field: &FieldDimensions) -> Vec<Finding> {
    let counts = Counts::of(frames);
    let curves = field.curves();
    let often = counts
        .frames
        .iter()
        .filter(|(_, frames)| **frames >= THRESHOLDS.least_frames)
        .map(|(curve, _)| *curve);
    often
        .filter_map(|curve| Some((curve, counts.shares(curve)?)))
        .filter(|(_, [found, usual])| *found < THRESHOLDS.most_found * usual)
        .map(|(curve, [found_share, usual_share])| Finding::MissingLine {
            line: field_line(&curves[curve.0]),
            found_share,
            usual_share,
        })
        .collect()
}

/// Counts of the field's curves, by their indices.
#[derive(Default)]
struct Counts {
    /// Pieces by curve and by their width in the picture.
    pieces: BTreeMap<(CurveIndex, i32), Count>,
    /// Frames in which a curve is in sight.
    frames: BTreeMap<CurveIndex, usize>,
}

impl Counts {
    fn of(frames: &[Seen<'_>]) -> Self {
        let mut counts = Self::default();
        frames.iter().for_each(|frame| counts.add(frame));
        counts
    }

    fn add(&mut self, frame: &Seen<'_>) {
        // A hidden piece is no evidence that the line is missing.
        let in_sight = || frame.measured.expected_lines.iter().filter(|piece| !piece.is_hidden);
        for piece in in_sight() {
            self.pieces.entry((piece.curve, width(piece.half_width_px))).or_default().expected += 1.0;
        }
        for line in frame.at_their_places() {
            self.pieces.entry((line.curve, width(line.half_width_px))).or_default().found += 1.0;
        }
        let seen: BTreeSet<CurveIndex> = in_sight().map(|piece| piece.curve).collect();
        seen.into_iter().for_each(|curve| *self.frames.entry(curve).or_default() += 1);
    }

    /// Returns the share of a curve's pieces that is found, and the share that is usual for pieces of their widths. None if
    /// there are too few pieces.
    fn shares(&self, curve: CurveIndex) -> Option<[f64; 2]> {
        let (mut own, mut usual) = (Count::default(), 0.0);
        for (&(_, width), count) in self.pieces.iter().filter(|((of, _), _)| *of == curve) {
            let others = self.pieces.iter().filter(|((of, wide), _)| *of != curve && *wide == width);
            let others = others.fold(Count::default(), |sum, (_, count)| Count {
                found: sum.found + count.found,
                expected: sum.expected + count.expected,
            });
            if others.expected >= THRESHOLDS.least_pieces {
                own.found += count.found;
                own.expected += count.expected;
                usual += count.expected * others.found / others.expected;
            }
        }
        let enough =
            own.expected >= THRESHOLDS.least_pieces && usual >= THRESHOLDS.least_usually_found * own.expected;
        enough.then(|| [own.found / own.expected, usual / own.expected])
    }
}

/// Returns the bin of a line's width.
fn width(half_width_px: f64) -> i32 {
    (THRESHOLDS.width_bins_per_octave * half_width_px.log2()).floor() as i32
}

fn field_line(curve: &Curve) -> FieldLine {
    match curve {
        Curve::Segment { from, to } => FieldLine::Segment { from_m: from.to_array(), to_m: to.to_array() },
        Curve::Circle { radius_m, .. } => FieldLine::Circle { diameter_m: 2.0 * radius_m },
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};
    use reality_sim_core::field::preset_names;

    use super::*;
    use crate::{
        measurement::line_profile::Profile, measurement::lines::ExpectedLine,
        measurement::scalar::Measurement, testing::measurement,
    };

    const HALF_WIDTH_PX: f64 = 2.0;

    fn field() -> FieldDimensions {
        preset_names().find_map(FieldDimensions::preset).unwrap()
    }

    fn found(curve: CurveIndex) -> Line {
        Line {
            curve,
            fraction: 0.5,
            ground: DVec2::ZERO,
            pixel: DVec2::ZERO,
            normal: DVec2::X,
            speed_px_s: 0.0,
            profile: Profile {
                offset_px: 0.2,
                offset_sigma_px: 0.1,
                variance_px2: 1.0,
                variance_sigma_px2: 0.1,
                color_offset_px: None,
                contrast_share: [0.3, 0.4, 0.3],
                level: None,
            },
            half_width_px: HALF_WIDTH_PX,
            is_expected: true,
        }
    }

    /// Picture in which eight pieces of each of three lines are expected and `pieces` of each are found. The other pieces of
    /// the first line are hidden, or show carpet.
    fn frame(pieces: [usize; 3], is_hidden: bool) -> FrameMeasurements {
        let expected = |curve: usize, piece: usize| ExpectedLine {
            curve: CurveIndex(curve),
            half_width_px: HALF_WIDTH_PX,
            is_hidden: is_hidden && curve == 0 && piece >= pieces[0],
        };
        FrameMeasurements {
            camera_in_world: DVec3::Z,
            lines: (0..3).flat_map(|curve| vec![found(CurveIndex(curve)); pieces[curve]]).collect(),
            expected_lines: (0..24).map(|index| expected(index / 8, index % 8)).collect(),
            blocks: Vec::new(),
            ..FrameMeasurements::default()
        }
    }

    fn missing_of(frame: &FrameMeasurements, pictures: usize) -> Vec<Finding> {
        let offsets_px = frame.lines.iter().map(|line| line.profile.offset_px).collect::<Vec<_>>();
        let seen = || Seen { measured: frame, offsets_px: offsets_px.clone() };
        missing_lines(&Vec::from_iter((0..pictures).map(|_| seen())), &field())
    }

    #[test]
    fn a_line_where_the_pictures_show_carpet_is_missing() {
        let line = field_line(&field().curves()[0]);
        let usual_share = 15.0 / 16.0;
        let found = missing_of(&frame([0, 8, 7], false), 6);
        assert_eq!(found, [Finding::MissingLine { line, found_share: 0.0, usual_share }]);
        assert_eq!(found[0].size(), 1.0);
    }

    #[test]
    fn a_line_that_an_error_of_the_pose_displaces_is_not_missing() {
        let mut displaced = frame([8, 8, 7], false);
        for line in displaced.lines.iter_mut().filter(|line| line.curve == CurveIndex(0)) {
            line.profile.offset_px = 4.0;
        }
        let fitted = |residual_px: f64| {
            let of_line = |index: usize| Measurement {
                subject: Subject::Line(index),
                ..measurement(Quantity::LineOffset)
            };
            let measurements: Vec<Measurement> = (0..displaced.lines.len()).map(of_line).collect();
            let fitted = FrameResiduals {
                values: vec![residual_px; measurements.len()],
                measurements: &measurements,
                time_s: 0.0,
                camera: DVec2::ZERO,
                size: [640, 480],
            };
            missing_lines(&Vec::from_iter((0..6).map(|_| Seen::new(&displaced, &fitted))), &field())
        };
        assert_eq!(fitted(0.3), []);
        assert_eq!(fitted(f64::NAN).len(), 1);
    }

    #[test]
    fn a_hidden_line_is_not_missing() {
        assert_eq!(missing_of(&frame([0, 8, 7], true), 6), []);
    }

    #[test]
    fn lines_that_are_found_as_often_as_others_are_not_missing() {
        assert_eq!(missing_of(&frame([5, 6, 7], false), 6), []);
    }

    #[test]
    fn a_line_in_too_few_pictures_is_not_reported() {
        assert_eq!(missing_of(&frame([0, 8, 7], false), THRESHOLDS.least_frames - 1), []);
    }
}
