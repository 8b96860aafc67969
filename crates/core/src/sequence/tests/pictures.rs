//! Tests of pictures: formats, sizes, damage, hostile headers.

use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb};

use super::*;

/// Makes a valid recording whose first picture has these bytes.
fn with_picture(bytes: &[u8]) -> (TempDir, Sequence) {
    let folder = valid_folder();
    fs::create_dir(folder.path().join("images")).unwrap();
    fs::write(folder.path().join("images/0.png"), bytes).unwrap();
    let sequence = Sequence::open(folder.path()).unwrap();
    (folder, sequence)
}

fn encode(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn sample(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| Rgb([(16 * x) as u8, (20 * y) as u8, (x * y) as u8]))
}

fn refuses(bytes: &[u8], parts: &[&str]) {
    let (folder, sequence) = with_picture(bytes);
    let error = sequence.load_image(0).expect_err(&format!("accepted: {parts:?}"));
    assert_message(&error, &folder.path().join("images/0.png"), parts);
}

/// Returns a PNG with this header and no pixels.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = encode(&sample(2, 2).into(), ImageFormat::Png);
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = bytes[12..29].iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
    });
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}

#[test]
fn jpeg_and_png_are_told_apart_by_their_content() {
    let (_folder, sequence) = with_picture(&encode(&sample(16, 12).into(), ImageFormat::Png));
    assert_eq!(sequence.load_image(0).unwrap(), sample(16, 12));
    let (_folder, sequence) = with_picture(&encode(&sample(16, 12).into(), ImageFormat::Jpeg));
    assert_eq!(sequence.load_image(0).unwrap().dimensions(), (16, 12));
}

#[test]
fn the_bytes_of_a_picture_are_those_of_its_file_and_checked() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        let bytes = encode(&sample(16, 12).into(), format);
        let (_folder, sequence) = with_picture(&bytes);
        assert_eq!(sequence.image_bytes(0).unwrap(), bytes);
    }
    let bytes = encode(&sample(12, 16).into(), ImageFormat::Png);
    let (folder, sequence) = with_picture(&bytes);
    let path = folder.path().join("images/0.png");
    assert_message(&sequence.image_bytes(0).unwrap_err(), &path, &["12 x 16 pixels and the camera 16 x 12"]);
    fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    assert_message(&sequence.image_bytes(0).unwrap_err(), &path, &["cut off"]);
}

#[test]
fn grey_and_transparent_pictures_become_rgb() {
    let grey = GrayImage::from_pixel(16, 12, Luma([77]));
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        let (_folder, sequence) = with_picture(&encode(&grey.clone().into(), format));
        assert_eq!(sequence.load_image(0).unwrap().get_pixel(3, 3), &Rgb([77; 3]));
    }
    for picture in [
        DynamicImage::from(sample(16, 12)).into_rgba8().into(),
        DynamicImage::from(sample(16, 12)).into_rgb16().into(),
    ] {
        let (_folder, sequence) = with_picture(&encode(&picture, ImageFormat::Png));
        assert_eq!(sequence.load_image(0).unwrap(), sample(16, 12));
    }
}

#[test]
fn missing_picture_and_missing_frame() {
    let folder = valid_folder();
    let sequence = Sequence::open(folder.path()).unwrap();
    let missing = folder.path().join("images/1.png");
    assert_message(&sequence.load_image(1).unwrap_err(), &missing, &["no such file"]);
    assert_message(&sequence.load_image(3).unwrap_err(), folder.path(), &["no frame 3", "has 3"]);
    assert_message(&sequence.load_image(usize::MAX).unwrap_err(), folder.path(), &["no frame"]);
}

#[test]
fn unknown_format() {
    refuses(b"", &["neither a JPEG nor a PNG"]);
    refuses(b"hello", &["neither a JPEG nor a PNG"]);
    refuses(b"GIF89a\x10\0\x0c\0\0\0\0", &["neither a JPEG nor a PNG"]);
    refuses(b"BM\x10\0\0\0\0\0\0\0\x36\0\0\0", &["neither a JPEG nor a PNG"]);
}

#[test]
fn every_truncation_is_noticed() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        let bytes = encode(&sample(16, 12).into(), format);
        for length in 0..bytes.len() {
            let decoded = picture::decode_picture(&bytes[..length], [16, 12]);
            assert!(decoded.is_err(), "{format:?}: {length} of {} bytes were accepted", bytes.len());
        }
    }
    let jpeg = encode(&sample(16, 12).into(), ImageFormat::Jpeg);
    refuses(&jpeg[..jpeg.len() - 20], &["cut off"]);
    let png = encode(&sample(16, 12).into(), ImageFormat::Png);
    refuses(&png[..png.len() - 30], &["cut off"]);
}

#[test]
fn damaged_picture() {
    let mut png = encode(&sample(16, 12).into(), ImageFormat::Png);
    png[45] ^= 0xff;
    refuses(&png, &["cannot be decoded"]);
}

#[test]
fn wrong_size() {
    let picture = encode(&sample(12, 16).into(), ImageFormat::Png);
    refuses(&picture, &["12 x 16 pixels and the camera 16 x 12"]);
}

#[test]
fn hostile_header_allocates_nothing() {
    refuses(&png_header(2_000_000_000, 2_000_000_000), &["picture"]);
    let bytes = png_header(32768, 32768);
    assert!(matches!(picture::decode_picture(&bytes, [32768, 32768]), Err(Fault::ImageTooLarge { .. })));
    let mut jpeg = encode(&sample(16, 12).into(), ImageFormat::Jpeg);
    let frame = jpeg.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    jpeg[frame + 5..frame + 9].fill(0xff);
    refuses(&jpeg, &["65535 x 65535"]);
    assert!(matches!(picture::decode_picture(&jpeg, [65535, 65535]), Err(Fault::ImageTooLarge { .. })));
}

#[test]
fn pictures_are_saved_and_copied() {
    let (folder, sequence) = with_picture(&encode(&sample(16, 12).into(), ImageFormat::Png));
    let copy = tempfile::tempdir().unwrap();
    sequence.write(copy.path()).unwrap();
    sequence.copy_image(0, copy.path()).unwrap();
    save_image(&copy.path().join("images/1.png"), &sample(16, 12)).unwrap();
    save_image(&copy.path().join("images/2.png"), &sample(12, 16)).unwrap();
    let again = Sequence::open(copy.path()).unwrap();
    assert_eq!(again.load_image(0).unwrap(), sample(16, 12));
    assert_eq!(again.load_image(1).unwrap(), sample(16, 12));
    save_image(&folder.path().join("a.jpg"), &sample(16, 12)).unwrap();
    let odd = folder.path().join("a.txt");
    assert_message(&save_image(&odd, &sample(2, 2)).unwrap_err(), &odd, &["neither a JPEG nor a PNG"]);
}
