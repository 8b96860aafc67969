use glam::DVec2;

use super::*;
use crate::{
    diagnostics::finding::PatternCell,
    measurement::{quantity::ColorChannel, scalar::Measurement},
    testing::{carpet_measurement, measurement},
};

const SIGMA: f64 = 0.05;
const SIZE: [u32; 2] = [320, 240];

/// Returns pictures at intervals of 0.2 s. `residual` gives a residual from the numbers of the picture and the measurement.
fn frames(
    rows: &[Vec<Measurement>],
    residual: impl Fn(u32, u32, &Measurement) -> f64,
) -> Vec<FrameResiduals<'_>> {
    let framed = (0..).zip(rows).map(|(frame, rows)| FrameResiduals {
        measurements: rows,
        values: (0..).zip(rows).map(|(index, row)| residual(frame, index, row)).collect(),
        time_s: 0.2 * f64::from(frame),
        camera: DVec2::ZERO,
        size: SIZE,
    });
    framed.collect()
}

/// Returns the patterns of the carpet's level in 24 pictures. A block's residual is noise plus `residual` of the picture's
/// number, the block's pixel and its place on the field.
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
    let frames =
        frames(&all, |frame, index, row| 0.1 * noise(frame, index) + residual(frame, row.pixel, row.ground));
    let sigmas = BTreeMap::from([(Quantity::CarpetLevel(ColorChannel::Green), SIGMA)]);
    patterns(&frames, &sigmas, &ModelError::default(), 0.0)
}

#[test]
fn red_and_blue_that_are_displaced_in_opposite_directions_are_two_patterns() {
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
    let frames: Vec<FrameResiduals<'_>> = (0..24)
        .map(|frame| FrameResiduals {
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
fn lines_that_are_seen_late_form_a_pattern_by_speed() {
    // Half of the lines' normals point along the motion of the picture, half against it; fast lines are everywhere in turn.
    let rows_of = |frame: u32| -> Vec<Measurement> {
        (0..300_u32)
            .map(|index| {
                let quick = (index + frame).is_multiple_of(3);
                let speed_px_s =
                    if quick { 100.0 } else { 10.0 } * if index.is_multiple_of(2) { 1.0 } else { -1.0 };
                let pixel = DVec2::new(f64::from(8 * index % 320), f64::from(8 * (index / 40)));
                Measurement { pixel, ground: pixel / 80.0, speed_px_s, ..measurement(Quantity::LineOffset) }
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
    let Finding::Pattern { strongest: PatternCell::Speed { widths_per_s }, .. } = found[0].finding() else {
        panic!("{found:?}")
    };
    assert!((widths_per_s - 0.25).abs() < 1e-9, "{widths_per_s}");
}

#[test]
fn noise_has_no_pattern() {
    assert_eq!(found(|_, _, _| 0.0), []);
}

#[test]
fn dirt_on_the_lens_is_found_with_its_place_and_size() {
    let dirt = |pixel: DVec2| -0.15 * f64::from(u8::from(pixel.distance(DVec2::new(60.0, 180.0)) < 45.0));
    let found = found(|_, pixel, _| dirt(pixel));
    let pattern = found.iter().find(|pattern| pattern.locus == Locus::Picture).unwrap();
    // Columns of 40 pixels and rows of 40.
    let Finding::Pattern { strongest, .. } = pattern.finding() else { panic!("{pattern:?}") };
    assert_eq!(strongest, PatternCell::Picture { column: 1, row: 4, grid: [8, 6] });
    assert!((pattern.reported_size() - 0.15).abs() < 0.03, "{}", pattern.reported_size());
}

#[test]
fn a_stain_on_the_field_is_ordinary() {
    let stain =
        |ground: DVec2| if (ground.floor() - DVec2::new(4.0, 1.0)).length() < 0.1 { -0.15 } else { 0.0 };
    assert_eq!(found(|_, _, ground| stain(ground)), []);
}

#[test]
fn an_object_on_a_part_of_a_cell_is_no_pattern() {
    let object = |ground: DVec2| {
        let inside = ground - ground.floor();
        if ground.floor() == DVec2::new(4.0, 1.0) && inside.x < 0.4 { -0.15 } else { 0.0 }
    };
    assert_eq!(found(|_, _, ground| object(ground)), []);
}

#[test]
fn a_pattern_below_its_material_size_is_not_reported() {
    assert_eq!(found(|_, pixel, _| if pixel.x < 160.0 { 0.02 } else { -0.02 }), []);
}
