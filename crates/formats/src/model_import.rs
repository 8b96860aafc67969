//! Models of others as recordings with reference poses.

use std::path::{Path, PathBuf};

use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::CameraPose,
    sequence::{CameraSetup, FrameRecord, Sequence, check_image, counted, write_atomically},
    statistics::median,
};

use crate::{
    file::{MAX_PICTURE_BYTES, read_bytes},
    model_error::{ModelError, ModelFault},
    posed::IMAGES,
};

/// Heights that a robot's camera can have over a carpet, metres.
const POSSIBLE_HEIGHTS_M: std::ops::RangeInclusive<f64> = 0.02..=20.0;

/// Heights outside of which a camera is on no robot that plays, metres; they are warned of.
const USUAL_HEIGHTS_M: std::ops::RangeInclusive<f64> = 0.2..=2.5;

/// Distance beyond the carpet's edge at which cameras may still be, metres.
const BESIDE_CARPET_M: f64 = 5.0;

/// Roll beyond which a camera is upside down rather than tilted, radians.
const LARGEST_ROLL_RAD: f64 = std::f64::consts::FRAC_PI_2;

/// Number of different cameras up to which they are counted.
const MOST_CAMERAS: usize = 100;

/// What a model lacks that a recording has.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelImport {
    /// Name of the recording.
    pub name: String,
    /// Field on which the pictures were taken.
    pub field: FieldDimensions,
    /// Folder of the pictures, where it is not the model's own.
    pub images: Option<PathBuf>,
    /// Pictures a second, where the model does not have their times.
    pub rate_hz: f64,
}

impl ModelImport {
    /// Makes the options of a recording on this field, with ten pictures a second.
    pub fn new(name: &str, field: FieldDimensions) -> Self {
        Self { name: name.to_owned(), field, images: None, rate_hz: 10.0 }
    }
}

/// What was read from a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelImportReport {
    /// Number of frames.
    pub frames: usize,
    /// Whether the times are the model's; otherwise they were made up from the rate.
    pub has_times: bool,
    /// What is unusual about the poses, a sentence each.
    pub warnings: Vec<String>,
}

/// Picture of a model.
#[derive(Debug, Clone)]
pub(crate) struct ForeignPicture {
    /// File of the picture.
    pub file: PathBuf,
    /// Name in the model, by which pictures without times are sorted.
    pub name: String,
    /// Time, seconds, if the model has it.
    pub timestamp_s: Option<f64>,
    /// Pose of the camera.
    pub pose: CameraPose,
}

/// Model of others, with our conventions.
#[derive(Debug, Clone)]
pub(crate) struct ForeignModel {
    path: PathBuf,
    /// Different cameras of the pictures so far.
    cameras: Vec<Camera>,
    pub pictures: Vec<ForeignPicture>,
}

