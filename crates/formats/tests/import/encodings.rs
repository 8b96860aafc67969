//! Encodings of pictures and numbers.

use glam::DVec3;
use image::{Rgb, RgbImage};
use mcap::Compression;

use super::{
    Ros, add_imu, assert_like,
    cdr::{Value, encode},
    import, import_bytes, import_file,
    log_writer::{Kind, Messages},
    options, pictures,
    robot::{self, IMAGE, SIZE, Truth, walk},
    with_imu,
};

const WIDTH: u32 = SIZE[0];
const HEIGHT: u32 = SIZE[1];

/// A picture of large even squares, so that colours at half the resolution are exact within them.
fn squares() -> RgbImage {
    let colors = [Rgb([200, 40, 60]), Rgb([30, 180, 90]), Rgb([60, 70, 210]), Rgb([220, 220, 220])];
    RgbImage::from_fn(WIDTH, HEIGHT, |x, y| colors[((x / 16 + y / 16) % 4) as usize])
}

/// Brightness and colours by ITU-R BT.601, from its definition.
fn yuv(Rgb([r, g, b]): Rgb<u8>) -> [u8; 3] {
    let [r, g, b] = [r, g, b].map(f64::from);
    let y = 16.0 + (65.481 * r + 128.553 * g + 24.966 * b) / 255.0;
    let u = 128.0 + (-37.797 * r - 74.203 * g + 112.0 * b) / 255.0;
    let v = 128.0 + (112.0 * r - 93.786 * g - 18.214 * b) / 255.0;
    [y, u, v].map(|value| value.round() as u8)
}

/// Returns the bytes of the picture in an encoding with `padding` unused bytes behind each row, and their step.
fn encoded(encoding: &str, padding: usize) -> (Vec<u8>, u32) {
    let picture = squares();
    let pixel = |x: u32, y: u32| *picture.get_pixel(x, y);
    let mut rows: Vec<Vec<u8>> = Vec::new();
    for y in 0..HEIGHT {
        let pixels = (0..WIDTH).map(|x| pixel(x, y));
        let pairs = (0..WIDTH).step_by(2).map(|x| (yuv(pixel(x, y)), yuv(pixel(x + 1, y))));
        rows.push(match encoding {
            "rgb8" => pixels.flat_map(|Rgb(p)| p).collect(),
            "bgr8" => pixels.flat_map(|Rgb([r, g, b])| [b, g, r]).collect(),
            "rgba8" => pixels.flat_map(|Rgb([r, g, b])| [r, g, b, 9]).collect(),
            "bgra8" => pixels.flat_map(|Rgb([r, g, b])| [b, g, r, 9]).collect(),
            "mono8" => pixels.map(|Rgb([_, g, _])| g).collect(),
            "yuv422" => pairs.flat_map(|([y0, u, v], [y1, ..])| [u, y0, v, y1]).collect(),
            "yuv422_yuy2" => pairs.flat_map(|([y0, u, v], [y1, ..])| [y0, u, y1, v]).collect(),
            "nv12" => pixels.map(|p| yuv(p)[0]).collect(),
            bayer => {
                let letters = &bayer.as_bytes()["bayer_".len()..];
                let channel = |x: u32| match letters[((y % 2) * 2 + x % 2) as usize] {
                    b'r' => 0,
                    b'g' => 1,
                    _ => 2,
                };
                (0..WIDTH).map(|x| pixel(x, y)[channel(x)]).collect()
            }
        });
    }
    if encoding == "nv12" {
        for y in (0..HEIGHT).step_by(2) {
            rows.push((0..WIDTH).step_by(2).flat_map(|x| yuv(pixel(x, y))[1..].to_vec()).collect());
        }
    }
    rows.iter_mut().for_each(|row| row.extend(vec![0; padding]));
    let step = rows[0].len() as u32;
    (rows.concat(), step)
}

fn raw_log(walk: &[Truth], encoding: &str, padding: usize) -> Messages {
    let mut messages = Messages::default();
    let (data, step) = encoded(encoding, padding);
    for truth in walk {
        let value = robot::raw(truth, "camera", encoding, step, data.clone());
        messages.ros("/image", "sensor_msgs/msg/Image", IMAGE, truth.time_ns, &value);
        let info = robot::camera_info(truth, "equidistant", &[0.1, 0.0, 0.0, 0.0], robot::MATRIX);
        messages.ros("/camera_info", "sensor_msgs/msg/CameraInfo", "", truth.time_ns, &info);
        add_imu(&mut messages, truth, &robot::imu(truth, "", Some(truth.level_from_body(0.0)), DVec3::ZERO));
    }
    messages
}

