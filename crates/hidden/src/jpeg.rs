//! Pictures as cameras store them: JPEG, mostly with chroma subsampling, or PNG.
//!
//! The encoder keeps the full chroma (4:4:4). The loss in cameras (4:2:0) is applied before: colour differences are averaged
//! over two by two pixels and interpolated again as decoders do, between the nearest four means.

use image::{
    ExtendedColorType, ImageEncoder, ImageError, RgbImage,
    codecs::{jpeg::JpegEncoder, png::PngEncoder},
};

/// Format of the pictures' files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// JPEG.
    Jpeg {
        /// Quality, 1 to 100.
        quality: u8,
        /// Whether colour differences are averaged over two by two pixels.
        halves_color: bool,
    },
    /// PNG.
    Png,
}

impl Storage {
    /// JPEG as in the recordings of a robot.
    pub const STANDARD: Self = Self::Jpeg { quality: 85, halves_color: true };

    /// Returns the ending of the files' names.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Jpeg { .. } => "jpg",
            Self::Png => "png",
        }
    }

    /// Returns the bytes of a picture's file.
    pub fn encode(self, picture: &RgbImage) -> Result<Vec<u8>, ImageError> {
        let mut bytes = Vec::new();
        let (width, height) = picture.dimensions();
        let color = ExtendedColorType::Rgb8;
        match self {
            Self::Jpeg { quality, halves_color } => {
                let halved = halves_color.then(|| halve_color(picture));
                let encoder = JpegEncoder::new_with_quality(&mut bytes, quality);
                encoder.write_image(halved.as_ref().unwrap_or(picture), width, height, color)?;
            }
            Self::Png => PngEncoder::new(&mut bytes).write_image(picture, width, height, color)?,
        }
        Ok(bytes)
    }
}

/// Halves the chroma resolution in each direction, at full resolution of the luma.
fn halve_color(picture: &RgbImage) -> RgbImage {
    let size = [picture.width() as usize, picture.height() as usize];
    let [blue, red] = [2, 0].map(|channel| Means::new(picture, channel));
    let mut halved = RgbImage::new(picture.width(), picture.height());
    for (index, (pixel, from)) in halved.pixels_mut().zip(picture.pixels()).enumerate() {
        let place = [index % size[0], index / size[0]];
        let (y, cb, cr) = (brightness(from.0), blue.spread(place), red.spread(place));
        let rgb = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
        pixel.0 = rgb.map(|value| value.round().clamp(0.0, 255.0) as u8);
    }
    halved
}

/// Returns Y of ITU-R BT.601.
fn brightness([red, green, blue]: [u8; 3]) -> f32 {
    0.299 * f32::from(red) + 0.587 * f32::from(green) + 0.114 * f32::from(blue)
}

/// Colour difference averaged over two by two pixels.
struct Means {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Means {
    /// Averages Cr (channel 0) or Cb (channel 2).
    fn new(picture: &RgbImage, channel: usize) -> Self {
        let scale = if channel == 0 { 1.402 } else { 1.772 };
        let [last_x, last_y] = [picture.width() - 1, picture.height() - 1];
        let difference = |x: u32, y: u32| {
            let rgb = picture.get_pixel(x.min(last_x), y.min(last_y)).0;
            (f32::from(rgb[channel]) - brightness(rgb)) / scale
        };
        let (width, height) = (picture.width().div_ceil(2), picture.height().div_ceil(2));
        let mean = |x: u32, y: u32| {
            let sum =
                difference(x, y) + difference(x + 1, y) + difference(x, y + 1) + difference(x + 1, y + 1);
            (sum / 4.0).round()
        };
        let values = (0..height).flat_map(|y| (0..width).map(move |x| (2 * x, 2 * y)));
        Self {
            width: width as usize,
            height: height as usize,
            values: values.map(|(x, y)| mean(x, y)).collect(),
        }
    }

    /// Interpolates at a pixel: three parts of its own mean and one of the next, in each direction.
    fn spread(&self, [x, y]: [usize; 2]) -> f32 {
        let next = |place: usize, count: usize| {
            let half = place / 2;
            if place.is_multiple_of(2) { half.saturating_sub(1) } else { (half + 1).min(count - 1) }
        };
        let (x0, x1, y0, y1) = (x / 2, next(x, self.width), y / 2, next(y, self.height));
        let at = |x: usize, y: usize| self.values[y * self.width + x];
        let row = |y: usize| 0.75 * at(x0, y) + 0.25 * at(x1, y);
        0.75 * row(y0) + 0.25 * row(y1)
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    #[test]
    fn grey_pictures_and_even_colour_stay_as_they_are() {
        let grey = RgbImage::from_fn(9, 7, |x, y| Rgb([(x * 20 + y * 9) as u8; 3]));
        assert_eq!(halve_color(&grey), grey);
        let even = RgbImage::from_pixel(8, 8, Rgb([53, 105, 64]));
        let difference = |a: &Rgb<u8>, b: &Rgb<u8>| a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b)).max();
        assert!(halve_color(&even).pixels().zip(even.pixels()).all(|(a, b)| difference(a, b) <= Some(1)));
    }

    #[test]
    fn colour_loses_detail_and_brightness_does_not() {
        let stripes =
            RgbImage::from_fn(
                16,
                16,
                |x, _| if x % 2 == 0 { Rgb([200, 60, 60]) } else { Rgb([60, 102, 200]) },
            );
        let halved = halve_color(&stripes);
        let reds = |picture: &RgbImage| picture.get_pixel(6, 6).0[0].abs_diff(picture.get_pixel(7, 6).0[0]);
        assert!(reds(&stripes) == 140 && reds(&halved) < 10, "{}", reds(&halved));
        let change = |x| (brightness(halved.get_pixel(x, 6).0) - brightness(stripes.get_pixel(x, 6).0)).abs();
        assert!(change(6) < 1.0 && change(7) < 1.0);
    }
}
