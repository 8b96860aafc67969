//! Worlds of the study: the light of the last one is kept for the next run.

use std::{error::Error, path::Path};

use reality_sim::Sequence;
use reality_sim_hidden::{Hidden, Random, Recipe, Takes};

use crate::plan::{Chosen, Task};

/// Difference of a colour, in grey levels, above which a pixel counts as changed. Both recordings have the same noise.
const DIFFERS: u8 = 6;
/// Least fraction of pixels that differ, averaged over the pictures, from the same recording with nothing hidden.
const LEAST_PART: f64 = 0.005;

/// Maker of recordings.
#[derive(Default)]
pub struct Studio {
    last: Option<(Recipe, Takes)>,
}

impl Studio {
    /// Records a task's world with these effects hidden.
    pub fn record(
        &mut self,
        task: &Task,
        effects: &[Hidden],
        folder: &Path,
    ) -> Result<Sequence, Box<dyn Error>> {
        Ok(self.takes(task)?.record(effects, folder)?)
    }

    /// Whether the pictures show an effect that no library has: a missing line may never have been in view.
    pub fn is_in_sight(&mut self, task: &Task, effects: &[Hidden]) -> Result<bool, Box<dyn Error>> {
        let folders = [tempfile::tempdir()?, tempfile::tempdir()?];
        let with = self.record(task, effects, folders[0].path())?;
        let without = self.record(task, &[], folders[1].path())?;
        let (mut differing, mut pixels) = (0, 0);
        for index in 0..with.frames.len() {
            let (one, other) = (with.load_image(index)?, without.load_image(index)?);
            let pairs = one.pixels().zip(other.pixels());
            let differs = |a: &[u8; 3], b: &[u8; 3]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > DIFFERS);
            differing += pairs.filter(|(a, b)| differs(&a.0, &b.0)).count();
            pixels += one.pixels().len();
        }
        Ok(differing as f64 > LEAST_PART * pixels as f64)
    }

    fn takes(&mut self, task: &Task) -> Result<&Takes, Box<dyn Error>> {
        let recipe = task.recipe();
        let kept = self.last.take().filter(|(last, _)| *last == recipe);
        let (recipe, takes) = match kept {
            Some(kept) => kept,
            None => {
                let takes = recipe.takes()?;
                (recipe, takes)
            }
        };
        Ok(&self.last.insert((recipe, takes)).1)
    }
}

/// Returns these effects; the seed draws their signs and shapes.
pub fn effects(task: &Task, hidden: &[Chosen]) -> Result<Vec<Hidden>, Box<dyn Error>> {
    let mut random = Random::new(task.seed.wrapping_mul(77));
    let drawn = hidden.iter().map(|chosen| Hidden::of(&chosen.id, chosen.multiple, &mut random));
    Ok(drawn.collect::<Result<_, _>>()?)
}
