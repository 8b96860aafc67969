//! Writes a recording: `hidden_recording FOLDER SEED WIDTH FRAMES [EFFECT MULTIPLE]…`.

use std::{env, error::Error, path::PathBuf};

use reality_sim_hidden::{Hidden, Random, Recipe};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, seed, width, frames, effects @ ..] = arguments.as_slice() else {
        return Err("usage: hidden_recording FOLDER SEED WIDTH FRAMES [EFFECT MULTIPLE]…".into());
    };
    let (seed, width): (u64, u32) = (seed.parse()?, width.parse()?);
    let mut recipe = Recipe { frames: frames.parse()?, size: [width, width * 3 / 4], ..Recipe::new(seed) };
    // The effects are drawn as in the study.
    let mut random = Random::new(seed.wrapping_mul(77));
    for pair in effects.chunks_exact(2) {
        recipe.effects.push(Hidden::of(&pair[0], pair[1].parse()?, &mut random)?);
    }
    recipe.record(&PathBuf::from(folder))?;
    Ok(())
}
