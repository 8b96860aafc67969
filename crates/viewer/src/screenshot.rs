//! Screenshots of the window, as PNG files in the current folder.

use std::{
    fs::File,
    io,
    path::{Path, PathBuf},
    sync::mpsc,
};

use eframe::egui::{Color32, ColorImage, Context};
use image::RgbaImage;

/// State of the requested screenshot.
#[derive(Default)]
pub struct Screenshot {
    answers: Vec<mpsc::Receiver<Result<PathBuf, String>>>,
}

impl Screenshot {
    /// Requests a screenshot: the next frame is captured and written by its own thread.
    pub fn take(&mut self, ctx: &Context) {
        let (sender, receiver) = mpsc::channel();
        let repaint = ctx.clone();
        ctx.request_screenshot(move |picture| {
            std::thread::spawn(move || {
                // The receiver is gone once the window is closed.
                let _ = sender.send(save_here(&picture));
                repaint.request_repaint();
            });
        });
        self.answers.push(receiver);
    }

    /// Returns the path of a written screenshot, once.
    pub fn poll(&mut self) -> Option<Result<PathBuf, String>> {
        let answers = self.answers.iter().map(mpsc::Receiver::try_recv).enumerate();
        let (place, answer) =
            answers.into_iter().find(|(_, answer)| *answer != Err(mpsc::TryRecvError::Empty))?;
        self.answers.remove(place);
        Some(answer.unwrap_or_else(|_| Err("the window gave no picture: try it again".to_owned())))
    }
}

fn save_here(picture: &ColorImage) -> Result<PathBuf, String> {
    let folder = std::env::current_dir().map_err(|error| format!("the current folder: {error}"))?;
    save(picture, &folder)
}

/// Writes a picture to a folder, under a new file name.
fn save(picture: &ColorImage, folder: &Path) -> Result<PathBuf, String> {
    let bytes = picture.pixels.iter().flat_map(Color32::to_array).collect();
    let [width, height] = picture.size.map(|pixels| pixels as u32);
    let image = RgbaImage::from_raw(width, height, bytes).ok_or("the window gave an incomplete picture")?;
    let image = image::DynamicImage::from(image).into_rgb8();
    let path = free_name(folder).map_err(|error| {
        format!(
            "{}: a screenshot cannot be written here: {error}: start the viewer in a folder of yours",
            folder.display()
        )
    })?;
    match reality_sim_core::sequence::save_image(&path, &image) {
        Ok(()) => Ok(path),
        Err(error) => {
            // The reserved name is released; the error has been reported already.
            let _ = std::fs::remove_file(&path);
            Err(error.to_string())
        }
    }
}

/// Reserves the first free name in a sequence by creating an empty file, so that two screenshots never share a name.
fn free_name(folder: &Path) -> io::Result<PathBuf> {
    for number in 1_u32.. {
        let path = folder.join(format!("reality-sim-{number}.png"));
        match File::create_new(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            created => return created.map(|_| path),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::tempdir;

    use super::*;

    /// Returns three pixels in a row.
    fn picture() -> ColorImage {
        ColorImage::new([3, 1], vec![Color32::RED, Color32::from_rgb(1, 2, 3), Color32::WHITE])
    }

    #[test]
    fn the_file_holds_the_pixels_of_the_window() {
        let folder = tempdir().unwrap();
        let path = save(&picture(), folder.path()).unwrap();
        assert_eq!(path.parent(), Some(folder.path()));
        let read = image::open(path).unwrap().into_rgb8();
        assert_eq!(read.dimensions(), (3, 1));
        assert_eq!(read.into_raw(), [255, 0, 0, 1, 2, 3, 255, 255, 255]);
    }

    #[test]
    fn a_file_that_is_there_is_never_overwritten() {
        let folder = tempdir().unwrap();
        let mine = folder.path().join("reality-sim-1.png");
        fs::write(&mine, "mine").unwrap();
        let paths: Vec<PathBuf> = (0..3).map(|_| save(&picture(), folder.path()).unwrap()).collect();
        let names = ["reality-sim-2.png", "reality-sim-3.png", "reality-sim-4.png"];
        assert_eq!(paths, names.map(|name| folder.path().join(name)));
        assert_eq!(fs::read_to_string(mine).unwrap(), "mine");
    }

    #[test]
    fn pictures_saved_at_the_same_time_get_names_of_their_own() {
        let folder = tempdir().unwrap();
        let save = || save(&picture(), folder.path()).unwrap();
        let mut paths: Vec<PathBuf> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(save)).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        paths.sort();
        paths.dedup();
        assert_eq!(paths.len(), 8);
        assert!(paths.iter().all(|path| image::open(path).is_ok()));
    }

    #[test]
    fn a_folder_that_cannot_be_written_to_is_named_with_a_way_out() {
        let folder = tempdir().unwrap();
        // A file in place of the folder, not a folder without permissions: root may write to those.
        let no_folder = folder.path().join("a-file");
        fs::write(&no_folder, "").unwrap();
        let reason = save(&picture(), &no_folder).unwrap_err();
        assert!(reason.contains("a-file") && reason.contains("start the viewer in"), "{reason}");
        assert_eq!(reason.lines().count(), 1, "{reason}");
    }

    #[test]
    fn an_incomplete_picture_leaves_no_file() {
        let folder = tempdir().unwrap();
        let mut picture = picture();
        picture.pixels.pop();
        save(&picture, folder.path()).unwrap_err();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_window_that_gives_no_picture_is_a_problem_once() {
        let (sender, receiver) = mpsc::channel();
        let mut screenshot = Screenshot { answers: vec![receiver] };
        assert!(screenshot.poll().is_none());
        drop(sender);
        assert!(matches!(screenshot.poll(), Some(Err(_))));
        assert!(screenshot.poll().is_none());
    }
}
