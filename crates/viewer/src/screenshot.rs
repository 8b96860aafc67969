//! A picture of the window, as a PNG in the current folder.

use std::{path::PathBuf, sync::mpsc};

use eframe::egui::{ColorImage, Context};
use image::RgbaImage;

/// A picture that was asked for.
#[derive(Default)]
pub struct Screenshot {
    answer: Option<mpsc::Receiver<Result<PathBuf, String>>>,
}

impl Screenshot {
    /// Asks for one: the next frame is taken, and written by a thread of its own.
    pub fn take(&mut self, ctx: &Context) {
        let (sender, receiver) = mpsc::channel();
        let repaint = ctx.clone();
        ctx.request_screenshot(move |picture| {
            std::thread::spawn(move || {
                // Nobody listens any more once the window is closed.
                let _ = sender.send(save(&picture));
                repaint.request_repaint();
            });
        });
        self.answer = Some(receiver);
    }

    /// Where it went, once.
    pub fn poll(&mut self) -> Option<Result<PathBuf, String>> {
        let answer = self.answer.as_ref()?.try_recv().ok()?;
        self.answer = None;
        Some(answer)
    }
}

fn save(picture: &ColorImage) -> Result<PathBuf, String> {
    let path = free_name()?;
    let bytes = picture.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    let [width, height] = picture.size.map(|pixels| pixels as u32);
    let image = RgbaImage::from_raw(width, height, bytes).ok_or("the window gave an incomplete picture")?;
    let image = image::DynamicImage::from(image).into_rgb8();
    reality_sim_core::sequence::save_image(&path, &image).map_err(|error| error.to_string())?;
    Ok(path)
}

/// The first name of a row that no file has yet.
fn free_name() -> Result<PathBuf, String> {
    let folder = std::env::current_dir().map_err(|error| format!("the current folder: {error}"))?;
    let mut names = (1_u32..).map(|number| folder.join(format!("reality-sim-{number}.png")));
    names.find(|path| !path.exists()).ok_or_else(|| "no name is free".to_owned())
}
