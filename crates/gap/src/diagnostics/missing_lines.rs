//! Lines that should be there and are not, and what else does not look like a field.

use std::collections::{BTreeMap, BTreeSet};

use reality_sim_core::field::{Curve, FieldDimensions};

use crate::{
    measurement::frame::FrameMeasurements, measurement::quantity::Channel, report::data::Unexplained,
};

/// A line is missing where less than this part of its pieces is found, as against all lines.
const MISSING: f64 = 0.4;
/// What is found farther from where a line should be is another one, pixels.
const NEAR_PX: f64 = 1.5;
/// And it was looked for in so many pieces and frames.
const LEAST_PIECES: f64 = 24.0;
/// Lines that are seldom found at all are not missed.
const USUALLY_SEEN: f64 = 0.5;
const LEAST_FRAMES: usize = 4;

/// Pieces that were found, and that were expected.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    found: f64,
    expected: f64,
}

/// Lines of the field that are not where the model has them. Thin ones are found less often: a line is compared with
/// pieces of other lines that are as wide in the picture.
pub(crate) fn missing(looks: &[&FrameMeasurements], field: &FieldDimensions) -> Vec<Unexplained> {
    let mut counts: BTreeMap<(usize, usize), Count> = BTreeMap::new();
    let mut frames: BTreeMap<usize, usize> = BTreeMap::new();
    for look in looks {
        // What stands before a line says nothing of it.
        for piece in look.expected_lines.iter().filter(|piece| !piece.is_hidden) {
            counts.entry((piece.curve, width(piece.half_width_px))).or_default().expected += 1.0;
        }
        for line in
            look.lines.iter().filter(|line| line.is_expected && line.profile.offset_px.abs() < NEAR_PX)
        {
            counts.entry((line.curve, width(line.half_width_px))).or_default().found += 1.0;
        }
        let in_sight = look.expected_lines.iter().filter(|piece| !piece.is_hidden);
        let seen: BTreeSet<usize> = in_sight.map(|piece| piece.curve).collect();
        seen.into_iter().for_each(|curve| *frames.entry(curve).or_default() += 1);
    }
    let curves = field.curves();
    let often = frames.iter().filter(|(_, frames)| **frames >= LEAST_FRAMES).map(|(curve, _)| *curve);
    often
        .filter_map(|curve| Some((curve, parts(&counts, curve)?)))
        .filter(|(_, [part, usual])| *part < MISSING * usual)
        .map(|(curve, [part, usual])| Unexplained {
            channel: Channel::Geometry.name().to_owned(),
            r#where: format!(
                "{}: found in {:.0} % of the places where it should be, other lines as wide in {:.0} %",
                name(&curves[curve]),
                100.0 * part,
                100.0 * usual
            ),
            size: 1.0 - part / usual,
            unit: "1".to_owned(),
            p_value: None,
        })
        .collect()
}

/// The part of a curve's pieces that is found, and the part that would be as usual for their widths. None where there are
/// too few to tell.
fn parts(counts: &BTreeMap<(usize, usize), Count>, curve: usize) -> Option<[f64; 2]> {
    let (mut own, mut usual) = (Count::default(), 0.0);
    for (&(_, width), count) in counts.iter().filter(|((of, _), _)| *of == curve) {
        let others = counts.iter().filter(|((of, wide), _)| *of != curve && *wide == width);
        let others = others.fold(Count::default(), |sum, (_, count)| Count {
            found: sum.found + count.found,
            expected: sum.expected + count.expected,
        });
        if others.expected >= LEAST_PIECES {
            own.found += count.found;
            own.expected += count.expected;
            usual += count.expected * others.found / others.expected;
        }
    }
    let enough = own.expected >= LEAST_PIECES && usual >= USUALLY_SEEN * own.expected;
    enough.then(|| [own.found / own.expected, usual / own.expected])
}

/// Lines as wide as each other within a third of a pixel.
fn width(half_width_px: f64) -> usize {
    (1.5 * half_width_px).min(20.0) as usize
}

fn name(curve: &Curve) -> String {
    match curve {
        Curve::Segment { from, to } => {
            format!("the line from ({:.1}, {:.1}) m to ({:.1}, {:.1}) m", from.x, from.y, to.x, to.y)
        }
        Curve::Circle { radius_m, .. } => format!("the circle of {:.1} m", 2.0 * radius_m),
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};
    use reality_sim_core::field::preset_names;

    use super::*;
    use crate::{
        measurement::frame::{ExpectedLine, Line},
        measurement::line_profile::Profile,
    };

    const HALF_WIDTH_PX: f64 = 2.0;

    fn field() -> FieldDimensions {
        preset_names().find_map(FieldDimensions::preset).unwrap()
    }

    fn found(curve: usize) -> Line {
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

    /// A picture in which eight pieces of each of three lines are expected, and so many are found of each. What is not
    /// found of the first line is hidden, or shows carpet.
    fn look(pieces: [usize; 3], is_hidden: bool) -> FrameMeasurements {
        let expected = |curve: usize, piece: usize| ExpectedLine {
            curve,
            half_width_px: HALF_WIDTH_PX,
            is_hidden: is_hidden && curve == 0 && piece >= pieces[0],
        };
        FrameMeasurements {
            camera: DVec3::Z,
            lines: (0..3).flat_map(|curve| vec![found(curve); pieces[curve]]).collect(),
            expected_lines: (0..24).map(|index| expected(index / 8, index % 8)).collect(),
            blocks: Vec::new(),
            noise_steps: Vec::new(),
        }
    }

    fn missing_of(look: &FrameMeasurements, pictures: usize) -> Vec<Unexplained> {
        missing(&vec![look; pictures], &field())
    }

    #[test]
    fn a_line_of_which_carpet_is_seen_instead_is_missing() {
        let [told] = &missing_of(&look([0, 8, 7], false), 6)[..] else { panic!() };
        assert!(told.r#where.contains(&name(&field().curves()[0])), "{}", told.r#where);
        assert_eq!(told.size, 1.0);
    }

    #[test]
    fn a_line_behind_something_is_not_missing() {
        assert_eq!(missing_of(&look([0, 8, 7], true), 6), []);
    }

    #[test]
    fn lines_that_are_found_as_often_as_others_are_not_missing() {
        assert_eq!(missing_of(&look([5, 6, 7], false), 6), []);
    }

    #[test]
    fn a_few_pictures_are_no_proof() {
        assert_eq!(missing_of(&look([0, 8, 7], false), LEAST_FRAMES - 1), []);
    }
}
