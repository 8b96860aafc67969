//! Filling of pixels that no neighbour saw, by smooth continuation from those around them.
//!
//! The pull-push method (Gortler et al., 1996): the picture is halved again and again, averaging only known pixels,
//! until all pixels are known; on the way back every unknown pixel takes the colour of the coarser picture.

use rayon::prelude::*;

use super::Origin;

/// Number of pixels per task: enough work to outweigh the cost of starting it.
const PIXELS_A_TASK: usize = 16384;

/// Picture of colours with weights, 0 for unknown pixels.
struct Level {
    width: usize,
    height: usize,
    /// Red, green, blue, weight.
    pixels: Vec<[f32; 4]>,
}

/// Fills the pixels whose source is [`Origin::NOWHERE`], in rows of this width. Does nothing if no pixel was recorded at all.
pub fn fill(colors: &mut [[u8; 3]], origins: &[Origin], width: usize) {
    let blocks = Blocks::new(origins, width);
    if !blocks.all.iter().any(|block| block.has_unknown) || !blocks.all.iter().any(|block| block.has_recorded)
    {
        return;
    }
    let filled = half_size(colors, origins, width, &blocks).filled();
    let rows = colors.par_chunks_mut(width).zip(origins.par_chunks(width)).enumerate();
    rows.with_min_len(PIXELS_A_TASK.div_ceil(width)).for_each(|(v, (row, origins))| {
        let parts = row.chunks_mut(BLOCK).zip(origins.chunks(BLOCK)).enumerate();
        for (column, (colors, origins)) in
            parts.filter(|(column, _)| blocks.at(*column, v / BLOCK).has_unknown)
        {
            let found = filled.twice_as_fine(column * BLOCK, v);
            for ((color, origin), found) in colors.iter_mut().zip(origins).zip(found) {
                if is_unknown(origin) {
                    *color = [0, 1, 2].map(|channel| (found[channel] + 0.5) as u8);
                }
            }
        }
    });
}

fn is_unknown(origin: &Origin) -> bool {
    origin.source == Origin::NOWHERE
}

/// Columns and rows of a block of pixels: a pixel takes at most the third level of halved pictures from within 14 pixels of it
/// (2 + 4 + 8), and of what is farther away only blocks as a whole.
const BLOCK: usize = 16;

/// What is known of a block.
struct Block {
    has_unknown: bool,
    has_recorded: bool,
    /// Whether all of it was recorded and nothing beside it is unknown: only its mean matters.
    is_far: bool,
}

/// Blocks of a picture, row by row.
struct Blocks {
    columns: usize,
    all: Vec<Block>,
}

impl Blocks {
    fn new(origins: &[Origin], width: usize) -> Self {
        let columns = width.div_ceil(BLOCK);
        let rows = origins.par_chunks(BLOCK * width);
        let all = rows.flat_map_iter(|rows| (0..columns).map(move |column| block(rows, width, column)));
        let mut blocks = Self { columns, all: all.collect() };
        blocks.find_far();
        blocks
    }

    fn at(&self, column: usize, row: usize) -> &Block {
        &self.all[row * self.columns + column]
    }

    /// Keeps those blocks far that have nothing unknown beside them.
    fn find_far(&mut self) {
        let rows = self.all.len() / self.columns;
        for index in 0..self.all.len() {
            let (column, row) = (index % self.columns, index / self.columns);
            let beside = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
            let is_clear = beside(row, rows)
                .all(|row| beside(column, self.columns).all(|column| !self.at(column, row).has_unknown));
            self.all[index].is_far &= is_clear;
        }
    }
}

/// Examines a block of a row of blocks; whether it is far is said by itself alone.
fn block(rows: &[Origin], width: usize, column: usize) -> Block {
    let (mut unknown, mut recorded, mut all) = (0, 0, 0);
    for row in rows.chunks(width) {
        let part = &row[column * BLOCK..width.min((column + 1) * BLOCK)];
        all += part.len();
        for origin in part {
            unknown += usize::from(is_unknown(origin));
            recorded += usize::from(origin.is_recorded());
        }
    }
    let is_far = recorded == all && all == BLOCK * BLOCK;
    Block { has_unknown: unknown > 0, has_recorded: recorded > 0, is_far }
}

