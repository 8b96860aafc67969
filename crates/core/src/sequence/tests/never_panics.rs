//! Any bytes give a value or a message of one line, never a panic. `PROPTEST_CASES` sets how many cases are tried.

use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder};
use proptest::prelude::*;

use super::*;

/// Bytes and words that mean something to one of the parsers.
const PIECES: [&[u8]; 24] = [
    b"nan",
    b"-inf",
    b"1e999",
    b"-1",
    b"0",
    b"99999999999999999999",
    b"\"",
    b"\"\"\"",
    b"'",
    b"#",
    b"[",
    b"]",
    b"{",
    b"=",
    b",",
    b"..",
    b"\n",
    b"\r\n",
    b"\r",
    b"\0",
    b"\xff",
    "\u{feff}".as_bytes(),
    "\u{2028}".as_bytes(),
    b" ",
];

/// One change of a file.
#[derive(Debug, Clone)]
enum Change {
    Byte(prop::sample::Index, u8),
    Insert(prop::sample::Index, &'static [u8]),
    Delete(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
}

fn any_change() -> impl Strategy<Value = Change> {
    let place = any::<prop::sample::Index>;
    prop_oneof![
        (place(), any::<u8>()).prop_map(|(place, byte)| Change::Byte(place, byte)),
        (place(), prop::sample::select(PIECES.to_vec())).prop_map(|(at, piece)| Change::Insert(at, piece)),
        (place(), 1..40_usize).prop_map(|(place, count)| Change::Delete(place, count)),
        (place(), 1..40_usize).prop_map(|(place, count)| Change::Repeat(place, count)),
    ]
}

fn changed(valid: &[u8], changes: &[Change]) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for change in changes {
        let end = |start: usize, count: usize| (start + count).min(bytes.len());
        match change {
            _ if bytes.is_empty() => {}
            Change::Byte(place, byte) => *place.get_mut(&mut bytes) = *byte,
            Change::Insert(place, piece) => {
                let at = place.index(bytes.len());
                bytes.splice(at..at, piece.iter().copied());
            }
            Change::Delete(place, count) => {
                let start = place.index(bytes.len());
                bytes.drain(start..end(start, *count));
            }
            Change::Repeat(place, count) => {
                let start = place.index(bytes.len());
                let piece = bytes[start..end(start, *count)].to_vec();
                bytes.splice(start..start, piece);
            }
        }
    }
    bytes
}

fn parse<T>(bytes: &[u8], parser: impl FnOnce(&Path, &str) -> Result<T, SequenceError>) -> Option<T> {
    let path = Path::new("file");
    let result = text::decode(path, bytes).and_then(|text| parser(path, text));
    if let Err(error) = &result {
        let message = error.to_string();
        assert!(message.starts_with("file") && message.lines().count() == 1, "{message:?}");
        let last = bytes.iter().filter(|&&byte| byte == b'\n').count() + 1;
        assert!(error.line.is_none_or(|line| (1..=last).contains(&line)), "{message:?}");
    }
    result.ok()
}

/// Runs every reader of text, and writes and reads again what it made of the bytes.
fn read_all(bytes: &[u8]) {
    let path = Path::new("file");
    if let Some(table) = parse(bytes, parse_sequence) {
        let text = toml_text::print(path, &table).unwrap();
        assert_eq!(parse_sequence(path, &text).unwrap(), table);
    }
    if let Some(setup) = parse(bytes, CameraSetup::from_toml) {
        let text = setup.to_toml(path).unwrap();
        assert_eq!(CameraSetup::from_toml(path, &text).unwrap(), setup);
    }
    if let Some(field) = parse(bytes, FieldDimensions::from_toml) {
        let text = toml_text::print(path, &field).unwrap();
        assert_eq!(FieldDimensions::from_toml(path, &text).unwrap(), field);
    }
    let frames = parse(bytes, parse_frames);
    if let Some(frames) = &frames {
        let text = frames::print_frames(path, frames).unwrap();
        assert_eq!(&parse_frames(path, &text).unwrap(), frames);
    }
    if let Some(poses) = parse(bytes, tum::parse_tum) {
        assert!(poses.iter().all(|stamped| stamped.pose.is_finite()));
        assert_eq!(tum::parse_tum(path, &tum::print_tum(path, &poses).unwrap()).unwrap().len(), poses.len());
        let frames = parse_frames(path, FRAMES).unwrap();
        let _ = match_poses(path, poses, &frames);
    }
}

fn decode(bytes: &[u8]) {
    match picture::decode_picture(bytes, [16, 12]) {
        Ok(picture) => assert_eq!(picture.dimensions(), (16, 12)),
        Err(fault) => assert_eq!(fault.to_string().lines().count(), 1),
    }
}

fn jpeg() -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels: Vec<u8> = (0..16 * 12 * 3).map(|value| (value * 7 % 256) as u8).collect();
    JpegEncoder::new(&mut bytes).write_image(&pixels, 16, 12, ExtendedColorType::Rgb8).unwrap();
    bytes
}

fn png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels: Vec<u8> = (0..16 * 12 * 3).map(|value| (value * 7 % 256) as u8).collect();
    PngEncoder::new(&mut bytes).write_image(&pixels, 16, 12, ExtendedColorType::Rgb8).unwrap();
    bytes
}

proptest! {
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read_all(&bytes);
        decode(&bytes);
    }

    #[test]
    fn any_text(text in "\\PC{0,200}") {
        read_all(text.as_bytes());
    }

    #[test]
    fn changed_files(
        valid in prop::sample::select(vec![SEQUENCE, CAMERA, FIELD, FRAMES, GROUNDTRUTH]),
        changes in prop::collection::vec(any_change(), 1..5),
    ) {
        read_all(&changed(valid.as_bytes(), &changes));
    }

    #[test]
    fn changed_pictures(is_png in any::<bool>(), changes in prop::collection::vec(any_change(), 1..5)) {
        let valid = if is_png { png() } else { jpeg() };
        decode(&changed(&valid, &changes));
    }
}

#[test]
fn deep_nesting_does_not_overflow_the_stack() {
    for (open, close) in [("[", "]"), ("{a=", "}")] {
        let text = format!("x = {}{}", open.repeat(100_000), close.repeat(100_000));
        read_all(text.as_bytes());
    }
    read_all(format!("x{} = 1", ".x".repeat(100_000)).as_bytes());
}
