//! From single pixels that differ to the things that they belong to.

/// Pixels of nine around one, itself included, that have to differ as well: noise differs alone.
const LEAST_AROUND: usize = 4;
/// Distance up to which gaps in a thing are closed, pixels.
const CLOSED_PX: usize = 2;
/// Distance by which things are enlarged, pixels: their edges are mixed with the ground.
const EDGE_PX: usize = 1;

/// Picture of yes and no.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Bits {
    pub width: usize,
    pub pixels: Vec<bool>,
}

impl Bits {
    pub fn new(width: usize, pixels: Vec<bool>) -> Self {
        Self { width, pixels }
    }

    /// Returns the pixels in squares around which at least this many are set.
    fn with_at_least(&self, count: usize, reach: usize) -> Self {
        let (width, height) = (self.width, self.pixels.len() / self.width);
        // Sums over the rectangle from the first pixel on, with a row and a column of zeros before it.
        let stride = width + 1;
        let mut sums = vec![0_u32; stride * (height + 1)];
        for row in 0..height {
            let mut along = 0;
            for column in 0..width {
                along += u32::from(self.pixels[row * width + column]);
                sums[(row + 1) * stride + column + 1] = sums[row * stride + column + 1] + along;
            }
        }
        let is_set = |pixel: usize| {
            let (row, column) = (pixel / width, pixel % width);
            let (top, bottom) = (row.saturating_sub(reach), height.min(row + reach + 1));
            let (left, right) = (column.saturating_sub(reach), width.min(column + reach + 1));
            let sum = sums[bottom * stride + right] + sums[top * stride + left]
                - sums[top * stride + right]
                - sums[bottom * stride + left];
            sum as usize >= count
        };
        Self { width, pixels: (0..self.pixels.len()).map(is_set).collect() }
    }

    /// Enlarges what is set.
    pub fn dilated(&self, reach: usize) -> Self {
        self.with_at_least(1, reach)
    }

    /// Shrinks what is set; beyond the border everything counts as set.
    pub fn eroded(&self, reach: usize) -> Self {
        let inverse = Self { width: self.width, pixels: self.pixels.iter().map(|set| !set).collect() };
        let grown = inverse.dilated(reach);
        Self { width: self.width, pixels: grown.pixels.iter().map(|set| !set).collect() }
    }

    fn and(mut self, other: &Self) -> Self {
        self.pixels.iter_mut().zip(&other.pixels).for_each(|(a, b)| *a &= b);
        self
    }

    /// Returns the connected patches, each as the list of its pixels.
    pub fn patches(&self) -> Vec<Vec<usize>> {
        let (width, height) = (self.width, self.pixels.len() / self.width);
        let mut is_open = self.pixels.clone();
        let mut patches = Vec::new();
        for start in 0..is_open.len() {
            if !std::mem::take(&mut is_open[start]) {
                continue;
            }
            let (mut patch, mut next) = (vec![start], 0);
            while next < patch.len() {
                let (row, column) = (patch[next] / width, patch[next] % width);
                next += 1;
                for row in row.saturating_sub(1)..height.min(row + 2) {
                    for column in column.saturating_sub(1)..width.min(column + 2) {
                        if std::mem::take(&mut is_open[row * width + column]) {
                            patch.push(row * width + column);
                        }
                    }
                }
            }
            patches.push(patch);
        }
        patches
    }
}

/// Returns the pixels of things: connected patches of pixels that differ, of which at least `least` differ strongly, without gaps and
/// with their edges.
pub(super) fn things(differ: &Bits, strongly: &Bits, least: usize) -> Bits {
    let dense = differ.with_at_least(LEAST_AROUND, 1).and(differ);
    let mut kept = Bits::new(differ.width, vec![false; differ.pixels.len()]);
    for patch in dense.patches() {
        if patch.iter().filter(|pixel| strongly.pixels[**pixel]).count() >= least {
            patch.into_iter().for_each(|pixel| kept.pixels[pixel] = true);
        }
    }
    kept.dilated(CLOSED_PX + EDGE_PX).eroded(CLOSED_PX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(rows: &[&str]) -> Bits {
        let pixels = rows.iter().flat_map(|row| row.bytes().map(|letter| letter != b'.')).collect();
        Bits::new(rows[0].len(), pixels)
    }

    #[test]
    fn squares_of_neighbours_are_counted_to_the_border() {
        let one = bits(&["#....", ".....", "....."]);
        assert_eq!(one.dilated(1), bits(&["##...", "##...", "....."]));
        assert_eq!(one.dilated(1).eroded(1), bits(&["#....", ".....", "....."]));
        assert_eq!(bits(&["##.", "##.", "..."]).with_at_least(4, 1), bits(&["##.", "##.", "..."]));
    }

    #[test]
    fn patches_are_connected_over_corners() {
        let mut sizes: Vec<usize> = bits(&["#..#", ".#..", "...#"]).patches().iter().map(Vec::len).collect();
        sizes.sort_unstable();
        assert_eq!(sizes, [1, 1, 2]);
    }

    #[test]
    fn things_are_solid_and_noise_and_faint_patches_are_none() {
        let differ = bits(&[
            "....................",
            ".###...........###..",
            ".###..#........###..",
            ".###...........###..",
            "....................",
            "....................",
            "....................",
        ]);
        let strongly = bits(&[
            "....................",
            "...............###..",
            "......#.............",
            "....................",
            "....................",
            "....................",
            "....................",
        ]);
        let found = things(&differ, &strongly, 3);
        assert!(found.pixels[20 + 16] && found.pixels[4 * 20 + 18], "the thing and its edge");
        assert!(!found.pixels[20 + 2] && !found.pixels[2 * 20 + 6]);
    }
}