/// Returns a picture at half its size. The full size is never converted to floats, and far blocks are only summed up: memory
/// access takes most of the time. The shader averages every pixel: what is filled is the same.
fn half_size(colors: &[[u8; 3]], origins: &[Origin], width: usize, blocks: &Blocks) -> Level {
    let height = colors.len() / width;
    let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
    let mut pixels = vec![[0.0_f32; 4]; half_width * half_height];
    let block_rows = pixels.par_chunks_mut(BLOCK / 2 * half_width).enumerate();
    block_rows.for_each(|(row, pixels)| {
        for column in 0..blocks.columns {
            let part = column * BLOCK / 2..half_width.min((column + 1) * BLOCK / 2);
            if blocks.at(column, row).is_far {
                let mean = block_mean(colors, width, column, row);
                pixels.chunks_mut(half_width).for_each(|pixels| pixels[part.clone()].fill(mean));
                continue;
            }
            for (v, pixels) in pixels.chunks_mut(half_width).enumerate() {
                let v = row * BLOCK + 2 * v;
                halve_row(colors, origins, width, [column * BLOCK, v], &mut pixels[part.clone()]);
            }
        }
    });
    Level { width: half_width, height: half_height, pixels }
}

/// Returns the mean of a whole block that was recorded, with a weight of 1.
fn block_mean(colors: &[[u8; 3]], width: usize, column: usize, row: usize) -> [f32; 4] {
    // All bytes of a row of the block beside each other, which takes vectors.
    let mut sums = [0u16; 3 * BLOCK];
    for v in row * BLOCK..(row + 1) * BLOCK {
        let first = v * width + column * BLOCK;
        let bytes = colors[first..first + BLOCK].as_flattened();
        sums.iter_mut().zip(bytes).for_each(|(sum, byte)| *sum += u16::from(*byte));
    }
    let mean = |channel: usize| {
        let sum: u32 = sums.iter().skip(channel).step_by(3).map(|sum| u32::from(*sum)).sum();
        sum as f32 / (BLOCK * BLOCK) as f32
    };
    [mean(0), mean(1), mean(2), 1.0]
}

/// Sets pixels of a row of the picture at half its size from those at and after a place.
fn halve_row(
    colors: &[[u8; 3]],
    origins: &[Origin],
    width: usize,
    [u, v]: [usize; 2],
    pixels: &mut [[f32; 4]],
) {
    let end = width.min(u + 2 * pixels.len());
    let height = colors.len() / width;
    let rows = [v, (v + 1).min(height - 1)].map(|row| row * width + u..row * width + end);
    let [upper, lower] = rows.map(|row| colors[row.clone()].chunks(2).zip(origins[row].chunks(2)));
    // The last row of an odd number has none below it.
    let lower_counts = u64::from(v + 1 < height);
    for (pixel, (upper, lower)) in pixels.iter_mut().zip(upper.zip(lower)) {
        *pixel = mean(known_sum(upper.0, upper.1) + lower_counts * known_sum(lower.0, lower.1));
    }
}

/// Returns the sums of red, green and blue of known pixels and their number, sixteen bits each: at most four pixels fit.
fn known_sum(colors: &[[u8; 3]], origins: &[Origin]) -> u64 {
    let spread = |[red, green, blue]: [u8; 3]| {
        u64::from(red) | u64::from(green) << 16 | u64::from(blue) << 32 | 1 << 48
    };
    let known = colors.iter().zip(origins);
    known.map(|(color, origin)| if origin.is_recorded() { spread(*color) } else { 0 }).sum()
}

/// Returns the mean colour of summed pixels, and a weight of 1 if there are any.
fn mean(sum: u64) -> [f32; 4] {
    let part = |number: u32| f32::from((sum >> (16 * number)) as u16);
    let count = part(3);
    let share = 1.0 / count.max(1.0);
    [part(0) * share, part(1) * share, part(2) * share, count.min(1.0)]
}

/// Returns a level at half its size.
fn halved(fine: &Level) -> Level {
    Level::by_rows(fine.width.div_ceil(2), fine.height.div_ceil(2), |v, sums| {
        for row in fine.pixels.chunks(fine.width).skip(2 * v).take(2) {
            row.iter().enumerate().for_each(|(u, pixel)| add(&mut sums[u / 2], *pixel));
        }
    })
}

fn add(sum: &mut [f32; 4], pixel: [f32; 4]) {
    sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
}

/// Gives unknown pixels the bilinear colour of the next coarser level, all of which is known.
fn take_unknown(fine: &mut Level, coarse: &Level) {
    let width = fine.width;
    let rows = fine.pixels.par_chunks_mut(width).enumerate().with_min_len(PIXELS_A_TASK.div_ceil(width));
    rows.for_each(|(v, row)| {
        let parts = row.chunks_mut(BLOCK).enumerate();
        for (column, part) in parts.filter(|(_, part)| part.iter().any(|pixel| pixel[3] == 0.0)) {
            let found = coarse.twice_as_fine(column * BLOCK, v);
            for (pixel, found) in part.iter_mut().zip(found).filter(|(pixel, _)| pixel[3] == 0.0) {
                *pixel = found;
            }
        }
    });
}

