//! Measures the clean stage: pictures made of a database's, with and without what stood there, against pictures of the same poses
//! in the empty hall.
//!
//! `cargo run --example clean_stage -- DATABASE PROBES CLEAN_PROBES [--half even|odd] [--pictures FOLDER]`
//!
//! PROBES are pictures with things, CLEAN_PROBES those of the same poses without any. Things stood where the two differ, on the
//! carpet. Rules are made on the even probes; the odd ones are for measuring once.

#![expect(clippy::print_stdout, reason = "an example shows what it measures")]

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use anyhow::{Context, bail};
use image::RgbImage;
use reality_sim::{
    Archive, CameraPose, Sequence, Synthesizer,
    montage::grid,
    sequence::save_image,
    synthesis::{MethodKind, quality::Mask},
};

/// Difference between the pictures with and without things from which one stood there, grey levels: noise stays below it.
const THING: u8 = 30;
/// Neighbours of nine that have to differ as well.
const LEAST_AROUND: usize = 5;
/// Methods that are compared.
const METHODS: [MethodKind; 2] = [MethodKind::Blend, MethodKind::Plane];

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [database, probes, empty, options @ ..] = &arguments[..] else {
        bail!("give DATABASE PROBES CLEAN_PROBES [--half even|odd] [--pictures FOLDER]");
    };
    let option = |name: &str| {
        let place = options.iter().position(|option| option == name)?;
        options.get(place + 1)
    };
    let half = match option("--half").map(String::as_str) {
        Some("even") => Some(0),
        Some("odd") => Some(1),
        None => None,
        Some(other) => bail!("--half {other}: give even or odd"),
    };
    let folder = option("--pictures").map(PathBuf::from);
    let [probes, empty] = [probes, empty].map(|path| Sequence::open(Path::new(path)));
    let (probes, empty) = (probes?, empty?);
    let archive = Arc::new(Archive::open(Path::new(database), 1 << 30)?);
    let camera = probes.setup.camera.clone();
    let with = |is_clean: bool| {
        let config = reality_sim::synthesis::SynthesisConfig::new(&archive);
        let warper = Arc::new(reality_sim::warp::CpuWarper);
        Synthesizer::with(archive.clone(), camera.clone(), warper, config).with_clean(is_clean)
    };
    let makers = [("as recorded", with(false)), ("clean", with(true))];
    let mut errors: BTreeMap<(String, &str, Where), Error> = BTreeMap::new();
    for frame in (0..probes.frames.len()).filter(|frame| half.is_none_or(|half| frame % 2 == half)) {
        let pose = probes.frames[frame].reference_pose.context("probes have ground truth")?;
        let (there, truth) = (probes.load_image(frame)?, empty.load_image(frame)?);
        let places = places(&there, &truth, pose, &probes);
        let mut shown = vec![there, truth.clone()];
        for method in METHODS {
            for (name, maker) in &makers {
                let made = maker.image_at(pose, &method)?;
                for (place, error) in compared(&made.picture, &truth, &places) {
                    errors.entry((method.to_string(), name, place)).or_default().add(&error);
                }
                if method == MethodKind::Blend {
                    shown.push(made.picture);
                }
            }
        }
        if let Some(folder) = &folder {
            let rows: Vec<&[RgbImage]> = shown.chunks(2).collect();
            save_image(&folder.join(format!("{frame:06}.png")), &grid(&rows, camera.width))?;
        }
    }
    println!("{:10} {:14} {:28} {:>10} {:>9}", "method", "pictures", "where", "pixels", "PSNR");
    for ((method, name, place), error) in errors {
        println!(
            "{method:10} {name:14} {:28} {:>10} {:>6.2} dB",
            place.words(),
            error.pixels,
            error.psnr_db()
        );
    }
    Ok(())
}

/// Part of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Where {
    Thing,
    Carpet,
    ThingAbove,
    Above,
}

impl Where {
    fn words(self) -> &'static str {
        match self {
            Self::Thing => "carpet where things stood",
            Self::Carpet => "carpet elsewhere",
            Self::ThingAbove => "beside it where things stood",
            Self::Above => "beside it elsewhere",
        }
    }
}

/// Returns which part every pixel belongs to.
fn places(there: &RgbImage, truth: &RgbImage, pose: CameraPose, probes: &Sequence) -> Vec<Where> {
    let (width, height) = truth.dimensions();
    let carpet = Mask::carpet(&probes.setup.camera, pose, &probes.field);
    let differs = |u: u32, v: u32| {
        let (a, b) = (there.get_pixel(u, v), truth.get_pixel(u, v));
        (0..3).any(|channel| a.0[channel].abs_diff(b.0[channel]) > THING)
    };
    let is_thing = |u: u32, v: u32| {
        let rows = v.saturating_sub(1)..height.min(v + 2);
        let around = rows.flat_map(|v| (u.saturating_sub(1)..width.min(u + 2)).map(move |u| (u, v)));
        around.filter(|(u, v)| differs(*u, *v)).count() >= LEAST_AROUND
    };
    let pixels = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
    pixels
        .enumerate()
        .map(|(index, (u, v))| match (carpet.holds(index), is_thing(u, v)) {
            (true, true) => Where::Thing,
            (true, false) => Where::Carpet,
            (false, true) => Where::ThingAbove,
            (false, false) => Where::Above,
        })
        .collect()
}

/// Sum of squared differences.
#[derive(Debug, Clone, Copy, Default)]
struct Error {
    squares: f64,
    pixels: usize,
}

impl Error {
    fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.pixels += other.pixels;
    }

    fn psnr_db(&self) -> f64 {
        10.0 * (255.0 * 255.0 * 3.0 * self.pixels as f64 / self.squares).log10()
    }
}

fn compared(picture: &RgbImage, truth: &RgbImage, places: &[Where]) -> BTreeMap<Where, Error> {
    let mut errors: BTreeMap<Where, Error> = BTreeMap::new();
    for ((a, b), place) in picture.pixels().zip(truth.pixels()).zip(places) {
        let squares: f64 = a.0.iter().zip(b.0).map(|(a, b)| (f64::from(*a) - f64::from(b)).powi(2)).sum();
        errors.entry(*place).or_default().add(&Error { squares, pixels: 1 });
    }
    errors
}
