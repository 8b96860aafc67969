//! Pictures of a sequence: decoding within limits, encoding, copying.

use std::{fs, io::Cursor, path::Path};

use image::{
    DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, ImageFormat, ImageReader,
    Limits, RgbImage, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder, error::UnsupportedErrorKind,
};

use super::{
    atomic::write_atomically,
    error::{Fault, SequenceError},
    format_error::FormatError,
    text::read_bytes,
};

/// Maximum size of a picture file, and of the memory for decoding it, bytes.
const MAX_PICTURE_BYTES: u64 = 512 << 20;

/// Quality of written JPEG files: nearly lossless at edges.
const JPEG_QUALITY: u8 = 95;

/// Reads a JPEG or PNG picture of this size, pixels; grey pictures become RGB, transparency is dropped.
pub(super) fn load_picture(path: &Path, size: [u32; 2]) -> Result<RgbImage, SequenceError> {
    decode_image(path, &read_bytes(path, MAX_PICTURE_BYTES)?, size)
}

/// Reads the bytes of a picture file, and checks that they are a whole picture of this size, pixels.
pub(super) fn read_picture(path: &Path, size: [u32; 2]) -> Result<Vec<u8>, SequenceError> {
    let bytes = read_bytes(path, MAX_PICTURE_BYTES)?;
    check_image(path, &bytes, size)?;
    Ok(bytes)
}

/// Checks by header and end that bytes are a whole JPEG or PNG of this size, pixels; the pixels are not decoded. Fails
/// if they are not. Errors name `path`.
pub fn check_image(path: &Path, bytes: &[u8], size: [u32; 2]) -> Result<(), SequenceError> {
    check_picture(bytes, size).map_err(|fault| SequenceError::of_file(path, fault))
}

/// Writes a picture as PNG or JPEG, by the extension of the file name, and creates its folder. The file gets its name
/// only when it is complete. Fails if the picture cannot be encoded or written.
pub fn save_image(path: &Path, picture: &RgbImage) -> Result<(), SequenceError> {
    let fail = |fault| SequenceError::of_file(path, fault);
    let format = ImageFormat::from_path(path).map_err(|_| fail(Fault::ImageFormat))?;
    let mut bytes = Vec::new();
    let (width, height) = picture.dimensions();
    let written = match format {
        ImageFormat::Png => {
            PngEncoder::new(&mut bytes).write_image(picture, width, height, ExtendedColorType::Rgb8)
        }
        ImageFormat::Jpeg => JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY).write_image(
            picture,
            width,
            height,
            ExtendedColorType::Rgb8,
        ),
        _ => return Err(fail(Fault::ImageFormat)),
    };
    written.map_err(|error| fail(Fault::ImageDamaged(FormatError::new(error))))?;
    create_parent(path)?;
    write_atomically(path, &bytes)
}

/// Copies a picture file unchanged, and creates the destination folder.
pub(super) fn copy_picture(from: &Path, to: &Path) -> Result<(), SequenceError> {
    let bytes = read_bytes(from, MAX_PICTURE_BYTES)?;
    create_parent(to)?;
    write_atomically(to, &bytes)
}

fn create_parent(path: &Path) -> Result<(), SequenceError> {
    path.parent().map_or(Ok(()), |folder| {
        fs::create_dir_all(folder).map_err(|error| SequenceError::of_file(folder, Fault::Unwritable(error)))
    })
}

/// Decodes a JPEG or PNG file of this size, pixels; grey pictures become RGB, transparency is dropped. Fails if the
/// bytes are damaged, incomplete or a picture of another size. Errors name `origin`: the file, or another source of the
/// bytes.
pub fn decode_image(origin: &Path, bytes: &[u8], size: [u32; 2]) -> Result<RgbImage, SequenceError> {
    decode_picture(bytes, size).map_err(|fault| SequenceError::of_file(origin, fault))
}

pub(super) fn decode_picture(bytes: &[u8], size: [u32; 2]) -> Result<RgbImage, Fault> {
    let decoder = checked_decoder(bytes, size)?;
    DynamicImage::from_decoder(decoder).map(DynamicImage::into_rgb8).map_err(decode_fault)
}

/// Checks that the bytes are a whole picture of this size, without decoding its pixels.
pub(super) fn check_picture(bytes: &[u8], size: [u32; 2]) -> Result<(), Fault> {
    checked_decoder(bytes, size).map(drop)
}

/// Returns a decoder. Compares the size first, before anything as large as the header claims is allocated.
fn checked_decoder(bytes: &[u8], [width, height]: [u32; 2]) -> Result<impl ImageDecoder + '_, Fault> {
    let format = image::guess_format(bytes).map_err(|_| Fault::ImageFormat)?;
    let is_whole = match format {
        ImageFormat::Png => is_whole_png(bytes),
        ImageFormat::Jpeg => is_whole_jpeg(bytes),
        _ => return Err(Fault::ImageFormat),
    };
    if !is_whole {
        return Err(Fault::ImageTruncated);
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_PICTURE_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(decode_fault)?;
    let (found_width, found_height) = decoder.dimensions();
    if [found_width, found_height] != [width, height] {
        return Err(Fault::ImageSize { found_width, found_height, width, height });
    }
    if decoder.total_bytes() > MAX_PICTURE_BYTES {
        return Err(Fault::ImageTooLarge { limit_bytes: MAX_PICTURE_BYTES });
    }
    Ok(decoder)
}

fn decode_fault(error: ImageError) -> Fault {
    match error {
        ImageError::Limits(_) => Fault::ImageTooLarge { limit_bytes: MAX_PICTURE_BYTES },
        ImageError::IoError(ref error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            Fault::ImageTruncated
        }
        ImageError::Unsupported(ref error) if matches!(error.kind(), UnsupportedErrorKind::Format(_)) => {
            Fault::ImageFormat
        }
        error => Fault::ImageDamaged(FormatError::new(error)),
    }
}

/// Returns whether a PNG's chunks reach its last one, which is empty.
fn is_whole_png(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or_default();
    loop {
        let [a, b, c, d, kind @ ..] = rest else { return false };
        let length = u32::from_be_bytes([*a, *b, *c, *d]) as usize;
        // Length, kind and checksum take four bytes each.
        let Some(next) = rest.get(length.saturating_add(12)..) else { return false };
        if kind.starts_with(b"IEND") {
            return true;
        }
        rest = next;
    }
}

/// Returns whether an end marker follows the pixels of a JPEG: the decoder silently fills missing pixels with grey.
/// Segments before the pixels are skipped, since a thumbnail has an end marker of its own.
fn is_whole_jpeg(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    let mut rest = bytes.get(2..).unwrap_or_default();
    loop {
        match *rest {
            // Any number of fill bytes may precede a marker.
            [0xff, 0xff, ..] => rest = &rest[1..],
            [0xff, START_OF_SCAN, ..] => return rest.windows(2).any(|pair| pair == [0xff, 0xd9]),
            [0xff, _, high, low, ..] => {
                let length = usize::from(u16::from_be_bytes([high, low]));
                let Some(next) = rest.get(2 + length..) else { return false };
                rest = next;
            }
            _ => return false,
        }
    }
}
