//! Records of a picture and its annotations, and the file that brings all together.

use std::{
    fs,
    io::{self, BufWriter, Write},
};

use reality_sim_core::{
    camera::{Camera, ImageCircle},
    pose::CameraPose,
    sequence::write_atomically_with,
    warp::Origin,
};
use reality_sim_simulator::{
    Frame,
    coco::{SeenCrossingRecord, SeenLineRecord, annotations, categories, crossings, lines},
};
use serde::Serialize;
use serde_json::json;

use super::{
    DatasetError, DatasetSettings, DatasetSource,
    folder::{DatasetFolder, Part},
};

/// Record of a picture: COCO's keys, and those that it does not know.
#[derive(Serialize)]
struct ImageRecord<'a> {
    id: u32,
    file_name: String,
    width: u32,
    height: u32,
    mask: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    instances: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trust: Option<String>,
    pose: CameraPose,
    camera: CameraRecord<'a>,
    database: String,
    seed: u64,
    method: &'static str,
    /// Share of the pixels that recorded pictures show.
    covered: f64,
    /// Mean trust of the pixels, 0 to 1.
    trust_mean: f64,
    /// Distance of the nearest recorded picture that was used, root mean square pixels.
    nearest_px: Option<f64>,
    lines: Vec<SeenLineRecord>,
    crossings: Vec<SeenCrossingRecord>,
}

#[derive(Serialize)]
struct CameraRecord<'a> {
    model: &'a str,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    distortion: Vec<f64>,
    max_angle_rad: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    image_circle: Option<ImageCircle>,
}

impl<'a> CameraRecord<'a> {
    fn new(camera: &'a Camera) -> Self {
        Self {
            model: camera.distortion.colmap_name(),
            fx: camera.fx,
            fy: camera.fy,
            cx: camera.cx,
            cy: camera.cy,
            distortion: camera.distortion.parameters(),
            max_angle_rad: camera.max_angle_rad(),
            image_circle: camera.image_circle,
        }
    }
}

/// Returns the records of a picture: its own, and those of its annotations, a line each.
pub fn records(
    source: &DatasetSource,
    settings: &DatasetSettings,
    folder: &DatasetFolder,
    picture: u32,
    frame: &Frame,
) -> serde_json::Result<String> {
    let camera = source.synthesizer().camera();
    let if_wanted = |part| folder.has(part).then(|| folder.name(part, picture));
    let nearest_px = frame.used.iter().map(|used| used.distance_px).reduce(f64::min);
    let seen = frame.origins.iter().filter(|origin| origin.source != Origin::OUTSIDE).count().max(1);
    let trust: u64 = frame.labels.trust.iter().map(|trust| u64::from(*trust)).sum();
    let record = ImageRecord {
        id: picture,
        file_name: folder.name(Part::Image, picture),
        width: camera.width,
        height: camera.height,
        mask: folder.name(Part::Mask, picture),
        depth: if_wanted(Part::Depth),
        instances: if_wanted(Part::Instances),
        trust: if_wanted(Part::Trust),
        pose: frame.pose,
        camera: CameraRecord::new(camera),
        database: source.name(),
        seed: settings.seed,
        method: settings.method.name(),
        covered: to_thousandths(frame.covered),
        trust_mean: to_thousandths(trust as f64 / (f64::from(u8::MAX) * seen as f64)),
        nearest_px: nearest_px.map(to_thousandths),
        lines: lines(&frame.labels),
        crossings: crossings(&frame.labels),
    };
    let mut text = serde_json::to_string(&record)? + "\n";
    for annotation in annotations(&frame.labels, picture.into()) {
        text += &(serde_json::to_string(&annotation)? + "\n");
    }
    Ok(text)
}

fn to_thousandths(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}

/// Brings the records of all pictures together in one file, without holding them in memory. Returns the number of annotations.
pub fn write_annotations(
    source: &DatasetSource,
    settings: &DatasetSettings,
    folder: &DatasetFolder,
) -> Result<usize, DatasetError> {
    let info = json!({
        "description": format!("Pictures from {} at random poses", source.name()),
        "version": env!("CARGO_PKG_VERSION"),
        "seed": settings.seed,
    });
    let categories = json!(categories(source.synthesizer().archive().field()));
    let mut count = 0;
    write_atomically_with(&folder.annotations(), |file| {
        let mut file = BufWriter::new(file);
        write!(file, "{{\"info\":{info},\"licenses\":[],\"categories\":{categories},\"images\":[")?;
        for picture in 0..settings.count {
            let records = read(folder, picture)?;
            let image = records.lines().next().unwrap_or_default();
            write!(file, "{}\n{image}", if picture == 0 { "" } else { "," })?;
        }
        write!(file, "],\"annotations\":[")?;
        for picture in 0..settings.count {
            for annotation in read(folder, picture)?.lines().skip(1) {
                write!(file, "{}\n{annotation}", if count == 0 { "" } else { "," })?;
                count += 1;
            }
        }
        write!(file, "]}}")?;
        writeln!(file)?;
        file.flush()
    })?;
    Ok(count)
}

fn read(folder: &DatasetFolder, picture: u32) -> io::Result<String> {
    let path = folder.file(Part::Records, picture);
    fs::read_to_string(&path)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))
}