#[test]
fn raw_pictures_come_out_as_they_went_in() {
    let expected = squares();
    let encodings = [
        ("rgb8", 0),
        ("bgr8", 0),
        ("rgba8", 0),
        ("bgra8", 0),
        ("mono8", 0),
        ("yuv422", 3),
        ("yuv422_yuy2", 3),
        ("nv12", 3),
        ("bayer_rggb8", 0),
        ("bayer_bggr8", 0),
        ("bayer_gbrg8", 0),
        ("bayer_grbg8", 0),
    ];
    for (encoding, tolerance) in encodings {
        let imported = import(&raw_log(&walk(2), encoding, 5), &options()).unwrap();
        let picture = imported.sequence.load_image(1).unwrap();
        for (x, y, found) in picture.enumerate_pixels() {
            // At the squares' edges the other colours of a Bayer pixel are mixed.
            let is_inside = |at: u32| (1..15).contains(&(at % 16));
            if encoding.starts_with("bayer") && !(is_inside(x) && is_inside(y)) {
                continue;
            }
            let Rgb(wanted) = *expected.get_pixel(x, y);
            let wanted = if encoding == "mono8" { [wanted[1]; 3] } else { wanted };
            let is_near = found.0.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= tolerance);
            assert!(is_near, "{encoding} at {x}, {y}: {found:?}, not {wanted:?}");
        }
        assert_eq!(imported.report.camera_model, Some("OPENCV_FISHEYE"));
    }
}

#[test]
fn numbers_with_the_most_significant_byte_first_are_read() {
    let walk = walk(5);
    let mut messages = with_imu(&walk);
    for truth in &walk {
        let kind = Kind::cdr("nav_msgs/msg/Odometry", "");
        messages.add("/other_odom", &kind, truth.time_ns, encode(&robot::odometry(truth, "x"), true));
    }
    let options =
        reality_sim_formats::import::ImportOptions { odometry: Some("/other_odom".to_owned()), ..options() };
    assert_like(&import(&messages, &options).unwrap(), &walk);
}

#[test]
fn every_way_to_pack_a_log_gives_the_same() {
    let walk = walk(10);
    let messages = with_imu(&walk);
    for compression in [None, Some(Compression::Lz4), Some(Compression::Zstd)] {
        for chunk in [Some(1000), Some(1 << 20), None] {
            let imported = import_bytes(&messages.mcap(compression, chunk), &options()).unwrap();
            assert_like(&imported, &walk);
            assert!(!imported.report.salvaged && imported.report.bytes_lost == 0);
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.db3");
    messages.write_db3(&file);
    assert_like(&import_file(folder, &file, &options()).unwrap(), &walk);
}

#[test]
fn a_bag_in_several_files_is_one_log_packed_or_not() {
    let walk = walk(12);
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    std::fs::create_dir(&bag).unwrap();
    for (index, part) in walk.chunks(4).enumerate() {
        let bytes = with_imu(part).mcap(None, Some(1 << 16));
        if index == 1 {
            let packed = zstd::stream::encode_all(bytes.as_slice(), 1).unwrap();
            std::fs::write(bag.join("bag_1.mcap.zstd"), packed).unwrap();
        } else {
            std::fs::write(bag.join(format!("bag_{index}.mcap")), bytes).unwrap();
        }
    }
    assert_like(&import_file(folder, &bag, &options()).unwrap(), &walk);
}

#[test]
fn messages_are_told_by_their_fields_not_by_their_names() {
    let walk = walk(5);
    let mut messages = pictures(&walk, "camera", "base_link");
    for truth in &walk {
        let value = robot::imu(truth, "imu", Some(truth.level_from_body(0.0)), DVec3::ZERO);
        let definition = format!("{}\nuint8 temperature", robot::IMU);
        let value = Value::All(vec![value, Value::Byte(30)]);
        messages.ros("/torso", "my_robot_msgs/msg/Inertial", &definition, truth.time_ns, &value);
    }
    assert_like(&import(&messages, &options()).unwrap(), &walk);
}
