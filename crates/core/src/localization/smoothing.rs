//! Smoothing: the poses of a whole recording are estimated together, from past and future pictures.

use super::{config::LocalizerConfig, frame::LocalizedFrame, localizer::Localizer, picture::Picture};
use crate::{
    preprocess::{Preprocessor, Texture},
    refine::{Reach, Refiner, SmoothedPose, TrajectoryFrame, smooth_trajectory},
};

/// Finds the most probable poses of all frames together, see [`smooth_trajectory`]. [`Localizer::smoother`] makes one.
#[derive(Debug)]
pub struct Smoother<'a> {
    config: &'a LocalizerConfig,
    preprocessor: &'a Preprocessor,
    refiner: &'a Refiner,
}

/// Frames after the first pass of smoothing, and what is known about each.
#[derive(Debug, Clone)]
pub struct Smoothing {
    frames: Vec<TrajectoryFrame>,
    unexplained: Vec<usize>,
}

impl Localizer {
    /// Returns a smoother for the frames that this localizer has found.
    pub fn smoother(&self) -> Smoother<'_> {
        Smoother { config: &self.config, preprocessor: &self.preprocessor, refiner: self.search.refiner() }
    }
}

impl Smoother<'_> {
    /// Returns the most probable poses of all frames together, one per frame. A picture whose own fit was missing or
    /// contradicts the others is fitted once more, starting from the pose that the others suggest; `picture` loads it
    /// by its index.
    ///
    /// Returns `None` if no picture could be fitted at all. Fails only if `picture` does.
    pub fn smooth<E>(
        &self,
        frames: &[LocalizedFrame],
        mut picture: impl FnMut(usize) -> Result<Picture, E>,
    ) -> Result<Option<Vec<SmoothedPose>>, E> {
        let Some(mut smoothing) = self.begin(frames) else { return Ok(None) };
        for index in smoothing.unexplained.clone() {
            self.revisit(&mut smoothing, index, &picture(index)?);
        }
        Ok(self.finish(&smoothing))
    }

    /// Runs the first pass, with the fits that the frames have. Returns `None` if there are none at all.
    pub fn begin(&self, frames: &[LocalizedFrame]) -> Option<Smoothing> {
        let least = self.config.track.fitting_line_fraction;
        let mut frames: Vec<TrajectoryFrame> = frames
            .iter()
            .map(|frame| TrajectoryFrame {
                guess: frame.pose,
                fit: frame.fit.filter(|_| frame.line_fraction >= least),
                mount: frame.mount,
                motion: frame.motion,
            })
            .collect();
        let smoothed = self.pass(&frames)?;
        for (frame, smoothed) in frames.iter_mut().zip(&smoothed) {
            frame.guess = smoothed.pose;
        }
        let unexplained = (0..frames.len()).filter(|&index| !smoothed[index].picture_used).collect();
        Some(Smoothing { frames, unexplained })
    }

    /// Fits a picture again, starting from the pose that the first pass found for it.
    ///
    /// # Panics
    ///
    /// If there is no frame with this index.
    pub fn revisit(&self, smoothing: &mut Smoothing, index: usize, picture: &Picture) {
        let frame = &mut smoothing.frames[index];
        let prepared = self.preprocessor.prepare(picture.pixels().clone(), frame.mount);
        let texture = Texture::pack(&prepared.whiteness);
        let contrast = f64::from(prepared.levels.contrast());
        frame.fit = self.refiner.fit(&texture, frame.guess, frame.mount, contrast, Reach::Wide);
    }

    /// Runs the second pass, with the pictures that were fitted again.
    pub fn finish(&self, smoothing: &Smoothing) -> Option<Vec<SmoothedPose>> {
        self.pass(&smoothing.frames)
    }

    fn pass(&self, frames: &[TrajectoryFrame]) -> Option<Vec<SmoothedPose>> {
        let LocalizerConfig { smoothing, mount_sigma, filter, .. } = self.config;
        smooth_trajectory(frames, smoothing, *mount_sigma, filter.noise)
    }
}

impl Smoothing {
    /// Returns the indices of the frames whose pictures the first pass could not use.
    pub fn unexplained(&self) -> &[usize] {
        &self.unexplained
    }
}
