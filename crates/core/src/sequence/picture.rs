//! Pictures of a sequence: decoding within limits, encoding, copying.

use std::{fs, io::Cursor, path::Path};

use image::{
    DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, ImageFormat, ImageReader,
    Limits, RgbImage, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder, error::UnsupportedErrorKind,
    metadata::Orientation,
};

use super::{
    atomic::write_atomically,
    error::{Fault, SequenceError},
    format_error::FormatError,
    jpeg::decode_jpeg,
    limits::MAX_PICTURE_BYTES,
    text::read_bytes,
};

/// Quality of written JPEG files: nearly lossless at edges.
const JPEG_QUALITY: u8 = 95;

/// Reads a picture file of this size, pixels. Returns the picture with the bytes of its file.
pub(super) fn read_picture(path: &Path, size: [u32; 2]) -> Result<(RgbImage, Vec<u8>), SequenceError> {
    let bytes = read_bytes(path, MAX_PICTURE_BYTES)?;
    Ok((decode_image(path, &bytes, size)?, bytes))
}

/// Checks that bytes are a JPEG or PNG of this size, pixels, and that all of it decodes. Fails if they are not. Errors name
/// `path`.
pub fn check_image(path: &Path, bytes: &[u8], size: [u32; 2]) -> Result<(), SequenceError> {
    decode_image(path, bytes, size).map(drop)
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
    match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => decode_png(bytes, size),
        Ok(ImageFormat::Jpeg) => decode_jpeg(bytes, size),
        _ => Err(Fault::ImageFormat),
    }
}

/// Decodes a PNG. Compares the size first, before anything as large as the header claims is allocated.
fn decode_png(bytes: &[u8], [width, height]: [u32; 2]) -> Result<RgbImage, Fault> {
    if !is_whole_png(bytes) {
        return Err(Fault::ImageTruncated);
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_PICTURE_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(decode_fault)?;
    let (found_width, found_height) = decoder.dimensions();
    if [found_width, found_height] != [width, height] {
        return Err(Fault::ImageSize { found_width, found_height, width, height });
    }
    if decoder.total_bytes() > MAX_PICTURE_BYTES {
        return Err(Fault::ImageTooLarge { limit_bytes: MAX_PICTURE_BYTES });
    }
    if decoder.orientation().map_err(decode_fault)? != Orientation::NoTransforms {
        return Err(Fault::ImageTurned);
    }
    DynamicImage::from_decoder(decoder).map(DynamicImage::into_rgb8).map_err(decode_fault)
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
