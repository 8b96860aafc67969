//! Findings about the poses of a recording.

use std::{collections::BTreeMap, f64::consts::TAU};

use image::{codecs::jpeg::JpegEncoder, imageops};
use reality_sim_core::{
    pose::CameraPose,
    sequence::{Sequence, SequenceError},
};
use serde::Serialize;
use serde_json::json;

use super::{About, Findings};
use crate::{overlay::Overlay, tagging::Tagged};

/// Edge of the cells in which places are counted, metres.
const CELL_M: f64 = 1.0;
/// Number of sectors in which headings are counted.
const SECTORS: u8 = 8;

/// Width of the picture that is shown, pixels, and the quality of its JPEG file: some 10 kB.
const SHOWN_WIDTH: u32 = 320;
const SHOWN_QUALITY: u8 = 75;

/// Number of pictures in a cell of the field with a heading in a sector.
#[derive(Debug, Clone, Copy, Serialize)]
struct Place {
    /// Centre of the cell.
    x_m: f64,
    y_m: f64,
    /// Middle of the sector.
    yaw_rad: f64,
    pictures: usize,
}

/// Says of poses what matters among thousands of recordings.
pub(super) fn findings(
    about: About,
    sequence: &Sequence,
    tagged: &Tagged,
) -> Result<Findings, SequenceError> {
    let quality = tagged.quality();
    let count = tagged.frames.len().max(1) as f64;
    let share = |number: usize| Some(number as f64 / count);
    let mut figures = vec![
        ("frames", Some(tagged.frames.len() as f64)),
        ("lines_within_5px", Some(quality.lines_within_5px)),
        ("lines_within_10px", Some(quality.lines_within_10px)),
        ("completeness", Some(quality.completeness)),
        ("settled", share(tagged.frames.iter().filter(|frame| frame.settled).count())),
        ("sure", share(tagged.frames.iter().filter(|frame| frame.sure).count())),
    ];
    if let Some(error) = tagged.error {
        figures.extend([
            ("mean_m", Some(error.mean_m)),
            ("median_m", Some(error.median_m)),
            ("rmse_m", Some(error.rmse_m)),
            ("p95_m", Some(error.p95_m)),
            ("max_m", Some(error.max_m)),
            ("mean_yaw_rad", Some(error.mean_yaw_rad)),
            ("lost_frames", Some(error.lost_frames as f64)),
        ]);
    }
    let worst = worst_frame(tagged);
    let report = json!({
        "verdict": quality.sentence(),
        "worst_frame": worst,
        "worst_pose": tagged.poses.get(worst).map(|tagged| tagged.pose),
        "places": places(tagged),
        "field": sequence.field,
    });
    let figures = figures.into_iter().map(|(name, value)| (name.to_owned(), value));
    let picture = tagged.poses.get(worst).map(|tagged| shown(sequence, worst, tagged.pose)).transpose()?;
    Ok(Findings { picture, ..Findings::new(about, figures, report) })
}

/// Draws the field's lines at a pose into its picture, and returns that as a JPEG file.
fn shown(sequence: &Sequence, frame: usize, pose: CameraPose) -> Result<Vec<u8>, SequenceError> {
    let (camera, field) = (&sequence.setup.camera, &sequence.field);
    let overlay = Overlay { camera, field, pose, truth: None, border: None, particles: &[], path: &[] };
    let picture = overlay.draw_scene(sequence.load_image(frame)?);
    let height = (SHOWN_WIDTH * picture.height()).div_ceil(picture.width().max(1)).max(1);
    let small = imageops::thumbnail(&picture, SHOWN_WIDTH, height);
    let mut file = Vec::new();
    // Writing into memory cannot fail, and a picture of this size can be encoded.
    let _ = JpegEncoder::new_with_quality(&mut file, SHOWN_QUALITY).encode_image(&small);
    Ok(file)
}

/// Returns the number of the picture whose lines agree least with its pose; the first of them, and 0 without any.
fn worst_frame(tagged: &Tagged) -> usize {
    let share = |index: &usize| tagged.lines[*index].fraction_within_10px().unwrap_or(1.0);
    (0..tagged.lines.len()).min_by(|a, b| share(a).total_cmp(&share(b)).then(a.cmp(b))).unwrap_or(0)
}

/// Counts pictures by place and heading, where the filter had settled.
fn places(tagged: &Tagged) -> Vec<Place> {
    let settled = tagged.frames.iter().zip(&tagged.poses).filter(|(frame, _)| frame.settled);
    let mut counts: BTreeMap<(i64, i64, u8), usize> = BTreeMap::new();
    for (_, tagged) in settled {
        *counts.entry(cell(tagged.pose)).or_default() += 1;
    }
    let place = |((x, y, sector), pictures)| Place {
        x_m: (x as f64 + 0.5) * CELL_M,
        y_m: (y as f64 + 0.5) * CELL_M,
        yaw_rad: f64::from(sector) * TAU / f64::from(SECTORS),
        pictures,
    };
    counts.into_iter().map(place).collect()
}

fn cell(pose: CameraPose) -> (i64, i64, u8) {
    let sector = (pose.yaw_rad.rem_euclid(TAU) / TAU * f64::from(SECTORS)).round() as u8 % SECTORS;
    ((pose.x_m / CELL_M).floor() as i64, (pose.y_m / CELL_M).floor() as i64, sector)
}