impl ForeignModel {
    /// Makes a model that is read from a path.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), cameras: Vec::new(), pictures: Vec::new() }
    }

    /// Notes a camera of pictures. More than one are refused later: then it does not matter how many more there are.
    pub fn add_camera(&mut self, camera: Camera) {
        if self.cameras.len() < MOST_CAMERAS && !self.cameras.contains(&camera) {
            self.cameras.push(camera);
        }
    }

    fn fail(&self, fault: ModelFault) -> ModelError {
        ModelError::of_file(&self.path, fault)
    }

    /// Writes the model as a recording: reference poses, their planar parts as odometry, pitch and roll from them, and the median
    /// height as that of the mount.
    pub fn write(mut self, out: &Path, options: &ModelImport) -> Result<ModelImportReport, ModelError> {
        let camera = match self.cameras.as_slice() {
            [camera] => camera.clone(),
            [] => return Err(self.fail(ModelFault::NothingThere { what: "picture with a pose" })),
            cameras => return Err(self.fail(ModelFault::SeveralCameras { count: cameras.len() })),
        };
        self.check_poses()?;
        let warnings = self.warnings(&options.field);
        let has_times = self.sort(options.rate_hz);
        let mount_height_m = self.median_height_m();
        let mut frames = Vec::with_capacity(self.pictures.len());
        for (index, picture) in self.pictures.iter().enumerate() {
            let image = copy_picture(&picture.file, index, &camera, out)?;
            frames.push(frame(picture, image, index, options.rate_hz));
        }
        let sequence = Sequence {
            folder: out.to_path_buf(),
            files: Vec::new(),
            name: options.name.clone(),
            setup: CameraSetup { camera, mount_height_m, photometry: None },
            field: options.field.clone(),
            start: self.pictures.first().map(|picture| picture.pose.planar()),
            frames,
            poses_between_frames: Vec::new(),
            calibration: None,
            corrected_by: None,
        };
        sequence.write(out)?;
        Ok(ModelImportReport { frames: self.pictures.len(), has_times, warnings })
    }

    /// Sorts the pictures by time, or by name if the times of some are unknown or doubled. Returns whether the times are known.
    fn sort(&mut self, rate_hz: f64) -> bool {
        let mut times: Option<Vec<f64>> = self.pictures.iter().map(|picture| picture.timestamp_s).collect();
        if let Some(times) = &mut times {
            times.sort_by(f64::total_cmp);
        }
        let has_times = times.is_some_and(|times| times.windows(2).all(|pair| pair[0] < pair[1]));
        if has_times {
            let time = |picture: &ForeignPicture| picture.timestamp_s.unwrap_or(0.0);
            self.pictures.sort_by(|a, b| time(a).total_cmp(&time(b)));
        } else {
            self.pictures.sort_by(|a, b| a.name.cmp(&b.name));
            for (index, picture) in self.pictures.iter_mut().enumerate() {
                picture.timestamp_s = Some(index as f64 / rate_hz);
            }
        }
        has_times
    }

    fn median_height_m(&self) -> f64 {
        median(self.pictures.iter().map(|picture| picture.pose.height_m))
    }

    /// Refuses poses that no camera over a field has.
    fn check_poses(&self) -> Result<(), ModelError> {
        let is_impossible = |picture: &&ForeignPicture| {
            !picture.pose.is_possible() || !POSSIBLE_HEIGHTS_M.contains(&picture.pose.height_m)
        };
        let impossible = self.pictures.iter().filter(is_impossible).count();
        if impossible > 0 {
            let (count, height_m) = (self.pictures.len(), self.median_height_m());
            let what = format!(
                "{impossible} of its {} are at a height that no camera over a field has (median {height_m:.3})",
                counted(count, "picture")
            );
            return Err(self.fail(ModelFault::NotAligned { what }));
        }
        let roll_rad = median(self.pictures.iter().map(|picture| picture.pose.roll_rad.abs()));
        if roll_rad > LARGEST_ROLL_RAD {
            let what = format!("its cameras are upside down (roll {:.0}°)", roll_rad.to_degrees());
            return Err(self.fail(ModelFault::NotAligned { what }));
        }
        Ok(())
    }

    /// Returns what is possible, but unusual.
    fn warnings(&self, field: &FieldDimensions) -> Vec<String> {
        let mut warnings = Vec::new();
        let height_m = self.median_height_m();
        if !USUAL_HEIGHTS_M.contains(&height_m) {
            warnings.push(format!(
                "the cameras are {height_m:.2} m high in the median: check that the model is in metres"
            ));
        }
        let extent_m = field.carpet_half_extent_m() + BESIDE_CARPET_M;
        let is_far = |picture: &&ForeignPicture| {
            picture.pose.x_m.abs() > extent_m.x || picture.pose.y_m.abs() > extent_m.y
        };
        let far = self.pictures.iter().filter(is_far).count();
        if far > 0 {
            warnings.push(format!(
                "{} are more than {BESIDE_CARPET_M:.0} m beside the carpet: check that the origin is the field's centre",
                counted(far, "picture")
            ));
        }
        let pitch_rad = median(self.pictures.iter().map(|picture| picture.pose.pitch_rad));
        if pitch_rad < 0.0 {
            warnings.push("most cameras look above the horizon: check that z points up".to_owned());
        }
        warnings
    }
}

fn frame(picture: &ForeignPicture, image: PathBuf, index: usize, rate_hz: f64) -> FrameRecord {
    FrameRecord {
        timestamp_s: picture.timestamp_s.unwrap_or(index as f64 / rate_hz),
        image,
        odometry: Some(picture.pose.planar()),
        pitch_rad: picture.pose.pitch_rad,
        roll_rad: picture.pose.roll_rad,
        reference_pose: Some(picture.pose),
    }
}

/// Copies a picture unchanged, after it has been decoded once. Returns its name in the recording.
fn copy_picture(file: &Path, index: usize, camera: &Camera, out: &Path) -> Result<PathBuf, ModelError> {
    let bytes = read_bytes(file, MAX_PICTURE_BYTES)?;
    check_image(file, &bytes, [camera.width, camera.height])?;
    let ending = match image::guess_format(&bytes) {
        Ok(image::ImageFormat::Png) => "png",
        _ => "jpg",
    };
    let name = Path::new(IMAGES).join(format!("{index:06}.{ending}"));
    let folder = out.join(IMAGES);
    std::fs::create_dir_all(&folder)
        .map_err(|error| ModelError::of_file(&folder, ModelFault::Unwritable(error)))?;
    write_atomically(&out.join(&name), &bytes)?;
    Ok(name)
}
