//! Single pictures at the poses of probes.

use std::{collections::BTreeMap, fmt::Write, path::Path};

use image::RgbImage;
use reality_sim::{
    Sequence, Synthesizer,
    coverage_chart::coverage_svg,
    db::coverage::Coverage,
    evaluation::percentile,
    montage::grid,
    probing::{MethodReport, ProbeResult, compare_methods, names},
    sensor::{Renderer, SceneColors},
    sequence::{save_image, write_atomically},
    synthesis::Blend,
};

use crate::{IMAGES, lines::Lines, synthesizer};

/// Number of probes that are shown, from near to far.
const SHOWN: usize = 5;
/// Width of a picture in the table of pictures, pixels.
const WIDTH: u32 = 300;

pub fn write(walk: &Sequence, probes: &Sequence, text: &mut String) -> anyhow::Result<()> {
    let (_folder, synthesizer) = synthesizer(walk)?;
    let renderer = Renderer::new(&probes.setup, &walk.field, SceneColors::new(&probes.setup, &walk.field));
    let camera = &probes.setup.camera;
    let mut results: Vec<ProbeResult> = Vec::new();
    let mut lines: BTreeMap<&str, Lines> = BTreeMap::new();
    for (frame, pose) in probes.reference_poses().enumerate() {
        let Some(pose) = pose else { continue };
        let probe = compare_methods(&synthesizer, &renderer, frame, pose, probes.load_image(frame)?)?;
        lines.entry("true picture").or_default().add(&probe.truth, camera, &walk.field, pose);
        for (name, outcome) in &probe.outcomes {
            lines.entry(name).or_default().add(&outcome.picture, camera, &walk.field, pose);
        }
        results.push(probe);
    }
    coverage(walk, &synthesizer)?;
    table(&results, lines, text)?;
    results.sort_by(|a, b| a.distance_px.partial_cmp(&b.distance_px).unwrap_or(std::cmp::Ordering::Equal));
    pictures(&results, text)?;
    provenance(&synthesizer, probes, &results, text)
}

/// Draws where the walk was recorded, and how far every place is from the nearest picture.
fn coverage(walk: &Sequence, synthesizer: &Synthesizer) -> anyhow::Result<()> {
    let archive = synthesizer.archive();
    let coverage = Coverage::new(archive.index(), archive.field(), archive.usual_pose(), 0.25);
    let title = format!("{}: {} pictures", walk.name, archive.images().len());
    let svg = coverage_svg(&coverage, archive.field(), &title);
    Ok(write_atomically(&Path::new(IMAGES).join("coverage.svg"), svg.as_bytes())?)
}

fn table(results: &[ProbeResult], mut lines: BTreeMap<&str, Lines>, text: &mut String) -> anyhow::Result<()> {
    text.push_str(
        "\nMeans over all probes; lines: median of how far a line lies from where the true pose puts it, and the 95th \
         percentile, of lines found within 8 px, and the share found; time: median of one picture with decoded neighbours, on \
         two cores.\n\n\
         | method | PSNR of the field | PSNR | SSIM | lines | lines found | answered | time |\n|---|---|---|---|---|---|---|---|\n",
    );
    lines.values_mut().for_each(|lines| lines.displacements_px.sort_by(f64::total_cmp));
    let lines = |name: &str| -> String {
        let Some(Lines { displacements_px, projected }) = lines.get(name) else { return "–".to_owned() };
        let at = |share: f64| {
            percentile(displacements_px, share).map_or("–".to_owned(), |px| format!("{px:.2}"))
        };
        let found = 100.0 * displacements_px.len() as f64 / (*projected).max(1) as f64;
        format!("{} px, {} px | {found:.0} %", at(0.5), at(0.95))
    };
    writeln!(text, "| true picture | | | | {} | | |", lines("true picture"))?;
    for name in names() {
        let report = MethodReport::new(name, results);
        let shown = |value: Option<f64>, digits: usize| {
            value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
        };
        writeln!(
            text,
            "| `{name}` | {} dB | {} dB | {} | {} | {:.0} % | {} ms |",
            shown(report.psnr_field_db, 2),
            shown(report.psnr_db, 2),
            shown(report.ssim, 3),
            lines(name),
            100.0 * report.answered,
            shown(report.milliseconds, 1),
        )?;
    }
    Ok(())
}

/// Shows the true picture and those of all methods, for probes spread evenly from the nearest to the farthest from a
/// recorded picture.
fn pictures(results: &[ProbeResult], text: &mut String) -> anyhow::Result<()> {
    let chosen: Vec<&ProbeResult> =
        (0..SHOWN).map(|i| &results[i * (results.len() - 1) / (SHOWN - 1)]).collect();
    let missing = RgbImage::from_pixel(4, 3, image::Rgb([128; 3]));
    let rows: Vec<Vec<RgbImage>> = chosen
        .iter()
        .map(|probe| {
            let of = |name| probe.outcomes.get(name).map_or(&missing, |outcome| &outcome.picture).clone();
            std::iter::once(probe.truth.clone()).chain(names().map(of)).collect()
        })
        .collect();
    let rows: Vec<&[RgbImage]> = rows.iter().map(Vec::as_slice).collect();
    save_image(&Path::new(IMAGES).join("methods.jpg"), &grid(&rows, WIDTH))?;
    let distances: Vec<String> =
        chosen.iter().map(|probe| format!("{:.0}", probe.distance_px.unwrap_or(f64::NAN))).collect();
    writeln!(
        text,
        "\n![The true picture beside those of all methods](images/methods.jpg)\n\nFrom left to right: the true picture, \
         {}. From top to bottom the nearest recorded picture is {} px away (root mean square over the picture).",
        names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
        distances.join(", ")
    )?;
    Ok(())
}

/// Shows where the pixels of one picture came from.
fn provenance(
    synthesizer: &Synthesizer,
    probes: &Sequence,
    results: &[ProbeResult],
    text: &mut String,
) -> anyhow::Result<()> {
    let probe = &results[results.len() / 2];
    let Some(pose) = probes.frames[probe.frame].reference_pose else { return Ok(()) };
    let made = synthesizer.image_at(pose, &Blend)?;
    let trust = image::DynamicImage::from(made.trust_picture()).into_rgb8();
    let row = [probe.truth.clone(), made.picture.clone(), made.origin_picture(), trust];
    save_image(&Path::new(IMAGES).join("origins.jpg"), &grid(&[&row], 400))?;
    text.push_str(
        "\n![Where the pixels came from](images/origins.jpg)\n\nThe true picture, `blend`, which recorded picture each \
         pixel came from most (a hue each, black: none), and how far each can be trusted.\n",
    );
    Ok(())
}