impl Level {
    /// Makes a level from rows of weighted sums of colours, scaled so that no weight exceeds 1.
    fn by_rows(width: usize, height: usize, sum_up: impl Fn(usize, &mut [[f32; 4]]) + Sync) -> Self {
        let mut pixels = vec![[0.0_f32; 4]; width * height];
        let rows = pixels.par_chunks_mut(width).enumerate().with_min_len(PIXELS_A_TASK.div_ceil(width));
        rows.for_each(|(v, sums)| {
            sum_up(v, sums);
            for sum in sums {
                let scale = 1.0 / sum[3].max(1.0);
                *sum = sum.map(|value| value * scale);
            }
        });
        Self { width, height, pixels }
    }

    /// Returns the same level with all pixels known, if any is known.
    fn filled(mut self) -> Self {
        if self.pixels.iter().any(|pixel| pixel[3] == 0.0) && self.pixels.len() > 1 {
            let coarse = halved(&self).filled();
            take_unknown(&mut self, &coarse);
        }
        self
    }

    /// Returns the bilinear colours of a row of a block of the next finer level, from an even column on. All of this level is known.
    fn twice_as_fine(&self, u: usize, v: usize) -> [[f32; 4]; BLOCK] {
        // The centre of a coarse pixel lies between two fine ones: three quarters of its own, one quarter of the next.
        let mix = |own: [f32; 4], next: [f32; 4]| -> [f32; 4] {
            std::array::from_fn(|channel| 0.75 * own[channel] + 0.25 * next[channel])
        };
        let own = v / 2;
        let next = if v.is_multiple_of(2) { own.saturating_sub(1) } else { (own + 1).min(self.height - 1) };
        let row = |row: usize| &self.pixels[row * self.width..][..self.width];
        let (own, next) = (row(own), row(next));
        // The coarse pixels below the block, and one more on either side.
        let mut coarse = [[0.0; 4]; BLOCK / 2 + 2];
        for (i, coarse) in coarse.iter_mut().enumerate() {
            let column = (u / 2 + i).saturating_sub(1).min(self.width - 1);
            *coarse = mix(own[column], next[column]);
        }
        let mut fine = [[0.0; 4]; BLOCK];
        for (i, pair) in fine.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            *pair = [mix(coarse[i + 1], coarse[i]), mix(coarse[i + 1], coarse[i + 2])];
        }
        fine
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn far_blocks_change_nothing_that_is_filled(
            size in (60_usize..150, 40_usize..110), holes in prop::collection::vec((0.0..1.0, 0.0..1.0, 1.0..30.0), 1..4),
            outside_px in 0.0..40.0, waves in prop::array::uniform3(0.02..0.6),
        ) {
            let (width, height) = size;
            let pixel = |index: usize| [(index % width) as f64, (index / width) as f64];
            let origin = |index: usize| {
                let [u, v] = pixel(index);
                let is_hole = |(x, y, radius): &(f64, f64, f64)| (u - x * width as f64).hypot(v - y * height as f64) < *radius;
                let source = match () {
                    () if u + v < outside_px => Origin::OUTSIDE,
                    () if holes.iter().any(is_hole) => Origin::NOWHERE,
                    () => 0,
                };
                Origin { source, trust: 0 }
            };
            let color = |index: usize| {
                let [u, v] = pixel(index);
                waves.map(|wave: f64| (128.0 + 100.0 * (wave * u).sin() * (wave * v).cos()) as u8)
            };
            let origins: Vec<Origin> = (0..width * height).map(origin).collect();
            let colors: Vec<[u8; 3]> = (0..width * height).map(color).collect();
            let blocks = Blocks::new(&origins, width);
            let mut near = Blocks::new(&origins, width);
            near.all.iter_mut().for_each(|block| block.is_far = false);
            let [quick, plain] =
                [&blocks, &near].map(|blocks| half_size(&colors, &origins, width, blocks).filled());
            for index in (0..width * height).filter(|index| is_unknown(&origins[*index])) {
                let (u, v) = (index % width, index / width);
                let [quick, plain] = [&quick, &plain].map(|level| level.twice_as_fine(u / BLOCK * BLOCK, v)[u % BLOCK]);
                prop_assert!((0..3).all(|channel| (quick[channel] - plain[channel]).abs() < 0.01));
            }
        }
    }
}
