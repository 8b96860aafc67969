//! Masks as run lengths, in COCO's compressed form.

use serde::Serialize;

/// Mask of a picture as the lengths of its runs, column by column, as pycocotools has it: runs of pixels outside and inside the mask
/// take turns, beginning outside. A length is written as its difference from the one two before it, in groups of five bits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Rle {
    /// Number of rows, then of columns.
    pub size: [u32; 2],
    /// Lengths of the runs.
    pub counts: String,
}

impl Rle {
    /// Encodes a mask of a picture; `is_inside` is asked for every pixel, by its number row by row.
    pub fn new([width, height]: [u32; 2], is_inside: impl Fn(usize) -> bool) -> Self {
        let mut runs: Vec<i64> = Vec::new();
        let (mut length, mut inside) = (0, false);
        for column in 0..width as usize {
            for row in 0..height as usize {
                if is_inside(row * width as usize + column) != inside {
                    runs.push(length);
                    (length, inside) = (0, !inside);
                }
                length += 1;
            }
        }
        runs.push(length);
        Self { size: [height, width], counts: compressed(&runs) }
    }
}

/// Writes run lengths as pycocotools' `rleToString` does.
fn compressed(runs: &[i64]) -> String {
    let mut text = String::new();
    for (index, run) in runs.iter().enumerate() {
        // The first three lengths are written as they are.
        let mut rest = if index > 2 { run - runs[index - 2] } else { *run };
        loop {
            let group = (rest & 0x1f) as u8;
            rest >>= 5;
            let goes_on = if group & 0x10 == 0 { rest != 0 } else { rest != -1 };
            text.push(char::from(48 + (group | if goes_on { 0x20 } else { 0 })));
            if !goes_on {
                break;
            }
        }
    }
    text
}
