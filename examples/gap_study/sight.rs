//! Check that an effect outside the library is visible in the pictures: a missing line may never have been in view.

use std::error::Error;

use crate::{
    plan::{Chosen, Task},
    run::record,
};

/// Difference of a colour, in grey levels, above which a pixel counts as changed. Both recordings have the same noise.
const DIFFERS: u8 = 6;
/// Least fraction of pixels that differ, averaged over the pictures, from the same recording with nothing hidden.
const LEAST_PART: f64 = 0.005;

/// Whether the pictures show a hidden effect.
pub fn is_in_sight(task: &Task, hidden: &Chosen) -> Result<bool, Box<dyn Error>> {
    let folders = [tempfile::tempdir()?, tempfile::tempdir()?];
    let (with, _) = record(task, std::slice::from_ref(hidden), folders[0].path())?;
    let (without, _) = record(task, &[], folders[1].path())?;
    let (mut differing, mut pixels) = (0, 0);
    for index in 0..task.frames {
        let (one, other) = (with.load_image(index)?, without.load_image(index)?);
        let pairs = one.pixels().zip(other.pixels());
        let differs = |a: &[u8; 3], b: &[u8; 3]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > DIFFERS);
        differing += pairs.filter(|(a, b)| differs(&a.0, &b.0)).count();
        pixels += one.pixels().len();
    }
    Ok(differing as f64 > LEAST_PART * pixels as f64)
}
