//! How far penalty marks, which no fit uses, are from where the poses put them, and how that compares with the covariances:
//!
//! `cargo run --release -p reality-sim-calibration --example held_out_marks -- SEQUENCE [CAMERA]`

#![allow(clippy::print_stdout, reason = "the report is all that this program is for")]

use std::{collections::HashSet, error::Error, path::Path};

use glam::DVec2;
use image::GrayImage;
use nalgebra::{Matrix2, Matrix2x6, Vector2};
use reality_sim_calibration::assess;
use reality_sim_core::{
    camera::Camera,
    localization::{LocalizedFrame, Localizer},
    pose::CameraPose,
    preprocess::whiteness,
    refine::CalibrationUncertainty,
    sequence::Sequence,
};

/// Half the side of the window in which a mark is looked for, pixels.
const REACH_PX: i32 = 48;

/// Fewest pixels of a mark.
const LEAST_PIXELS: usize = 12;

/// Standard deviation of a mark's middle in the picture, pixels: it is a blob of some dozen pixels.
const MARK_SIGMA_PX: f64 = 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = arguments.first().ok_or("give the folder of a sequence")?;
    let sequence = Sequence::open_with_camera(Path::new(folder), arguments.get(1).map(Path::new))?;
    let camera = &sequence.setup.camera;
    let builder = Localizer::builder(camera, &sequence.field).start(sequence.start);
    let mut localizer = builder.calibration(sequence.calibration.clone()).build()?;
    let frames = localizer.run(&sequence).collect::<Result<Vec<_>, _>>()?;
    let fits: Vec<(usize, CameraPose)> = frames
        .iter()
        .enumerate()
        .filter_map(|(index, frame)| Some((index, frame.fit.filter(|_| frame.settled)?.pose)))
        .collect();
    let assessed = if sequence.calibration.is_none() { assess(&sequence, &fits)? } else { None };
    let uncertainty = assessed.map(|assessed| assessed.uncertainty).or_else(|| sequence.calibration.clone());
    let mut misses = Vec::new();
    for (index, frame) in frames.iter().enumerate() {
        let picture = whiteness(&sequence.load_image(index)?);
        misses.extend(marks(&sequence, frame, &picture, uncertainty.as_ref()));
    }
    report(&misses);
    Ok(())
}

/// A mark that was seen away from where it is, on the ground.
struct Miss {
    error_m: Vector2<f64>,
    covariance: Matrix2<f64>,
}

fn marks(
    sequence: &Sequence,
    frame: &LocalizedFrame,
    picture: &GrayImage,
    uncertainty: Option<&CalibrationUncertainty>,
) -> Vec<Miss> {
    let Some(fit) = frame.fit.filter(|_| frame.settled) else { return Vec::new() };
    let fit = fit.with_calibration(uncertainty);
    let (camera, field) = (&sequence.setup.camera, &sequence.field);
    let along_m = 0.5 * field.length_m - field.penalty_mark_distance_m;
    let places = [DVec2::new(along_m, 0.0), DVec2::new(-along_m, 0.0)];
    let miss = |mark: DVec2| {
        let pixel = camera.project(fit.pose.camera_from_world(mark.extend(0.0))).ok()?;
        let found = blob(picture, pixel)?;
        let ground = |pose: CameraPose, pixel: DVec2| camera.unproject_to_ground(pose, pixel).ok();
        let seen = ground(fit.pose, found)?;
        let by_pose = gradient(camera, fit.pose, found)?;
        let by_pixel = [DVec2::X, DVec2::Y].map(|step| {
            let step = ground(fit.pose, found + step).map_or(DVec2::ZERO, |moved| moved - seen);
            Vector2::new(step.x, step.y) * MARK_SIGMA_PX
        });
        let of_pixel: Matrix2<f64> = by_pixel.iter().map(|step| step * step.transpose()).sum();
        let error_m = Vector2::new(seen.x - mark.x, seen.y - mark.y);
        // Whoever stands on the mark hides it, and something else white is found.
        (error_m.norm() < 0.5)
            .then(|| Miss { error_m, covariance: by_pose * fit.covariance * by_pose.transpose() + of_pixel })
    };
    places.into_iter().filter_map(miss).collect()
}

fn gradient(camera: &Camera, pose: CameraPose, pixel: DVec2) -> Option<Matrix2x6<f64>> {
    const STEP: f64 = 1e-5;
    let moved = |axis: usize, step: f64| {
        let mut pose = pose;
        let numbers = [
            &mut pose.x_m,
            &mut pose.y_m,
            &mut pose.yaw_rad,
            &mut pose.height_m,
            &mut pose.pitch_rad,
            &mut pose.roll_rad,
        ];
        if let Some(number) = numbers.into_iter().nth(axis) {
            *number += step;
        }
        camera.unproject_to_ground(pose, pixel).ok()
    };
    let mut gradient = Matrix2x6::zeros();
    for axis in 0..6 {
        let change = (moved(axis, STEP)? - moved(axis, -STEP)?) / (2.0 * STEP);
        gradient.set_column(axis, &Vector2::new(change.x, change.y));
    }
    Some(gradient)
}

