//! Draws a recording's frame as predicted by the model beside the real picture: `draw SEQUENCE FRAME OUT.png`.

use std::{error::Error, path::Path, time::Instant};

use image::{GenericImage, RgbImage};
use reality_sim_core::sequence::{Sequence, save_image};
use reality_sim_sensor::{Renderer, SceneColors};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, frame, out] = arguments.as_slice() else {
        return Err("usage: draw SEQUENCE FRAME OUT.png".into());
    };
    let sequence = Sequence::open(Path::new(folder))?;
    let frame: usize = frame.parse()?;
    let measured = sequence.load_image(frame)?;
    let pose = sequence.frames[frame].reference_pose.ok_or("the frame has no reference pose")?;
    let start = Instant::now();
    let colors = SceneColors::new(&sequence.setup, &sequence.field);
    let renderer = Renderer::new(&sequence.setup, &sequence.field, colors);
    let made_s = start.elapsed().as_secs_f64();
    let drawn = renderer.draw(pose)?;
    let start = Instant::now();
    let count = 50;
    for _ in 0..count {
        renderer.draw(pose)?;
    }
    let drawn_s = start.elapsed().as_secs_f64() / f64::from(count);
    eprintln!("renderer {:.1} ms, picture {:.1} ms", 1e3 * made_s, 1e3 * drawn_s);
    let (width, height) = drawn.dimensions();
    let mut both = RgbImage::new(2 * width, height);
    both.copy_from(&drawn, 0, 0)?;
    both.copy_from(&measured, width, 0)?;
    save_image(Path::new(out), &both)?;
    Ok(())
}
