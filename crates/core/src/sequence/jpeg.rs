//! JPEG pictures, decoded strictly: damage that decoders for the eye paint over is an error here.

use std::{borrow::Cow, io::Cursor};

use image::{RgbImage, metadata::Orientation};
use zune_jpeg::{
    JpegDecoder,
    errors::DecodeErrors,
    zune_core::{colorspace::ColorSpace, options::DecoderOptions},
};

use super::{error::Fault, format_error::FormatError, limits::MAX_PICTURE_BYTES};

/// Largest number of bytes between the last decoded one and the end marker: the codes of pixels end in the byte before the
/// marker, and some encoders align it to words of up to this size.
const MOST_UNREAD_BYTES: usize = 16;

/// Number of bytes behind the pixels from which the decoder may read ahead: it holds up to 64 bits.
const AHEAD_BYTES: usize = 16;

const START_OF_SCAN: u8 = 0xda;

/// Decodes a JPEG of this size, pixels, to RGB. The size is compared before anything as large as the header claims is
/// allocated.
///
/// A picture whose pixels end before its height is reached, or whose bytes do not end with its pixels, is damaged: a part of a
/// file that was lost, or is zeros, still decodes to some pixels. Damage to the lowest row of blocks alone may go unnoticed.
pub(super) fn decode_jpeg(bytes: &[u8], [width, height]: [u32; 2]) -> Result<RgbImage, Fault> {
    let end = end_of_scan(bytes).ok_or(Fault::ImageTruncated)?;
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let bytes = without_end(bytes, end);
    let mut reader = Cursor::new(&*bytes);
    let mut decoder = JpegDecoder::new_with_options(&mut reader, options);
    decoder.decode_headers().map_err(damaged)?;
    let (found_width, found_height) = decoder.dimensions().unwrap_or_default();
    // A JPEG states its size in 16 bits.
    let [found_width, found_height] = [found_width, found_height].map(|length| length as u32);
    if [found_width, found_height] != [width, height] {
        return Err(Fault::ImageSize { found_width, found_height, width, height });
    }
    if decoder.output_buffer_size().is_none_or(|bytes| bytes as u64 > MAX_PICTURE_BYTES) {
        return Err(Fault::ImageTooLarge { limit_bytes: MAX_PICTURE_BYTES });
    }
    let orientation = decoder.exif().and_then(|exif| Orientation::from_exif_chunk(exif));
    if orientation.is_some_and(|orientation| orientation != Orientation::NoTransforms) {
        return Err(Fault::ImageTurned);
    }
    let pixels = decoder.decode().map_err(damaged)?;
    drop(decoder);
    let unread_bytes = end.saturating_sub(reader.position() as usize);
    if unread_bytes > MOST_UNREAD_BYTES {
        return Err(Fault::ImageNotWhole { unread_bytes });
    }
    RgbImage::from_raw(width, height, pixels).ok_or(Fault::ImageTruncated)
}

/// Replaces the end marker behind the pixels of a picture with a single scan by a few bytes. At the marker the decoder would
/// make up what is missing, at the end of the bytes it fails. Of a picture with several scans it needs the marker.
fn without_end(bytes: &[u8], end: usize) -> Cow<'_, [u8]> {
    let scans = bytes[..end].windows(2).filter(|pair| *pair == [0xff, START_OF_SCAN]).count();
    if scans == 1 { Cow::Owned([&bytes[..end], &[0; AHEAD_BYTES]].concat()) } else { Cow::Borrowed(bytes) }
}

fn damaged(error: DecodeErrors) -> Fault {
    Fault::ImageDamaged(FormatError::new(error))
}

/// Returns where the end marker behind the pixels is; none if there is no such marker. Segments before the pixels are
/// skipped, since a thumbnail has an end marker of its own.
fn end_of_scan(bytes: &[u8]) -> Option<usize> {
    let mut at = 2;
    loop {
        match *bytes.get(at..)? {
            // Any number of fill bytes may precede a marker.
            [0xff, 0xff, ..] => at += 1,
            [0xff, START_OF_SCAN, ref scan @ ..] => {
                let length = scan.windows(2).position(|pair| pair == [0xff, 0xd9])?;
                return Some(at + 2 + length);
            }
            [0xff, _, high, low, ..] => at += 2 + usize::from(u16::from_be_bytes([high, low])),
            _ => return None,
        }
    }
}

#[cfg(test)]
mod tests {
    use image::{ExtendedColorType, ImageEncoder, ImageFormat, Rgb, codecs::jpeg::JpegEncoder};

    use super::*;

    const SIZE: [u32; 2] = [320, 240];

    /// Picture with something to see everywhere.
    fn picture() -> RgbImage {
        RgbImage::from_fn(SIZE[0], SIZE[1], |u, v| {
            Rgb([(u + v) as u8 / 2, (u * v / 300) as u8, (90 + (u / 9 * 31 + v / 7 * 17) % 50) as u8])
        })
    }

    fn encoded(quality: u8) -> Vec<u8> {
        let mut bytes = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut bytes, quality);
        encoder.write_image(&picture(), SIZE[0], SIZE[1], ExtendedColorType::Rgb8).unwrap();
        bytes
    }

    /// Returns where the bytes of the pixels begin and end.
    fn scan(bytes: &[u8]) -> std::ops::Range<usize> {
        let start = bytes.windows(2).position(|pair| pair == [0xff, 0xda]).unwrap();
        start + 14..end_of_scan(bytes).unwrap()
    }

    #[test]
    fn a_whole_picture_has_the_pixels_of_any_decoder() {
        for quality in [30, 80, 100] {
            let bytes = encoded(quality);
            let decoded = decode_jpeg(&bytes, SIZE).unwrap();
            let peers = image::load_from_memory_with_format(&bytes, ImageFormat::Jpeg).unwrap();
            assert_eq!(decoded, peers.into_rgb8());
        }
    }

    #[test]
    fn pixels_that_were_lost_are_damage() {
        let whole = encoded(80);
        let scan = scan(&whole);
        for quarter in 1..4 {
            let lost = scan.start + scan.len() * quarter / 4..scan.end;
            let mut zeros = whole.clone();
            zeros[lost.clone()].fill(0);
            assert!(decode_jpeg(&zeros, SIZE).is_err(), "zeros after {quarter} quarters");
            let mut cut = whole.clone();
            cut.drain(lost);
            assert!(decode_jpeg(&cut, SIZE).is_err(), "cut after {quarter} quarters");
        }
    }

    #[test]
    fn bytes_behind_the_end_are_of_no_interest() {
        let mut bytes = encoded(80);
        bytes.extend([0; 1000]);
        assert!(decode_jpeg(&bytes, SIZE).is_ok());
    }

    #[test]
    fn a_picture_to_be_turned_is_refused() {
        // TIFF header, one entry: orientation 3, upside down.
        let exif = b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x03\0\0\0\0\0\0\0";
        let mut bytes = encoded(80);
        let mut segment = vec![0xff, 0xe1];
        segment.extend((exif.len() as u16 + 2).to_be_bytes());
        segment.extend(exif);
        bytes.splice(2..2, segment);
        assert!(matches!(decode_jpeg(&bytes, SIZE), Err(Fault::ImageTurned)));
    }
}
