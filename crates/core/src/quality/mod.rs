//! Agreement of poses with pictures in pixels, line by line, as papers on broadcast cameras report it: how good poses are where
//! there is no ground truth.
//!
//! In the SoccerNet calibration challenge, and in the papers that follow it (Magera et al., "A Universal Protocol to Benchmark Camera
//! Calibration for Sports", 2024, arXiv 2404.09807; Gutiérrez-Pérez and Agudo, "PnLCalib", 2024, arXiv 2404.08401), a person has marked
//! points on each line of the field in a picture. A line is a *true positive* if all its points lie within t pixels of where the camera
//! projects it, and otherwise a false positive; so is a line that is projected and not marked. A line that is marked and not projected
//! is a false negative. JaC@t is the Jaccard index TP / (TP + FP + FN), averaged over the pictures for which there is a camera, and
//! *completeness* the fraction of those. Of the two ways to name the lines of a symmetric field, the better one counts.
//!
//! Here nobody has marked anything. The points are those of [`crate::preprocess::LinePoints`], found in the picture without the pose,
//! all over the carpet; they have no names, and each belongs to the nearest projected line within 25 px, five times the smaller
//! threshold. [`LineMeter`] counts, at a pose:
//!
//! | | |
//! |---|---|
//! | true positives | lines that are seen and of which nine tenths, by length in the picture, lie within t |
//! | false positives | the other lines that are seen, and those that should be seen and are not |
//! | false negatives | strokes of points that are farther than 25 px from every projected line |
//!
//! What differs: nine tenths instead of all, since a found point may be wrong and a marked one is not; a line counts as projected only
//! where it is broad enough to be found; goals do not count; an error of more than half the distance of two parallel lines may be
//! measured against the wrong one. A mirror pose is as good as the right one, as in the challenge. Pixels are those of the
//! picture, in the challenge of 960 × 540.
//!
//! Agreement is no proof: poses are fitted to the same lines, and take up part of a wrong camera. On the first 20 pictures of the demonstration
//! walk with a focal length 2 % off, `tag` finds poses that are 4.3 cm off on average, at which 93 % of the lines are met within 5 px; with one 6 % off,
//! 11 cm and 77 %.
//!
//! | type | |
//! |---|---|
//! | [`LineMeter`] | measures pictures of one camera on one field |
//! | [`LineAgreement`] | the counts of one picture |
//! | [`RecordingQuality`] | those of a recording as three fractions |
//! | [`Verdict`] | whether that is good, with the thresholds |
//!
//! ```
//! # use std::path::Path;
//! # use reality_sim_core::{localization::{Localizer, Observation}, quality::LineMeter, sequence::Sequence};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let walk = Sequence::open(Path::new("../../assets/walk"))?;
//! let mut localizer = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build()?;
//! let frame = localizer.update(&Observation::of_frame(&walk, 0, walk.load_image(0)?))?;
//!
//! let meter = LineMeter::new(&walk.setup.camera, &walk.field);
//! let lines = localizer.line_points().ok_or("there was a picture")?;
//! let agreement = meter.measure(&lines, frame.pose);
//! assert_eq!(agreement.fraction_within_5px(), Some(1.0));
//! # Ok(())
//! # }
//! ```

mod line_agreement;
mod line_meter;
mod projected_lines;
mod recording;
mod strokes;
mod verdict;

pub use self::{
    line_agreement::LineAgreement, line_meter::LineMeter, recording::RecordingQuality, verdict::Verdict,
};

#[cfg(test)]
mod tests;
