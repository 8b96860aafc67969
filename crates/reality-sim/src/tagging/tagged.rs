//! A recording with poses.

use std::sync::Arc;

use reality_sim_calibration::assess_frames;
use reality_sim_core::{
    localization::{LocalizedFrame, Localizer, Playback},
    pose::CameraPose,
    quality::{LineAgreement, RecordingQuality},
    sequence::Sequence,
};

use super::{LinesOfPictures, TagError, TagSettings, TaggedPose};
use crate::evaluation::ErrorStatistics;

/// Poses of a recording's pictures.
#[derive(Debug)]
pub struct Tagged {
    /// What the filter said of every picture.
    pub frames: Vec<LocalizedFrame>,
    /// Resulting pose of every picture.
    pub poses: Vec<TaggedPose>,
    /// Agreement of every pose with the lines of its picture.
    pub lines: Vec<LineAgreement>,
    /// Errors against the recording's reference poses, if it has any.
    pub error: Option<ErrorStatistics>,
}

impl Tagged {
    /// Returns the agreement of all poses with the pictures.
    pub fn quality(&self) -> RecordingQuality {
        RecordingQuality::new(self.lines.iter().copied().zip(self.frames.iter().map(|frame| frame.settled)))
    }
}

/// Filter on its way through a recording.
struct Run {
    settings: TagSettings,
    localizer: Localizer,
    frames: Vec<LocalizedFrame>,
    lines: LinesOfPictures,
}

/// Tags a recording, on the processor, once with each of the settings. Every picture is decoded once for all of them.
pub fn tag(sequence: &Sequence, settings: &[TagSettings]) -> Result<Vec<Tagged>, TagError> {
    let runs = settings.iter().map(|settings| Run::start(sequence, settings));
    let mut runs = runs.collect::<Result<Vec<_>, _>>()?;
    for observation in Playback::new(Arc::new(sequence.clone())) {
        let observation = observation?;
        for run in &mut runs {
            let frame = run.localizer.update(&observation)?;
            run.lines.add(&run.localizer, frame.pose);
            run.frames.push(frame);
        }
    }
    runs.into_iter().map(|run| run.finish(sequence)).collect()
}

impl Run {
    fn start(sequence: &Sequence, settings: &TagSettings) -> Result<Self, TagError> {
        let localizer = Localizer::builder(&sequence.setup.camera, &sequence.field)
            .config(settings.config())
            .start(sequence.start.filter(|_| settings.known_start))
            .calibration(sequence.calibration.clone())
            .build()?;
        let lines = LinesOfPictures::new(sequence, settings.smooth);
        Ok(Self { settings: settings.clone(), localizer, frames: Vec::new(), lines })
    }

    fn finish(self, sequence: &Sequence) -> Result<Tagged, TagError> {
        let Self { settings, localizer, mut frames, lines } = self;
        if settings.calibration_errors {
            assess_frames(sequence, &mut frames).map_err(|error| TagError::Sequence(*error))?;
        }
        let poses = if settings.smooth {
            let nothing = || TagError::NothingToSmooth { folder: sequence.folder.clone() };
            TaggedPose::smoothed(sequence, &localizer, &frames)?.ok_or_else(nothing)?
        } else {
            TaggedPose::filtered(&frames)
        };
        let plain: Vec<CameraPose> = poses.iter().map(|tagged| tagged.pose).collect();
        let lines = lines.agreement(&plain);
        Ok(Tagged { error: ErrorStatistics::of(sequence, &plain), frames, poses, lines })
    }
}
