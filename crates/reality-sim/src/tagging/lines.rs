//! Agreement of the poses of a recording with the lines of its pictures.

use reality_sim_core::{
    localization::Localizer,
    pose::CameraPose,
    preprocess::LinePoints,
    quality::{LineAgreement, LineMeter},
    sequence::Sequence,
};

/// Lines of the pictures of a recording, measured as they come.
#[derive(Debug)]
pub struct LinesOfPictures {
    meter: LineMeter,
    /// At the filter's poses.
    agreement: Vec<LineAgreement>,
    /// Lines of the pictures, 4 kB each, where the poses will change.
    points: Option<Vec<LinePoints>>,
}

impl LinesOfPictures {
    /// Makes a collection for a sequence. With `keeps_points` they can be measured again at other poses.
    pub fn new(sequence: &Sequence, keeps_points: bool) -> Self {
        let meter = LineMeter::new(&sequence.setup.camera, &sequence.field);
        Self { meter, agreement: Vec::new(), points: keeps_points.then(Vec::new) }
    }

    /// Adds the picture that has just been localized.
    pub fn add(&mut self, localizer: &Localizer, pose: CameraPose) {
        let points = localizer.line_points().unwrap_or_default();
        match &mut self.points {
            Some(all) => all.push(points),
            None => self.agreement.push(self.meter.measure(&points, pose)),
        }
    }

    /// Returns the agreement of every picture with its final pose.
    pub fn agreement(self, poses: &[CameraPose]) -> Vec<LineAgreement> {
        match self.points {
            Some(points) => {
                points.iter().zip(poses).map(|(points, pose)| self.meter.measure(points, *pose)).collect()
            }
            None => self.agreement,
        }
    }
}
