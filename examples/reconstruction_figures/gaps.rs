//! Parts of a walk reconstructed from its other parts: are they smooth, and can the filter use them?

use std::{fmt::Write, path::Path, sync::Arc};

use image::{RgbImage, imageops::thumbnail};
use reality_sim::{
    Localizer, LocalizerConfig, Observation, ObservationKind, Sequence,
    evaluation::{ErrorStatistics, PoseError},
    montage::grid,
    sequence::save_image,
    synthesis::MethodKind,
};

use crate::{IMAGES, synthesizer};

/// Number of parts, and of pictures in each.
const PARTS: usize = 5;
const PICTURES: usize = 20;
/// Side of the squares in which pictures are compared, pixels.
const SQUARE_PX: u32 = 4;
/// Number of pictures of a path in its strip.
const SHOWN: usize = 8;

/// Pictures of one part by one method; the true ones are the first row.
struct Row {
    name: &'static str,
    pictures: Vec<Arc<RgbImage>>,
}

/// Sums over the parts for one method.
#[derive(Default)]
struct Sums {
    name: &'static str,
    /// Difference between the change from one picture to the next and that of the true pictures, grey levels, one value
    /// per step.
    wrong_change: Vec<f64>,
    gauss: Vec<PoseError>,
    contrast: Vec<PoseError>,
}

pub fn write(walk: &Sequence, text: &mut String) -> anyhow::Result<()> {
    let mut sums: Vec<Sums> = Vec::new();
    for part in 0..PARTS {
        let first = (2 * part + 1) * walk.frames.len() / (2 * PARTS) - PICTURES / 2;
        let rows = rows(walk, first)?;
        let truth = changes(&rows[0].pictures);
        for (number, row) in rows.iter().enumerate() {
            if sums.len() <= number {
                sums.push(Sums { name: row.name, ..Default::default() });
            }
            let wrong = changes(&row.pictures)
                .iter()
                .zip(&truth)
                .map(|(change, truth)| difference(change, truth))
                .collect::<Vec<_>>();
            sums[number].wrong_change.extend(wrong);
            sums[number].gauss.extend(localization_errors(walk, first, row, ObservationKind::Gauss)?);
            sums[number].contrast.extend(localization_errors(walk, first, row, ObservationKind::Contrast)?);
        }
        if part == PARTS / 2 {
            show(&rows)?;
        }
    }
    writeln!(
        text,
        "\n## Along a path\n\nOf the first {} pictures, {PARTS} times {PICTURES} in a row are left out and reconstructed from all others. \
         Wrong change: mean difference, grey levels, between how a picture differs from the one before and how the true \
         ones do, in squares of 4 × 4 pixels, over which noise is averaged out: 0 for a path as smooth as the true one, the \
         change of the truth itself for a picture that stands still. Error: of the \
         poses that the particle filter (800 particles, seed 0, from the true pose of the part's first picture) finds \
         in these pictures.\n\n| pictures | wrong change | mean error, `gauss` | mean error, `contrast` |\n|---|---|---|---|",
        walk.frames.len()
    )?;
    for Sums { name, wrong_change, gauss, contrast } in &sums {
        let cm = |errors: &[PoseError]| {
            ErrorStatistics::new(errors)
                .map_or("–".to_owned(), |error| format!("{:.2} cm", 100.0 * error.mean_m))
        };
        let change = wrong_change.iter().sum::<f64>() / wrong_change.len().max(1) as f64;
        writeln!(text, "| {name} | {change:.2} | {} | {} |", cm(gauss), cm(contrast))?;
    }
    text.push_str(
        "\n![A path, true and reconstructed](images/path.jpg)\n\nEvery other or third picture of the third part, from top to \
         bottom: true, `nearest`, `plane`, `blend`.\n",
    );
    Ok(())
}

/// Returns the true pictures and those of every method.
fn rows(walk: &Sequence, first: usize) -> anyhow::Result<Vec<Row>> {
    let left_out = first..first + PICTURES;
    let mut rest = walk.clone();
    rest.frames = walk.frames[..first].to_vec();
    rest.frames.extend_from_slice(&walk.frames[left_out.end..]);
    let (_folder, synthesizer) = synthesizer(&rest)?;
    let truth =
        left_out.clone().map(|frame| walk.load_image(frame).map(Arc::new)).collect::<Result<_, _>>()?;
    let mut rows = vec![Row { name: "true", pictures: truth }];
    for method in MethodKind::COMPARED {
        let mut pictures = Vec::new();
        for frame in left_out.clone() {
            let Some(pose) = walk.frames[frame].reference_pose else { continue };
            pictures.push(Arc::new(synthesizer.image_at(pose, &method)?.picture));
        }
        rows.push(Row { name: method.name(), pictures });
    }
    Ok(rows)
}

/// Returns how each picture differs from the one before, in squares of pixels.
fn changes(pictures: &[Arc<RgbImage>]) -> Vec<Vec<f64>> {
    let small = |picture: &Arc<RgbImage>| {
        let (width, height) = (picture.width() / SQUARE_PX, picture.height() / SQUARE_PX);
        thumbnail(&**picture, width, height).iter().map(|&value| f64::from(value)).collect::<Vec<f64>>()
    };
    let small: Vec<Vec<f64>> = pictures.iter().map(small).collect();
    small.windows(2).map(|pair| pair[1].iter().zip(&pair[0]).map(|(b, a)| b - a).collect()).collect()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len().max(1) as f64
}

/// Returns the filter's errors when these pictures replace a part of a walk.
fn localization_errors(
    walk: &Sequence,
    first: usize,
    row: &Row,
    kind: ObservationKind,
) -> anyhow::Result<Vec<PoseError>> {
    let start = walk.frames[first].reference_pose.map(reality_sim::CameraPose::planar);
    let builder = Localizer::builder(&walk.setup.camera, &walk.field).start(start);
    let mut localizer = builder.config(LocalizerConfig::new(kind)).build()?;
    let mut errors = Vec::new();
    for (offset, picture) in row.pictures.iter().enumerate() {
        let frame = localizer.update(&Observation::of_frame(walk, first + offset, picture))?;
        errors.extend(
            walk.frames[first + offset].reference_pose.map(|truth| PoseError::new(frame.pose, truth)),
        );
    }
    Ok(errors)
}

fn show(rows: &[Row]) -> anyhow::Result<()> {
    let shown: Vec<Vec<RgbImage>> = rows
        .iter()
        .filter(|row| row.name != "quadratic")
        .map(|row| {
            let pictures = (0..SHOWN).map(|i| &row.pictures[i * (row.pictures.len() - 1) / (SHOWN - 1)]);
            pictures.map(|picture| (**picture).clone()).collect()
        })
        .collect();
    let rows: Vec<&[RgbImage]> = shown.iter().map(Vec::as_slice).collect();
    Ok(save_image(&Path::new(IMAGES).join("path.jpg"), &grid(&rows, 220))?)
}