/// Returns the middle of the bright blob nearest to a pixel; `None` if there is none near it, or if it is not all in view.
fn blob(picture: &GrayImage, near: DVec2) -> Option<DVec2> {
    let window = Window::around(picture, near)?;
    let first =
        window.bright().min_by_key(|(u, v)| (u - window.middle.0).pow(2) + (v - window.middle.1).pow(2))?;
    let mut component = vec![first];
    let mut known: HashSet<(i32, i32)> = component.iter().copied().collect();
    let mut next = 0;
    while next < component.len() {
        let (u, v) = component[next];
        next += 1;
        for beside in [(u + 1, v), (u - 1, v), (u, v + 1), (u, v - 1)] {
            if window.is_bright(beside) && known.insert(beside) {
                component.push(beside);
            }
        }
    }
    let is_whole = component.len() >= LEAST_PIXELS && !component.iter().any(|&pixel| window.is_edge(pixel));
    let weight = |&pixel: &(i32, i32)| window.value(pixel) - window.carpet;
    let total: f64 = component.iter().map(weight).sum();
    let sum: DVec2 = component
        .iter()
        .map(|pixel| DVec2::new(f64::from(pixel.0), f64::from(pixel.1)) * weight(pixel))
        .sum();
    is_whole.then(|| sum / total)
}

/// Part of a picture.
struct Window<'a> {
    picture: &'a GrayImage,
    middle: (i32, i32),
    carpet: f64,
    threshold: f64,
}

impl<'a> Window<'a> {
    fn around(picture: &'a GrayImage, near: DVec2) -> Option<Self> {
        let middle = (near.x.round() as i32, near.y.round() as i32);
        let mut window = Self { picture, middle, carpet: 0.0, threshold: 0.0 };
        let mut values: Vec<f64> = window.pixels().map(|pixel| window.value(pixel)).collect();
        values.sort_by(f64::total_cmp);
        let (carpet, brightest) =
            (*values.get(values.len() / 2)?, *values.get(values.len().checked_sub(6)?)?);
        (window.carpet, window.threshold) = (carpet, 0.5 * (carpet + brightest));
        (brightest > carpet + 40.0).then_some(window)
    }

    fn is_inside(&self, (u, v): (i32, i32)) -> bool {
        u >= 0 && v >= 0 && u < self.picture.width() as i32 && v < self.picture.height() as i32
    }

    fn pixels(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        let around = |middle: i32| middle - REACH_PX..=middle + REACH_PX;
        let all = around(self.middle.1).flat_map(move |v| around(self.middle.0).map(move |u| (u, v)));
        all.filter(|&pixel| self.is_inside(pixel))
    }

    fn value(&self, (u, v): (i32, i32)) -> f64 {
        f64::from(self.picture.get_pixel(u as u32, v as u32).0[0])
    }

    fn is_bright(&self, pixel: (i32, i32)) -> bool {
        let is_near =
            (pixel.0 - self.middle.0).abs() <= REACH_PX && (pixel.1 - self.middle.1).abs() <= REACH_PX;
        is_near && self.is_inside(pixel) && self.value(pixel) > self.threshold
    }

    fn bright(&self) -> impl Iterator<Item = (i32, i32)> + '_ {
        self.pixels().filter(|&pixel| self.is_bright(pixel))
    }

    fn is_edge(&self, (u, v): (i32, i32)) -> bool {
        let is_at_reach = (u - self.middle.0).abs() == REACH_PX || (v - self.middle.1).abs() == REACH_PX;
        is_at_reach || !self.is_inside((u - 1, v - 1)) || !self.is_inside((u + 1, v + 1))
    }
}

fn report(misses: &[Miss]) {
    let count = misses.len().max(1) as f64;
    let mean: Vector2<f64> = misses.iter().map(|miss| miss.error_m).sum::<Vector2<f64>>() / count;
    let rms_m = (misses.iter().map(|miss| miss.error_m.norm_squared()).sum::<f64>() / count).sqrt();
    let mut distances: Vec<f64> = misses.iter().map(|miss| miss.error_m.norm()).collect();
    distances.sort_by(f64::total_cmp);
    let median_m = distances.get(distances.len() / 2).copied().unwrap_or_default();
    let mut scaled: Vec<f64> = misses
        .iter()
        .filter_map(|miss| Some(0.5 * miss.error_m.dot(&(miss.covariance.try_inverse()? * miss.error_m))))
        .collect();
    scaled.sort_by(f64::total_cmp);
    let ratio = (scaled.iter().sum::<f64>() / count).sqrt();
    // Half of the squared distances of two axes are below 2 ln 2.
    let robust = (scaled.get(scaled.len() / 2).copied().unwrap_or_default() / std::f64::consts::LN_2).sqrt();
    println!(
        "{} marks: {:.1} cm median, {:.1} cm rms, mean {:.1} and {:.1} cm; over stated sigma: {ratio:.2} rms, {robust:.2} by the median",
        misses.len(),
        100.0 * median_m,
        100.0 * rms_m,
        100.0 * mean.x,
        100.0 * mean.y
    );
}
