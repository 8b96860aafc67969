//! Recorded and drawn pictures, embedded in the page.

use image::{ExtendedColorType, GrayImage, ImageEncoder, Rgb, RgbImage, codecs::jpeg::JpegEncoder};

use super::text::escape;
use crate::{measurement::quantity::Channel, report::data::Report, report::pictures::Pictures};

/// JPEG quality of pictures in the page.
const JPEG_QUALITY: u8 = 88;
/// Factor by which differences on the field are amplified.
const AMPLIFIED: u8 = 4;
/// Factor of differences where nothing is compared.
const FAINT: u8 = 1;

/// Returns the section of pictures: as recorded, before, after, and their differences. Before and after are a single picture
/// if the model was not extended.
pub(super) fn section(pictures: &Pictures, report: &Report) -> String {
    let Pictures { measured, before, after, field } = pictures;
    let difference = |drawn: &RgbImage, when: &str| {
        let caption = format!("|measured − simulated| × {AMPLIFIED} on the field, {when}");
        figure(&difference(measured, drawn, field), &caption)
    };
    let figures = if before == after {
        format!(
            "<div class=\"three\">{}{}{}</div>",
            figure(measured, "as recorded"),
            figure(before, "simulated with the model as it was given"),
            difference(before, "model as it was given"),
        )
    } else {
        format!(
            "<div class=\"three\">{}{}{}</div>\n<div class=\"two\">{}{}</div>",
            figure(measured, "as recorded"),
            figure(before, "simulated with the model as it was given"),
            figure(after, "simulated with the extended model"),
            difference(before, "model as it was given"),
            difference(after, "extended model"),
        )
    };
    let colors = if report.gap.channels.contains_key(&Channel::Photometry) {
        ""
    } else {
        " Brightness and colours are not: nothing in camera.toml says how bright lines and carpet are."
    };
    format!(
        "<h2>The same frame</h2>\n{figures}\n<p class=\"quiet\">Frame {} of the recording. Only lines and carpet are \
         compared: what stands on and around the field does not count.{colors}</p>\n",
        report.shown_frame
    )
}

fn figure(picture: &RgbImage, caption: &str) -> String {
    let caption = escape(caption);
    let shown = data_uri(picture).map_or_else(
        || "<p class=\"quiet\">no picture</p>".to_owned(),
        |uri| format!("<img src=\"{uri}\" alt=\"{caption}\"/>"),
    );
    format!("<figure>{shown}<figcaption>{caption}</figcaption></figure>")
}

/// Returns the difference of two pictures, amplified on the field; an empty picture if their sizes differ.
fn difference(measured: &RgbImage, drawn: &RgbImage, field: &GrayImage) -> RgbImage {
    if measured.dimensions() != drawn.dimensions() || measured.dimensions() != field.dimensions() {
        return RgbImage::new(0, 0);
    }
    RgbImage::from_fn(measured.width(), measured.height(), |x, y| {
        let (a, b) = (measured.get_pixel(x, y).0, drawn.get_pixel(x, y).0);
        let factor = if field.get_pixel(x, y).0[0] > 0 { AMPLIFIED } else { FAINT };
        Rgb(std::array::from_fn(|color| a[color].abs_diff(b[color]).saturating_mul(factor)))
    })
}

/// Encodes a picture as a data URI. None for a picture without pixels, or one too large for JPEG.
fn data_uri(picture: &RgbImage) -> Option<String> {
    if picture.width() == 0 || picture.height() == 0 {
        return None;
    }
    let mut bytes = Vec::new();
    let (width, height) = picture.dimensions();
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)
        .write_image(picture.as_raw(), width, height, ExtendedColorType::Rgb8)
        .ok()?;
    Some(format!("data:image/jpeg;base64,{}", base64(&bytes)))
}

/// Encodes bytes in Base64 (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let at = |index: usize| u32::from(chunk.get(index).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for digit in 0..4 {
            let letter = ALPHABET[(bits >> (18 - 6 * digit) & 63) as usize];
            text.push(if digit <= chunk.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use image::Luma;

    use super::*;

    /// Test vectors from RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_its_standard() {
        let cases = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
        ];
        for (bytes, text) in cases {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xbf]), "+/+/");
    }

    #[test]
    fn a_difference_is_amplified_up_to_white_on_the_field() {
        let [grey, darker] = [100, 90].map(|value| RgbImage::from_pixel(2, 2, Rgb([value, value, 0])));
        let field = GrayImage::from_fn(2, 2, |x, _| Luma([if x > 0 { 255 } else { 0 }]));
        let shown = difference(&grey, &darker, &field);
        assert_eq!([shown.get_pixel(1, 1).0, shown.get_pixel(0, 1).0], [[40, 40, 0], [10, 10, 0]]);
        let black = RgbImage::new(2, 2);
        assert_eq!(difference(&grey, &black, &field).get_pixel(1, 0).0, [255, 255, 0]);
    }

    #[test]
    fn pictures_of_different_sizes_have_no_difference() {
        let (one, other) = (RgbImage::new(2, 2), RgbImage::new(3, 2));
        assert_eq!(difference(&one, &other, &GrayImage::new(2, 2)).dimensions(), (0, 0));
        assert_eq!(difference(&one, &one, &GrayImage::new(3, 2)).dimensions(), (0, 0));
        assert!(figure(&RgbImage::new(0, 0), "empty").contains("no picture"));
    }
}
