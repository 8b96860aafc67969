//! Writes a recording with hidden effects.
//!
//! `hidden_recording FOLDER SEED WIDTH FRAMES [EFFECT MULTIPLE]…` writes one in a standard world, with effects at multiples of
//! their unit sizes. `hidden_recording --drawn FOLDER SEED WIDTH FRAMES [EFFECT MULTIPLE]…` writes it in a drawn world, and
//! says in `hidden.json` what is hidden.

use std::{env, error::Error, fs, path::PathBuf};

use reality_sim_hidden::{Hidden, Random, Recipe, World};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = env::args().skip(1).collect();
    let is_drawn = arguments.first().is_some_and(|first| first == "--drawn");
    if is_drawn {
        arguments.remove(0);
    }
    let [folder, seed, width, frames, effects @ ..] = arguments.as_slice() else {
        return Err("usage: hidden_recording [--drawn] FOLDER SEED WIDTH FRAMES [EFFECT MULTIPLE]…".into());
    };
    let (folder, seed, width): (PathBuf, u64, u32) = (folder.into(), seed.parse()?, width.parse()?);
    let mut recipe = Recipe { frames: frames.parse()?, size: [width, width * 3 / 4], ..Recipe::new(seed) };
    // The effects are drawn as in the study.
    let mut random = Random::new(seed.wrapping_mul(77));
    for pair in effects.chunks_exact(2) {
        recipe.effects.push(Hidden::of(&pair[0], pair[1].parse()?, &mut random)?);
    }
    if is_drawn {
        recipe.world = World::Drawn;
    }
    recipe.record(&folder)?;
    if is_drawn {
        let hidden = recipe.effects.iter().map(|effect| format!("  {:?}: \"{effect:?}\"", effect.id()));
        let hidden = hidden.collect::<Vec<_>>().join(",\n");
        fs::write(folder.join("hidden.json"), format!("{{\n{hidden}\n}}\n"))?;
    }
    Ok(())
}
