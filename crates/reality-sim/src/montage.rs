//! Pictures side by side.

use image::{RgbImage, imageops};

/// Width of one picture in a strip, pixels.
const STRIP_WIDTH: u32 = 320;
/// Space between pictures, pixels.
const GAP: u32 = 4;
/// Colour behind the pictures.
const BACKGROUND: image::Rgb<u8> = image::Rgb([255; 3]);

/// Arranges pictures from left to right, four in a row, as in the paper's Fig. 12.
pub fn strip(pictures: &[RgbImage]) -> RgbImage {
    let rows: Vec<&[RgbImage]> = pictures.chunks(4).collect();
    grid(&rows, STRIP_WIDTH)
}

/// Arranges pictures in rows, each scaled to this width, pixels.
pub fn grid(rows: &[&[RgbImage]], width: u32) -> RgbImage {
    let scaled: Vec<Vec<RgbImage>> =
        rows.iter().map(|row| row.iter().map(|picture| scaled(picture, width)).collect()).collect();
    let columns = rows.iter().map(|row| row.len() as u32).max().unwrap_or(0);
    let heights: Vec<u32> =
        scaled.iter().map(|row| row.iter().map(RgbImage::height).max().unwrap_or(0)).collect();
    let total_height = heights.iter().map(|height| height + GAP).sum::<u32>().saturating_sub(GAP);
    let mut all =
        RgbImage::from_pixel((columns * (width + GAP)).saturating_sub(GAP), total_height, BACKGROUND);
    let mut top = 0;
    for (row, height) in scaled.iter().zip(heights) {
        for (column, picture) in row.iter().enumerate() {
            imageops::replace(&mut all, picture, column as i64 * i64::from(width + GAP), i64::from(top));
        }
        top += height + GAP;
    }
    all
}

fn scaled(picture: &RgbImage, width: u32) -> RgbImage {
    let height = (picture.height() * width).div_ceil(picture.width().max(1)).max(1);
    imageops::resize(picture, width.max(1), height, imageops::FilterType::Triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_placed_by_row_and_column() {
        let plain = |value: u8| RgbImage::from_pixel(8, 6, image::Rgb([value; 3]));
        let (first, second) = ([plain(10), plain(20)], [plain(30)]);
        let all = grid(&[&first, &second], 8);
        assert_eq!(all.dimensions(), (2 * 8 + GAP, 2 * 6 + GAP));
        assert_eq!(all.get_pixel(8 + GAP + 3, 2).0, [20; 3]);
        assert_eq!(all.get_pixel(3, 6 + GAP + 2).0, [30; 3]);
        assert_eq!(all.get_pixel(8 + GAP + 3, 6 + GAP + 2).0, [255; 3]);
        assert_eq!(strip(&[]).dimensions(), (0, 0));
    }
}
