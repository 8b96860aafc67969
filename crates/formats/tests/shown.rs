//! What Foxglove is given, decoded again from the MCAP file and from the websocket; and the Parquet table.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{collections::BTreeMap, fs, path::Path};

use common::{Grey, a_pose, cameras, field, known_points, posed};
use foxglove::{
    Decode,
    messages::{
        CameraCalibration, CompressedImage, FrameTransform, ImageAnnotations, PosesInFrame, SceneUpdate,
    },
};
use glam::{DMat3, DQuat, DVec2, DVec3};
use reality_sim_formats::{
    PictureFiles,
    frame_table::{FrameTable, PictureFacts, PictureQuality, Values},
    show::{LogFile, Shot},
};

/// Returns the messages of a file by topic, with their log times.
fn messages(path: &Path) -> BTreeMap<String, Vec<(u64, Vec<u8>)>> {
    let bytes = fs::read(path).unwrap();
    let mut topics: BTreeMap<String, Vec<(u64, Vec<u8>)>> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let messages = topics.entry(message.channel.topic.clone()).or_default();
        messages.push((message.log_time, message.data.to_vec()));
    }
    topics
}

fn decode<T: Decode>(bytes: &[u8]) -> T
where
    T::Error: std::fmt::Debug,
{
    T::decode(bytes).unwrap()
}

#[test]
fn a_log_holds_every_topic_at_the_recordings_times_and_projects_as_the_core_does() {
    for camera in cameras() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.mcap");
        let picture = Grey.bytes(3).unwrap();
        let (field, particles) = (field(), [a_pose(), a_pose().mirrored()]);
        let log = LogFile::create(&path).unwrap();
        for timestamp_s in [100.25, 100.5] {
            let (pose, camera) = (a_pose(), &camera);
            log.log(&Shot {
                timestamp_s,
                picture: &picture,
                camera,
                field: &field,
                pose,
                particles: &particles,
            });
        }
        assert!(!path.exists(), "the file has its name before it is complete");
        log.finish().unwrap();
        let topics = messages(&path);
        for messages in topics.values() {
            let times: Vec<u64> = messages.iter().map(|(time, _)| *time).collect();
            assert_eq!(times, [100_250_000_000, 100_500_000_000]);
        }
        assert_eq!(topics.len(), 7);
        let first = |topic: &str| topics[topic][0].1.as_slice();
        let image: CompressedImage = decode(first("/camera/image"));
        assert_eq!((image.data.as_ref(), image.format.as_str()), (picture.as_slice(), "png"));
        assert_eq!(decode::<PosesInFrame>(first("/particles")).poses.len(), 2);
        let scene: SceneUpdate = decode(first("/field"));
        assert_eq!(scene.entities[0].lines.len(), field.curves().len());

        let calibration: CameraCalibration = decode(first("/camera/calibration"));
        let transform: FrameTransform = decode(first("/tf"));
        let exact = error_px(&calibration, &transform, &camera);
        assert!(exact < 1e-6, "{exact} px");
        check_annotations(&decode(first("/camera/lines")), &camera);
        check_classic_errors(&calibration, &transform, &camera);
    }
}

/// Projects known points by a calibration and a transform as Foxglove's documentation has it, and returns the largest distance
/// from the core's pixels.
fn error_px(
    calibration: &CameraCalibration,
    transform: &FrameTransform,
    camera: &reality_sim_core::camera::Camera,
) -> f64 {
    let (place, turn) = (transform.translation.unwrap(), transform.rotation.unwrap());
    let world_from_camera = DMat3::from_quat(DQuat::from_xyzw(turn.x, turn.y, turn.z, turn.w));
    let place = DVec3::new(place.x, place.y, place.z);
    let d = |index: usize| calibration.d[index];
    let pixel = |point: DVec3| {
        let p = world_from_camera.transpose() * (point - place);
        let (a, b) = if calibration.distortion_model == "kannala_brandt" {
            let r = p.x.hypot(p.y);
            let t = r.atan2(p.z);
            let bent = t * (1.0 + d(0) * t.powi(2) + d(1) * t.powi(4) + d(2) * t.powi(6) + d(3) * t.powi(8));
            (bent * p.x / r, bent * p.y / r)
        } else {
            if p.z <= 0.0 {
                return DVec2::INFINITY;
            }
            let (u, v) = (p.x / p.z, p.y / p.z);
            let s = u * u + v * v;
            let radial = 1.0 + d(0) * s + d(1) * s.powi(2) + d(4) * s.powi(3);
            (
                u * radial + 2.0 * d(2) * u * v + d(3) * (s + 2.0 * u * u),
                v * radial + d(2) * (s + 2.0 * v * v) + 2.0 * d(3) * u * v,
            )
        };
        let k = &calibration.k;
        DVec2::new(k[0] * a + k[2], k[4] * b + k[5])
    };
    let points = known_points(camera, a_pose());
    points.iter().map(|(point, seen)| pixel(*point).distance(*seen)).fold(0.0, f64::max)
}

