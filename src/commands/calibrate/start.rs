//! What a calibration starts from: the sequence's own camera if it can be used, or a guess of the field of view.

use std::path::Path;

use anyhow::Context;
use glam::DVec2;
use image::ImageReader;

use reality_sim::{
    Camera, Sequence,
    calibration::{LensModel, Trusted},
    camera::Distortion,
    sequence::{CameraSetup, Mounting, SequenceError, read_mounting},
};

use super::options::CalibrateArgs;

/// Field of view of a wide lens and of a usual one if nothing is said of it, degrees.
const WIDE_DEG: f64 = 150.0;
const USUAL_DEG: f64 = 60.0;

/// Field of view from which a lens is taken for a fisheye, degrees: usual lenses have less.
const FISHEYE_FROM_DEG: f64 = 100.0;

/// Height at which nothing is known of a camera, metres; it is replaced by what the pictures show.
const ANY_HEIGHT_M: f64 = 0.5;

/// Sequence with the camera from which the calibration starts.
pub struct Start {
    pub sequence: Sequence,
    pub trusted: Trusted,
    /// Where the camera is against what the files state, by the old camera file, which the sequence contains already.
    pub mounting: Mounting,
    /// What the calibration starts from, in words.
    pub words: String,
}

impl Start {
    pub fn read(args: &CalibrateArgs) -> anyhow::Result<Self> {
        let folder = args.sequence.as_path();
        match Sequence::open(folder) {
            Ok(sequence) => {
                let own = LensModel::of(&sequence.setup.camera.distortion);
                let keeps_lens = args.fov_deg.is_none() && args.model.is_none_or(|model| model == own);
                if keeps_lens { Self::of_file(folder, sequence) } else { Self::of_guess(args, Ok(sequence)) }
            }
            Err(error) if is_of_camera(folder, &error) => match lens_alone(&error.path) {
                Some(setup) if args.fov_deg.is_none() && args.model.is_none() => Self::of_lens(folder, setup),
                _ => Self::of_guess(args, Err(error)),
            },
            Err(error) => Err(error.into()),
        }
    }

    fn of_file(folder: &Path, sequence: Sequence) -> anyhow::Result<Self> {
        let file = Sequence::camera_file(folder)?;
        let words = format!("the camera in {}", file.display());
        let mounting = read_mounting(&file)?;
        Ok(Self { sequence, trusted: Trusted { lens: true, height: true }, mounting, words })
    }

    /// Starts from a lens whose height is not known.
    fn of_lens(folder: &Path, setup: CameraSetup) -> anyhow::Result<Self> {
        let words =
            format!("the lens in {}; its height is not known", Sequence::camera_file(folder)?.display());
        let sequence = Sequence::open_with_setup(folder, setup)?;
        let trusted = Trusted { lens: true, height: false };
        Ok(Self { sequence, trusted, mounting: Mounting::default(), words })
    }

    /// Starts from a guess of the field of view; the height and the image circle of a camera that can be read are kept.
    fn of_guess(args: &CalibrateArgs, own: Result<Sequence, SequenceError>) -> anyhow::Result<Self> {
        let (known, why) = match own {
            Ok(sequence) => (Some(sequence.setup), None),
            Err(error) => (None, Some(error.to_string())),
        };
        let fov_deg = args.fov_deg.or_else(|| Some(field_of_view_deg(&known.as_ref()?.camera)));
        let own_model = known.as_ref().map(|setup| LensModel::of(&setup.camera.distortion));
        let by_angle = match fov_deg.is_none_or(|fov_deg| fov_deg >= FISHEYE_FROM_DEG) {
            true => LensModel::OpencvFisheye,
            false => LensModel::Opencv,
        };
        let model = args.model.or(own_model).unwrap_or(by_angle);
        let default_deg = if model == LensModel::OpencvFisheye { WIDE_DEG } else { USUAL_DEG };
        let fov_deg = fov_deg.unwrap_or(default_deg);

        let mut sequence = Sequence::open_with_setup(&args.sequence, placeholder()?)?;
        let camera = model.camera(size_of_pictures(&sequence)?, fov_deg)?;
        let image_circle = known.as_ref().and_then(|setup| setup.camera.image_circle);
        sequence.setup = CameraSetup {
            camera: camera.with_image_circle(image_circle),
            mount_height_m: known.as_ref().map_or(ANY_HEIGHT_M, |setup| setup.mount_height_m),
            photometry: known.as_ref().and_then(|setup| setup.photometry),
        };
        let trusted = Trusted { lens: false, height: known.is_some() };
        let why = why.map_or_else(String::new, |why| format!(", as {why}"));
        let words = format!("a guess of {fov_deg:.0}° across the picture, {}{why}", model.name());
        Ok(Self { sequence, trusted, mounting: Mounting::default(), words })
    }
}

/// Returns whether an error is of the sequence's camera file.
fn is_of_camera(folder: &Path, error: &SequenceError) -> bool {
    Sequence::camera_file(folder).is_ok_and(|file| file == error.path)
}

/// Reads a camera file that lacks nothing but the table of the mount.
fn lens_alone(file: &Path) -> Option<CameraSetup> {
    let text = std::fs::read_to_string(file).ok()?;
    CameraSetup::from_toml(file, &format!("{text}\n[mount]\nheight_m = {ANY_HEIGHT_M}\n")).ok()
}

/// Returns the angle between the rays at the middles of the picture's left and right edges, degrees.
fn field_of_view_deg(camera: &Camera) -> f64 {
    let angle = |u: f64| {
        let ray = camera.unproject(DVec2::new(u, camera.cy)).ok()?;
        Some(ray.truncate().length().atan2(ray.z).to_degrees())
    };
    let sides = [0.0, f64::from(camera.width) - 1.0].map(|u| angle(u).unwrap_or(0.5 * WIDE_DEG));
    sides[0] + sides[1]
}

/// Returns a camera with which the other files of a sequence can be read.
fn placeholder() -> anyhow::Result<CameraSetup> {
    let camera = Camera::new([1, 1], [1.0, 1.0, 0.0, 0.0], Distortion::Pinhole)?;
    Ok(CameraSetup { camera, mount_height_m: ANY_HEIGHT_M, photometry: None })
}

fn size_of_pictures(sequence: &Sequence) -> anyhow::Result<[u32; 2]> {
    let path = sequence.image_path(0)?;
    let name = path.display();
    let reader = ImageReader::open(&path).and_then(ImageReader::with_guessed_format);
    let reader = reader.with_context(|| format!("{name}: cannot be read: put the picture there"))?;
    let size = reader.into_dimensions();
    let (width, height) =
        size.with_context(|| format!("{name}: is not a picture that can be read: use a JPEG or PNG"))?;
    Ok([width, height])
}
