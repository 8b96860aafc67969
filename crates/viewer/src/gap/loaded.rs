//! A report with its pictures, as read by the thread that opens it.

use std::{fs::File, io::BufReader, path::Path, sync::Arc};

use eframe::egui::ColorImage;
use image::{ImageReader, RgbImage};
use reality_sim_core::preprocess::LUMA_WEIGHTS;
use reality_sim_gap::{
    Channel, ChannelGap, ReportFault,
    report::{EffectReport, Report},
};

use super::ramp::Ramp;
use crate::picture_view::color_image;

/// Largest side of a picture that graphics devices accept, pixels.
const LARGEST_SIDE: u32 = 8192;

/// Remedy for a report that cannot be read.
const REMEDY: &str = "give a folder that `reality-sim gap` wrote, or write it again";
/// Remedy for a report of another format version.
const NEW_REPORT: &str = "`reality-sim gap` writes a new report";

/// Everything shown of a report.
pub struct Loaded {
    pub report: Report,
    /// Frame as it was recorded.
    pub measured: Option<Arc<ColorImage>>,
    /// The same frame simulated by the given model and by the extended one.
    pub simulated: [Option<Arc<ColorImage>>; 2],
    /// Measured minus simulated luma, in the ramp's colours.
    pub differences: [Option<Arc<ColorImage>>; 2],
    /// Those colours, for luma in grey levels of 255; `None` without a difference.
    pub difference_ramp: Option<Ramp>,
    /// Missing parts, in words.
    pub problems: Vec<String>,
}

impl Loaded {
    /// Reads a report's folder. Without the pictures, the rest is still read; without the report, reading fails.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let report = Report::read(folder).map_err(|error| {
            let remedy = if matches!(error.fault, ReportFault::Version { .. }) { NEW_REPORT } else { REMEDY };
            format!("{error}: {remedy}")
        })?;
        let mut problems = Vec::new();
        let mut read = |name: &str| {
            let picture = picture(&folder.join("pictures").join(name));
            picture.map_err(|problem| problems.push(problem)).ok()
        };
        let measured = read("measured.png");
        let simulated = ["before.png", "after.png"].map(&mut read);
        let simulated =
            simulated.map(|picture| same_size(measured.as_ref(), picture?, folder, &mut problems));
        let differences = simulated.each_ref().map(|simulated| {
            measured
                .as_ref()
                .zip(simulated.as_ref())
                .map(|(measured, simulated)| difference(measured, simulated))
        });
        let ramp = Ramp::of(differences.iter().flatten().flatten().copied());
        let colored = |values: Vec<f64>| Some(colored(measured.as_ref()?, &values, ramp?));
        Ok(Self {
            measured: measured.as_ref().map(color_image),
            simulated: simulated.each_ref().map(|picture| picture.as_ref().map(color_image)),
            differences: differences.map(|values| colored(values?)),
            difference_ramp: ramp,
            problems,
            report,
        })
    }

    /// Iterates over the effects found, the surest first, then over those that the model already had.
    pub fn effects(&self) -> impl Iterator<Item = &EffectReport> {
        self.report.effects.iter().chain(&self.report.in_model)
    }

    /// Returns the channel, among those with a map, whose gap is largest relative to its floor.
    pub fn widest_channel(&self) -> Option<Channel> {
        let width = |gap: &ChannelGap| gap.before / gap.floor.max(f64::MIN_POSITIVE);
        let of = |channel: &Channel| self.report.gap.channels.get(channel).map_or(0.0, width);
        let widths = self.report.maps.keys().map(|channel| (*channel, of(channel)));
        widths.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(channel, _)| channel)
    }
}

/// Decodes a picture. The error names the file, the fault and the remedy.
fn picture(path: &Path) -> Result<RgbImage, String> {
    let problem =
        |fault: &str| format!("{}: {fault}: write the report again with `reality-sim gap`", path.display());
    if !path.exists() {
        return Err(problem("there is no such picture"));
    }
    if !path.is_file() {
        return Err(problem("is no regular file"));
    }
    let file = File::open(path).map_err(|error| problem(&format!("cannot be read ({error})")))?;
    let reader = ImageReader::new(BufReader::new(file)).with_guessed_format();
    let reader = reader.map_err(|error| problem(&format!("cannot be read ({error})")))?;
    let decoded = reader.decode().map_err(|error| problem(&format!("is no whole picture ({error})")))?;
    let sides = [decoded.width(), decoded.height()];
    if sides.iter().any(|side| !(1..=LARGEST_SIDE).contains(side)) {
        return Err(problem(&format!("has a side of 0 or more than {LARGEST_SIDE} pixels")));
    }
    Ok(decoded.into_rgb8())
}

/// Returns the picture if it has the same size as the measured one.
fn same_size(
    measured: Option<&RgbImage>,
    picture: RgbImage,
    folder: &Path,
    problems: &mut Vec<String>,
) -> Option<RgbImage> {
    let is_same = measured.is_none_or(|measured| measured.dimensions() == picture.dimensions());
    if !is_same {
        let folder = folder.join("pictures");
        problems.push(format!(
            "{}: its pictures differ in size: write the report again with `reality-sim gap`",
            folder.display()
        ));
    }
    is_same.then_some(picture)
}

/// Returns measured minus simulated luma for each pixel.
fn difference(measured: &RgbImage, simulated: &RgbImage) -> Vec<f64> {
    let [red, green, blue] = LUMA_WEIGHTS;
    let luma = |[r, g, b]: [u8; 3]| red * f64::from(r) + green * f64::from(g) + blue * f64::from(b);
    let pairs = measured.pixels().zip(simulated.pixels());
    pairs.map(|(measured, simulated)| luma(measured.0) - luma(simulated.0)).collect()
}

/// Colours a picture by a value per pixel.
fn colored(picture: &RgbImage, values: &[f64], ramp: Ramp) -> Arc<ColorImage> {
    let size = [picture.width() as usize, picture.height() as usize];
    Arc::new(ColorImage::new(size, values.iter().map(|value| ramp.color(*value)).collect()))
}
