//! Pixels of raw pictures, in the encodings of ROS (`sensor_msgs/image_encodings.hpp`).

use std::borrow::Cow;

use image::{DynamicImage, GrayImage, RgbImage};
use reality_sim_core::sequence::on_one_line;

use super::bayer::{Pattern, demosaiced};
use crate::schema::View;

/// Largest side of a picture, pixels.
const MAX_SIDE: usize = 1 << 15;

/// Picture as pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct RawPicture<'a> {
    /// Width, pixels.
    pub width: usize,
    /// Height, pixels.
    pub height: usize,
    /// Name of the encoding.
    pub encoding: String,
    /// Bytes from one row to the next.
    pub step: usize,
    /// Whether numbers of 16 bits have their most significant byte first.
    pub is_big_endian: bool,
    /// Bytes of all rows.
    pub data: Cow<'a, [u8]>,
}

/// Reason why pixels cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PixelFault {
    /// The encoding is not known.
    #[error("the encoding `{}` is not read: record the topic in rgb8, bgr8, mono8 or as JPEG", on_one_line(.0))]
    UnknownEncoding(String),
    /// There are fewer bytes than the picture needs.
    #[error("{found} bytes are too few for {width} × {height} pixels in {}", on_one_line(.encoding))]
    TooFewBytes {
        /// Bytes that there are.
        found: usize,
        /// Width, pixels.
        width: usize,
        /// Height, pixels.
        height: usize,
        /// Name of the encoding.
        encoding: String,
    },
}

/// How pixels lie in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Layout {
    /// One byte a pixel.
    Grey,
    /// Two bytes a pixel.
    Grey16,
    /// Three or four bytes a pixel: number of bytes, places of red, green and blue.
    Color(usize, [usize; 3]),
    /// Two pixels in four bytes: places of the first brightness, both colours, the second brightness.
    Yuv422([usize; 4]),
    /// Brightness of all pixels, then colours of every second in both directions: places of both colours.
    SemiPlanar([usize; 2]),
    /// One colour a pixel.
    Bayer(Pattern),
}

impl Layout {
    fn of(encoding: &str) -> Option<Self> {
        Some(match encoding.to_ascii_lowercase().as_str() {
            "mono8" | "8uc1" => Self::Grey,
            "mono16" | "16uc1" => Self::Grey16,
            "rgb8" => Self::Color(3, [0, 1, 2]),
            "bgr8" | "8uc3" => Self::Color(3, [2, 1, 0]),
            "rgba8" => Self::Color(4, [0, 1, 2]),
            "bgra8" | "8uc4" => Self::Color(4, [2, 1, 0]),
            "yuv422" | "uyvy" => Self::Yuv422([1, 0, 2, 3]),
            "yuv422_yuy2" | "yuyv" | "yuy2" => Self::Yuv422([0, 1, 3, 2]),
            "nv12" => Self::SemiPlanar([0, 1]),
            "nv21" => Self::SemiPlanar([1, 0]),
            "bayer_rggb8" => Self::Bayer(Pattern::Rggb),
            "bayer_bggr8" => Self::Bayer(Pattern::Bggr),
            "bayer_gbrg8" => Self::Bayer(Pattern::Gbrg),
            "bayer_grbg8" => Self::Bayer(Pattern::Grbg),
            _ => return None,
        })
    }

    /// Returns the bytes that a row needs at least.
    fn row_bytes(self, width: usize) -> usize {
        match self {
            Self::Grey | Self::Bayer(_) => width,
            Self::Grey16 => 2 * width,
            Self::Color(bytes, _) => bytes * width,
            Self::Yuv422(_) => 4 * width.div_ceil(2),
            Self::SemiPlanar(_) => 2 * width.div_ceil(2),
        }
    }

    fn rows(self, height: usize) -> usize {
        if let Self::SemiPlanar(_) = self { height + height.div_ceil(2) } else { height }
    }
}

impl<'a> RawPicture<'a> {
    pub(super) fn read(message: &View<'a>, data: Cow<'a, [u8]>) -> Option<Self> {
        let size = |name: &str| usize::try_from(message.field(name)?.integer()?).ok();
        Some(Self {
            width: size("width")?,
            height: size("height")?,
            encoding: message.field("encoding")?.text()?.into_owned(),
            step: size("step").unwrap_or(0),
            is_big_endian: size("is_bigendian") == Some(1),
            data,
        })
    }

