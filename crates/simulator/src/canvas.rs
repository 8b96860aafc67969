//! What a layer draws on: fragments of pixels, kept until all layers are there.
//!
//! The list of fragments is Carpenter's A-buffer ("The A-buffer, an antialiased hidden surface method", SIGGRAPH 1984): each
//! fragment says which of a pixel's parts it covers, so that edges are smooth and layers hide each other part by part.

use glam::Vec3;

use crate::pixel_box::PixelBox;

/// Number of parts of a pixel.
pub const PARTS: usize = 16;

/// Places of the parts in a pixel, in pixels from its centre: Hammersley's points, of which each column and each row of
/// sixteenths contains one.
pub(crate) const PART_OFFSETS: [[f32; PARTS]; 2] = part_offsets();

const fn part_offsets() -> [[f32; PARTS]; 2] {
    let mut offsets = [[0.0; PARTS]; 2];
    let mut part = 0;
    while part < PARTS {
        let reversed = (part as u8).reverse_bits() >> 4;
        offsets[0][part] = (part as f32 + 0.5) / PARTS as f32 - 0.5;
        offsets[1][part] = (reversed as f32 + 0.5) / PARTS as f32 - 0.5;
        part += 1;
    }
    offsets
}

/// Mark of a pixel without a fragment.
const NONE: u32 = u32::MAX;

/// What shows in a pixel, or in some of its parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// Linear red, green and blue, times alpha. 1 is full scale of the camera in the middle of the picture.
    pub color: Vec3,
    /// Opacity: 1 hides what is behind, 0 hides nothing.
    pub alpha: f32,
    /// Distance from the camera along the pixel's ray, metres.
    pub distance_m: f32,
    /// Place of the object in [`crate::Layer::objects`].
    pub object: u16,
    /// The pixel's parts that it covers, a bit each.
    pub parts: u16,
}

impl Fragment {
    /// All parts of a pixel.
    pub const ALL: u16 = u16::MAX;

    fn is_finite(&self) -> bool {
        self.color.is_finite() && self.alpha.is_finite() && self.distance_m.is_finite()
    }
}

/// Fragments of one layer.
#[derive(Debug, Clone, Default)]
pub struct Canvas {
    size: [u32; 2],
    area: PixelBox,
    /// Newest fragment of each of the area's pixels, row by row.
    newest: Vec<u32>,
    /// Fragments, each with the one put before it into the same pixel.
    fragments: Vec<(Fragment, u32)>,
    /// Areas in and outside the picture, pixels², by object.
    extents: Vec<[f32; 2]>,
}

impl Canvas {
    /// Makes an empty canvas for pictures of this size.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, ..Self::default() }
    }

    /// Empties the canvas, for pictures of this size; keeps its memory.
    pub fn clear(&mut self, size: [u32; 2]) {
        self.size = size;
        self.area = PixelBox::default();
        self.newest.clear();
        self.fragments.clear();
        self.extents.clear();
    }

    /// Returns width and height of the picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the pixels that can hold fragments.
    pub fn area(&self) -> PixelBox {
        self.area
    }

    /// Makes room for fragments in a part of the picture; what was drawn stays. The work of a frame grows with this area.
    pub fn open(&mut self, area: PixelBox) {
        let area =
            PixelBox { right: area.right.min(self.size[0]), bottom: area.bottom.min(self.size[1]), ..area };
        let grown = self.area.union(area);
        if area.is_empty() || grown == self.area {
            return;
        }
        if self.area.is_empty() {
            // The memory of the frame before is used again.
            self.newest.clear();
            self.newest.resize(area.width() as usize * area.height() as usize, NONE);
            self.area = area;
            return;
        }
        let mut newest = vec![NONE; grown.width() as usize * grown.height() as usize];
        let width = self.area.width() as usize;
        for (row, old) in self.newest.chunks(width).enumerate() {
            let v = self.area.top as usize + row - grown.top as usize;
            let first = v * grown.width() as usize + (self.area.left - grown.left) as usize;
            newest[first..first + width].copy_from_slice(old);
        }
        (self.area, self.newest) = (grown, newest);
    }

    /// Puts a fragment into a pixel. Does nothing outside [`Canvas::area`], or where the fragment is nothing: without parts,
    /// without opacity, at or behind the camera, or not made of finite numbers.
    pub fn put(&mut self, u: u32, v: u32, fragment: Fragment) {
        let is_something =
            fragment.parts != 0 && fragment.alpha > 0.0 && fragment.distance_m > 0.0 && fragment.is_finite();
        if !is_something || !self.area.contains(u, v) {
            return;
        }
        let index = self.index(u, v);
        let place = self.fragments.len() as u32;
        let fragment = Fragment { alpha: fragment.alpha.min(1.0), ..fragment };
        self.fragments.push((fragment, self.newest[index]));
        self.newest[index] = place;
    }

    /// Returns a pixel's fragments, those put last first.
    pub fn fragments(&self, u: u32, v: u32) -> impl Iterator<Item = &Fragment> {
        let mut next = if self.area.contains(u, v) { self.newest[self.index(u, v)] } else { NONE };
        std::iter::from_fn(move || {
            let (fragment, before) = self.fragments.get(next as usize)?;
            next = *before;
            Some(fragment)
        })
    }

    /// Tells how large an object is in and outside the picture, pixels²; several calls add up.
    pub fn add_extent(&mut self, object: u16, inside_px2: f32, outside_px2: f32) {
        let index = usize::from(object);
        if self.extents.len() <= index {
            self.extents.resize(index + 1, [0.0; 2]);
        }
        self.extents[index][0] += inside_px2;
        self.extents[index][1] += outside_px2;
    }

    /// Returns the share of an object that lies outside the picture, 0 where the layer has not told.
    pub fn truncation(&self, object: u16) -> f32 {
        match self.extents.get(usize::from(object)) {
            Some([inside, outside]) if inside + outside > 0.0 => outside / (inside + outside),
            _ => 0.0,
        }
    }

    fn index(&self, u: u32, v: u32) -> usize {
        (v - self.area.top) as usize * self.area.width() as usize + (u - self.area.left) as usize
    }
}
