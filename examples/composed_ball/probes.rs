//! Pictures at the same poses without and with a ball.

use std::path::Path;

use anyhow::{Context, ensure};
use image::RgbImage;
use reality_sim::{CameraPose, Sequence};

/// Probe with both true pictures.
pub struct Probe {
    pub number: usize,
    pub pose: CameraPose,
    /// Centre of the ball, metres; z is its radius.
    pub ball: [f64; 3],
    pub empty: RgbImage,
    pub truth: RgbImage,
}

/// Reads the probes of two folders.
pub fn read_probes(empty: &Path, balls: &Path) -> anyhow::Result<Vec<Probe>> {
    let places = std::fs::read_to_string(balls.join("balls.json"))
        .with_context(|| balls.join("balls.json").display().to_string())?;
    let places: Vec<[f64; 3]> = serde_json::from_str(&places)?;
    let (empty, balls) = (Sequence::open(empty)?, Sequence::open(balls)?);
    ensure!(
        places.len() == balls.frames.len() && places.len() == empty.frames.len(),
        "the folders hold different numbers of pictures"
    );
    let probe = |(number, ball): (usize, [f64; 3])| {
        let pose = balls.frames[number].reference_pose.context("the probes need ground truth")?;
        let [empty, truth] = [&empty, &balls].map(|sequence| sequence.load_image(number));
        Ok(Probe { number, pose, ball, empty: empty?, truth: truth? })
    };
    places.into_iter().enumerate().map(probe).collect()
}
