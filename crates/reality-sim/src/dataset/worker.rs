//! One picture after the other.

use std::{io::Cursor, path::Path};

use image::{EncodableLayout, ImageBuffer, ImageFormat, Luma, Pixel, PixelWithColorType};
use reality_sim_core::sequence::{save_image, write_atomically};
use reality_sim_simulator::{Camera, Frame, Layer};

use super::{
    DatasetError, DatasetSettings, DatasetSource,
    folder::{DatasetFolder, Part},
    poses::Poses,
    records::records,
    things::Things,
};

/// Number of pictures that the camera may refuse, because recorded pictures show too little of them, before one is given up.
const MOST_REFUSALS: u32 = 200;

/// What all threads share.
pub struct Task<'a> {
    pub source: &'a DatasetSource,
    pub settings: &'a DatasetSettings,
    pub folder: &'a DatasetFolder,
    pub poses: Poses<'a>,
    pub things: Things<'a>,
}

/// Camera of one thread.
pub struct Worker<'a> {
    task: &'a Task<'a>,
    camera: Camera,
    frame: Frame,
}

impl<'a> Worker<'a> {
    /// Makes a worker with a camera of its own.
    pub fn new(task: &'a Task<'a>, camera: &Camera) -> Self {
        Self { task, camera: camera.clone(), frame: Frame::default() }
    }

    /// Makes a picture and writes its files, the records last.
    pub fn make(&mut self, picture: u32) -> Result<(), DatasetError> {
        self.look(picture)?;
        let Self { task: Task { source, settings, folder, .. }, frame, .. } = self;
        folder.begin()?;
        save_image(&folder.file(Part::Image, picture), &frame.picture)?;
        write_png(&folder.file(Part::Mask, picture), &frame.labels.class_picture())?;
        if folder.has(Part::Depth) {
            write_png(&folder.file(Part::Depth, picture), &frame.labels.distance_picture())?;
        }
        if folder.has(Part::Instances) {
            write_png(&folder.file(Part::Instances, picture), &frame.labels.instance_picture())?;
        }
        if folder.has(Part::Trust) {
            write_png(&folder.file(Part::Trust, picture), &frame.labels.trust_picture())?;
        }
        let records = records(source, settings, folder, picture, frame)
            .map_err(|cause| DatasetError::Records { picture, cause })?;
        Ok(write_atomically(&folder.file(Part::Records, picture), records.as_bytes())?)
    }

    /// Looks from the first pose of those drawn for the picture at which there is one.
    fn look(&mut self, picture: u32) -> Result<(), DatasetError> {
        let Task { source, poses, things, .. } = self.task;
        let database = || source.database().to_path_buf();
        let mut after = 0;
        for _ in 0..MOST_REFUSALS {
            let Some(drawn) = poses.draw(picture, after) else {
                let within_px = poses.within_px;
                return Err(DatasetError::NothingNear { database: database(), picture, within_px });
            };
            after = drawn.before + 1;
            let things = things.draw(picture, drawn.pose);
            let layers: Vec<&dyn Layer> = things.iter().map(AsRef::as_ref).collect();
            self.camera.set_time_s(drawn.timestamp_s);
            match self.camera.look(drawn.pose, &layers, &mut self.frame) {
                Ok(()) => return Ok(()),
                Err(error) if error.is_refusal() => {}
                Err(error) => return Err(error.into()),
            }
        }
        Err(DatasetError::TooLittleSeen { database: database(), picture, poses: MOST_REFUSALS })
    }
}

/// Writes a picture of numbers as PNG.
fn write_png<T>(path: &Path, picture: &ImageBuffer<Luma<T>, Vec<T>>) -> Result<(), DatasetError>
where
    Luma<T>: Pixel<Subpixel = T> + PixelWithColorType,
    [T]: EncodableLayout,
{
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|cause| DatasetError::Encoding { file: path.to_path_buf(), cause })?;
    Ok(write_atomically(path, bytes.get_ref())?)
}