fn check_classic_errors(
    calibration: &CameraCalibration,
    transform: &FrameTransform,
    camera: &reality_sim_core::camera::Camera,
) {
    let mut half = calibration.clone();
    half.k[2] += 0.5;
    half.k[5] += 0.5;
    let with_turn = |change: &dyn Fn(DQuat, DVec3) -> (DQuat, DVec3)| {
        let (place, turn) = (transform.translation.unwrap(), transform.rotation.unwrap());
        let (turn, place) =
            change(DQuat::from_xyzw(turn.x, turn.y, turn.z, turn.w), DVec3::new(place.x, place.y, place.z));
        let mut changed = transform.clone();
        let (rotation, translation) =
            (changed.rotation.as_mut().unwrap(), changed.translation.as_mut().unwrap());
        (rotation.x, rotation.y, rotation.z, rotation.w) = (turn.x, turn.y, turn.z, turn.w);
        (translation.x, translation.y, translation.z) = (place.x, place.y, place.z);
        error_px(calibration, &changed, camera)
    };
    let order = |turn: DQuat, place| (DQuat::from_xyzw(turn.w, turn.x, turn.y, turn.z), place);
    let flip = |turn: DQuat, place| (turn * DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0), place);
    let inverse = |turn: DQuat, place: DVec3| (turn.conjugate(), -(turn.conjugate() * place));
    for (name, error) in [
        ("half a pixel", error_px(&half, transform, camera)),
        ("quaternion order", with_turn(&order)),
        ("axis flip", with_turn(&flip)),
        ("inverse pose", with_turn(&inverse)),
    ] {
        assert!(error > 0.4, "{name}: {error} px");
    }
}

/// Every point of the drawn lines is half a pixel from where the core sees a line: there, the corner is the origin.
fn check_annotations(lines: &ImageAnnotations, camera: &reality_sim_core::camera::Camera) {
    let field = field();
    let mut points = 0;
    for point in lines.points.iter().flat_map(|line| &line.points) {
        let pixel = DVec2::new(point.x - 0.5, point.y - 0.5);
        let ground = camera.unproject_to_ground(a_pose(), pixel).unwrap();
        let distance_m = field.curves().iter().map(|curve| curve.distance_m(ground)).fold(f64::MAX, f64::min);
        assert!(distance_m < 1e-6, "{distance_m}");
        points += 1;
    }
    assert!(points > 10, "{points}");
}

#[test]
fn a_parquet_table_has_the_pictures_values_and_nulls_where_nothing_is_known() {
    use parquet::{
        file::reader::{FileReader, SerializedFileReader},
        record::Field,
    };
    let pictures = posed(&cameras()[0], &[a_pose(), a_pose().mirrored()]).pictures;
    let mut covariance = [[0.0; 6]; 6];
    covariance[0][0] = 0.04;
    covariance[0][2] = 0.01;
    let quality = Some(PictureQuality { brightness: 0.5, sharpness: 0.1 });
    let facts = [
        PictureFacts {
            sequence: "walk".to_owned(),
            image: "a.png".into(),
            covariance: Some(covariance),
            quality,
        },
        PictureFacts { sequence: "walk".to_owned(), image: "b.png".into(), ..PictureFacts::default() },
    ];
    let table = FrameTable::of_pictures(&pictures, &facts);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.parquet");
    table.write_parquet(&path).unwrap();

    let reader = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    let rows: Vec<BTreeMap<String, Field>> = reader
        .get_row_iter(None)
        .unwrap()
        .map(|row| {
            row.unwrap().get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect()
        })
        .collect();
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0]["timestamp_s"], Field::Double(100.25));
    assert_eq!(rows[1]["x_m"], Field::Double(1.3));
    assert_eq!(rows[0]["image"], Field::Str("a.png".to_owned()));
    assert_eq!(rows[0]["sigma_x_m"], Field::Double(0.2));
    assert_eq!(rows[0]["covariance_x_m_yaw_rad"], Field::Double(0.01));
    assert_eq!(rows[0]["brightness"], Field::Double(0.5));
    for unknown in ["covariance_x_m_x_m", "brightness", "sure", "particles", "lines_within_5px"] {
        assert_eq!(rows[1][unknown], Field::Null, "{unknown}");
    }
}

#[test]
fn details_keep_their_columns_and_unknown_ones_come_behind() {
    let text =
        "timestamp_s,x_m,sure,particles,sigma_x_m,quality_x\n0.1,1.5,true,800,,3\n0.2,2.5,false,,0.1,4\n";
    let table = FrameTable::parse_details(Path::new("frames.csv"), text).unwrap();
    assert_eq!(table.column("sure"), Some(&Values::Flags(vec![Some(true), Some(false)])));
    assert_eq!(table.column("particles"), Some(&Values::Counts(vec![Some(800), None])));
    assert_eq!(table.column("sigma_x_m"), Some(&Values::Numbers(vec![None, Some(0.1)])));
    assert_eq!(table.columns().last().unwrap().name, "quality_x");
    let error =
        FrameTable::parse_details(Path::new("frames.csv"), "timestamp_s,x_m\n0.1,1\n0.2,far\n").unwrap_err();
    assert!(error.to_string().starts_with("frames.csv, line 3: `x_m` is \"far\""), "{error}");
}

#[test]
fn brightness_and_sharpness_tell_dark_and_blurred_pictures_apart() {
    let stripes = |low: u8, high: u8, period: u32| {
        let picture = image::RgbImage::from_fn(32, 32, |u, _| {
            image::Rgb([if (u / period).is_multiple_of(2) { low } else { high }; 3])
        });
        PictureQuality::of(&picture)
    };
    assert!((stripes(0, 255, 1).brightness - 0.5).abs() < 1e-9);
    assert!(stripes(0, 255, 1).sharpness > stripes(0, 255, 4).sharpness);
    assert!(stripes(0, 128, 1).sharpness < stripes(0, 255, 1).sharpness);
    assert_eq!(stripes(7, 7, 1).sharpness, 0.0);
}
