//! Masks of images: which parts show a thing that stood in front of the scene.

use crate::leb128::{push_number, take_number};

/// Mask of an image, coarser than its picture: cells in rows, each of which covers an equal part of the picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImageMask {
    width: u32,
    height: u32,
    /// Ends of runs of cells, row by row from the top, that are shown, hidden, shown and so on. The first run may be empty.
    ends: Vec<u32>,
}

impl ImageMask {
    /// Largest number of columns, and of rows.
    pub const LARGEST: u32 = 8192;

    /// Makes a mask of this many columns and rows that hides the cells, given by column and row, for which a function says so.
    ///
    /// # Panics
    ///
    /// Panics if a side is 0 or longer than [`ImageMask::LARGEST`].
    pub fn new([width, height]: [u32; 2], is_hidden: impl Fn(u32, u32) -> bool) -> Self {
        assert!(Self::has_size(width, height), "a mask of {width} × {height} cells");
        let mut ends = Vec::new();
        for cell in 0..width * height {
            let runs_hidden = ends.len() % 2 == 1;
            if is_hidden(cell % width, cell / width) != runs_hidden {
                ends.push(cell);
            }
        }
        ends.push(width * height);
        Self { width, height, ends }
    }

    fn has_size(width: u32, height: u32) -> bool {
        [width, height].iter().all(|side| (1..=Self::LARGEST).contains(side))
    }

    /// Returns the numbers of columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Returns whether a cell is hidden; cells beside the mask are not.
    pub fn is_hidden(&self, column: u32, row: u32) -> bool {
        if column >= self.width || row >= self.height {
            return false;
        }
        let cell = row * self.width + column;
        self.ends.partition_point(|end| *end <= cell) % 2 == 1
    }

    /// Returns whether the cell at a pixel of a picture of this size is hidden. Pixels beside the picture are not.
    pub fn hides(&self, [u, v]: [u32; 2], [width, height]: [u32; 2]) -> bool {
        let cell = |pixel: u32, pixels: u32, cells: u32| {
            (u64::from(pixel) * u64::from(cells) / u64::from(pixels.max(1))) as u32
        };
        self.is_hidden(cell(u, width, self.width), cell(v, height, self.height))
    }

    /// Returns whether nothing is hidden.
    pub fn is_empty(&self) -> bool {
        self.hidden_cells() == 0
    }

    /// Returns the share of the cells that are hidden.
    pub fn hidden_share(&self) -> f64 {
        f64::from(self.hidden_cells()) / (f64::from(self.width) * f64::from(self.height))
    }

    fn hidden_cells(&self) -> u32 {
        let (pairs, _) = self.ends.as_chunks::<2>();
        pairs.iter().map(|[start, end]| end - start).sum()
    }

    /// Returns the lengths of the runs as LEB128 numbers.
    pub(crate) fn to_runs(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut start = 0;
        for &end in &self.ends {
            push_number(&mut bytes, end - start);
            start = end;
        }
        bytes
    }

    /// Inverse of [`ImageMask::to_runs`]; `None` where the runs are not those of a mask of this size.
    pub(crate) fn from_runs(width: u32, height: u32, mut runs: &[u8]) -> Option<Self> {
        if !Self::has_size(width, height) {
            return None;
        }
        let (mut ends, mut end) = (Vec::new(), 0_u32);
        while !runs.is_empty() {
            end = end.checked_add(take_number(&mut runs)?)?;
            ends.push(end);
        }
        (end == width * height).then_some(Self { width, height, ends })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_mask_hides_what_it_was_told_to_and_so_do_its_runs(
            width in 1..40_u32, height in 1..30_u32, seed in any::<u32>(),
        ) {
            let is_hidden = |column: u32, row: u32| {
                ((column + 57 * row) ^ seed).wrapping_mul(2_654_435_761) >> 30 == 0
            };
            let mask = ImageMask::new([width, height], is_hidden);
            let mut hidden = 0;
            for (column, row) in (0..width).flat_map(|column| (0..height).map(move |row| (column, row))) {
                prop_assert_eq!(mask.is_hidden(column, row), is_hidden(column, row));
                hidden += u32::from(is_hidden(column, row));
            }
            prop_assert_eq!(mask.hidden_cells(), hidden);
            prop_assert_eq!(ImageMask::from_runs(width, height, &mask.to_runs()), Some(mask));
        }

        #[test]
        fn any_bytes_are_read_or_refused(
            width in any::<u32>(), height in 0..50_u32, runs in prop::collection::vec(any::<u8>(), 0..40),
        ) {
            if let Some(mask) = ImageMask::from_runs(width, height, &runs) {
                prop_assert!((0.0..=1.0).contains(&mask.hidden_share()));
            }
        }
    }

    #[test]
    fn runs_that_are_too_short_or_too_long_are_refused() {
        assert_eq!(ImageMask::new([5, 4], |_, _| false).to_runs(), [20]);
        for runs in [&[19][..], &[10, 11], &[], &[0xff; 9], &[0x80], &[0xff, 0xff, 0xff, 0xff, 0x0f, 21]] {
            assert_eq!(ImageMask::from_runs(5, 4, runs), None, "{runs:?}");
        }
        assert_eq!(ImageMask::from_runs(0, 4, &[]), None);
        assert_eq!(ImageMask::from_runs(ImageMask::LARGEST + 1, 1, &[0x81, 0x40]), None);
    }

    #[test]
    fn a_cell_hides_its_part_of_the_picture() {
        let mask = ImageMask::new([4, 3], |column, row| (column, row) == (1, 2));
        let hidden =
            (0..50).flat_map(|u| (0..40).map(move |v| [u, v])).filter(|&at| mask.hides(at, [40, 30]));
        let hidden: Vec<_> = hidden.collect();
        assert_eq!(hidden.len(), 100);
        assert!(hidden.iter().all(|[u, v]| (10..20).contains(u) && (20..30).contains(v)));
        assert!(!mask.is_empty() && (mask.hidden_share() - 1.0 / 12.0).abs() < 1e-12);
    }
}