    /// Copies a picture out of the message that holds it.
    pub fn into_owned(self) -> RawPicture<'static> {
        RawPicture { data: Cow::Owned(self.data.into_owned()), ..self }
    }

    /// Checks that all pixels are there. Fails if not, or if the encoding is not known.
    pub fn check(&self) -> Result<(), PixelFault> {
        self.layout().map(drop)
    }

    /// Returns the layout and the bytes from one row to the next.
    fn layout(&self) -> Result<(Layout, usize), PixelFault> {
        let (width, height) = (self.width, self.height);
        let layout =
            Layout::of(&self.encoding).ok_or_else(|| PixelFault::UnknownEncoding(self.encoding.clone()))?;
        let needed = layout.row_bytes(width);
        let step = if self.step == 0 { needed } else { self.step };
        let fits = (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) && step >= needed;
        let last = layout.rows(height).saturating_sub(1);
        let bytes = last.checked_mul(step).and_then(|before| before.checked_add(needed));
        if fits && bytes.is_some_and(|bytes| bytes <= self.data.len()) {
            return Ok((layout, step));
        }
        let encoding = self.encoding.clone();
        Err(PixelFault::TooFewBytes { found: self.data.len(), width, height, encoding })
    }

    /// Converts the pixels to grey or RGB. Fails if some are missing or the encoding is not known.
    pub fn picture(&self) -> Result<DynamicImage, PixelFault> {
        let (layout, step) = self.layout()?;
        let rows = Rows { data: &self.data, step, width: self.width, height: self.height };
        Ok(match layout {
            Layout::Grey => rows.grey(|row| row[..self.width].to_vec()),
            Layout::Grey16 => {
                let high = usize::from(!self.is_big_endian);
                rows.grey(|row| row.chunks_exact(2).take(self.width).map(|pixel| pixel[high]).collect())
            }
            Layout::Color(bytes, [r, g, b]) => rows.color(|row, _| {
                row.chunks_exact(bytes)
                    .take(self.width)
                    .flat_map(|pixel| [pixel[r], pixel[g], pixel[b]])
                    .collect()
            }),
            Layout::Yuv422([y0, u, v, y1]) => rows.color(|row, _| {
                let pairs = row.chunks_exact(4).take(self.width.div_ceil(2));
                let both =
                    pairs.flat_map(|pair| [(pair[y0], pair[u], pair[v]), (pair[y1], pair[u], pair[v])]);
                both.take(self.width).flat_map(|(y, u, v)| rgb_of_yuv(y, u, v)).collect()
            }),
            Layout::SemiPlanar([u, v]) => rows.color(|row, index| {
                let colors = &self.data[(self.height + index / 2) * step..];
                let pixels = row[..self.width].iter().enumerate();
                let color = |x: usize| &colors[x / 2 * 2..][..2];
                pixels.flat_map(|(x, y)| rgb_of_yuv(*y, color(x)[u], color(x)[v])).collect()
            }),
            Layout::Bayer(pattern) => {
                let pixel = |x: usize, y: usize| self.data[y * step + x];
                rows.of_rgb(demosaiced(pattern, self.width, self.height, pixel))
            }
        })
    }
}

/// Rows of a picture whose size has been checked.
struct Rows<'a> {
    data: &'a [u8],
    step: usize,
    width: usize,
    height: usize,
}

impl Rows<'_> {
    fn all(&self) -> impl Iterator<Item = &[u8]> {
        self.data.chunks(self.step).take(self.height)
    }

    fn grey(&self, row: impl Fn(&[u8]) -> Vec<u8>) -> DynamicImage {
        let bytes: Vec<u8> = self.all().flat_map(row).collect();
        GrayImage::from_raw(self.width as u32, self.height as u32, bytes).unwrap_or_default().into()
    }

    fn color(&self, row: impl Fn(&[u8], usize) -> Vec<u8>) -> DynamicImage {
        let mut bytes = Vec::with_capacity(3 * self.width * self.height);
        for (index, source) in self.all().enumerate() {
            bytes.extend(row(source, index));
        }
        self.of_rgb(bytes)
    }

    fn of_rgb(&self, bytes: Vec<u8>) -> DynamicImage {
        RgbImage::from_raw(self.width as u32, self.height as u32, bytes).unwrap_or_default().into()
    }
}

/// Converts brightness and colours to RGB, by ITU-R BT.601 with brightness from 16 to 235, as OpenCV does for these encodings.
fn rgb_of_yuv(y: u8, u: u8, v: u8) -> [u8; 3] {
    let (y, u, v) = (298 * (i32::from(y) - 16).max(0), i32::from(u) - 128, i32::from(v) - 128);
    let byte = |value: i32| ((value + 128) >> 8).clamp(0, 255) as u8;
    [byte(y + 409 * v), byte(y - 100 * u - 208 * v), byte(y + 516 * u)]
}
