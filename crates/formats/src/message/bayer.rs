//! Colours of pictures behind a filter that lets one colour through at each pixel.

/// Colours of the first two pixels of the first two rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pattern {
    /// Red green, green blue.
    Rggb,
    /// Blue green, green red.
    Bggr,
    /// Green blue, red green.
    Gbrg,
    /// Green red, blue green.
    Grbg,
}

impl Pattern {
    /// Returns the place of red in each square of four: column, row.
    fn red(self) -> [usize; 2] {
        match self {
            Self::Rggb => [0, 0],
            Self::Bggr => [1, 1],
            Self::Gbrg => [0, 1],
            Self::Grbg => [1, 0],
        }
    }

    /// Returns the colour of a pixel: 0 for red, 1 for green, 2 for blue.
    fn color(self, x: usize, y: usize) -> usize {
        let [red_x, red_y] = self.red();
        usize::from((x + red_x) % 2 == 1) + usize::from((y + red_y) % 2 == 1)
    }
}

/// Returns RGB values row by row: a colour that a pixel lacks is the mean of those around it that have it.
pub fn demosaiced(
    pattern: Pattern,
    width: usize,
    height: usize,
    pixel: impl Fn(usize, usize) -> u8,
) -> Vec<u8> {
    let mut rgb = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        for x in 0..width {
            let (mut sums, mut counts) = ([0_u32; 3], [0_u32; 3]);
            let own = pattern.color(x, y);
            for near_y in rows.clone() {
                for near_x in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    let color = pattern.color(near_x, near_y);
                    if color == own && (near_x, near_y) != (x, y) {
                        continue;
                    }
                    sums[color] += u32::from(pixel(near_x, near_y));
                    counts[color] += 1;
                }
            }
            rgb.extend([0, 1, 2].map(|color| (sums[color] / counts[color].max(1)) as u8));
        }
    }
    rgb
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_colour_is_found_behind_every_pattern() {
        for pattern in [Pattern::Rggb, Pattern::Bggr, Pattern::Gbrg, Pattern::Grbg] {
            let rgb = demosaiced(pattern, 5, 4, |x, y| [200, 100, 50][pattern.color(x, y)]);
            assert!(rgb.chunks(3).all(|pixel| pixel == [200, 100, 50]), "{pattern:?}: {rgb:?}");
        }
    }

    #[test]
    fn patterns_begin_as_their_names_say() {
        let names = [
            (Pattern::Rggb, [0, 1, 1, 2]),
            (Pattern::Bggr, [2, 1, 1, 0]),
            (Pattern::Gbrg, [1, 2, 0, 1]),
            (Pattern::Grbg, [1, 0, 2, 1]),
        ];
        for (pattern, expected) in names {
            let found = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| pattern.color(x, y));
            assert_eq!(found, expected, "{pattern:?}");
        }
    }
}
