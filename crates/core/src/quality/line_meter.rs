//! Measures how many lines of a picture a pose meets, in pixels.

use glam::DVec2;

use super::{
    line_agreement::LineAgreement,
    projected_lines::{ProjectedLine, ProjectedMark, nearest_piece, projected_lines, projected_marks},
    strokes::count_strokes,
};
use crate::{
    camera::Camera,
    field::{FieldDimensions, LineSample, sample_lines, visible_samples},
    pose::CameraPose,
    preprocess::LinePoints,
};

/// Distance within which a point belongs to a projected line, pixels: so much larger than what is asked that it does not decide it.
const REACH_PX: f64 = 25.0;
/// Part of a line, by its length in the picture, that has to lie within the threshold.
const PART: f64 = 0.9;
/// Minimum length at which a line is seen, pixels: five points.
const LEAST_SEEN_PX: f64 = 30.0;
/// Minimum length, broad enough to be found, at which a line should be seen, pixels: what is shorter is easily covered by a robot.
const LEAST_CLEAR_PX: f64 = 60.0;
/// Minimum length of a stroke that nothing explains, pixels: what is shorter may be a foot or a ball.
const LEAST_STROKE_PX: f64 = 50.0;
/// Distance between samples of the lines, on the ground in metres and in the picture in pixels.
const SPACING_M: f64 = 0.04;
const SPACING_PX: f64 = 6.0;

/// Measures pictures of one camera on one field; [`super`] has the definition.
#[derive(Debug, Clone)]
pub struct LineMeter {
    camera: Camera,
    field: FieldDimensions,
    samples: Vec<LineSample>,
}

impl LineMeter {
    /// Makes a meter for pictures of this camera on this field.
    pub fn new(camera: &Camera, field: &FieldDimensions) -> Self {
        Self { camera: camera.clone(), field: field.clone(), samples: sample_lines(field, SPACING_M) }
    }

    /// Counts the lines that a picture shows and a pose projects. Takes 0.2 to 0.5 ms for a picture of 640 × 480 pixels.
    pub fn measure(&self, picture: &LinePoints, pose: CameraPose) -> LineAgreement {
        let visible = visible_samples(&self.field, &self.samples, &self.camera, pose, SPACING_PX);
        let lines = projected_lines(&visible);
        let marks = projected_marks(&self.camera, &self.field, pose);
        let Assigned { errors_px, unexplained } = Assigned::new(picture, &lines, &marks);
        let mut agreement = LineAgreement::default();
        for (line, errors_px) in lines.iter().zip(&errors_px) {
            add_line(&mut agreement, line, errors_px);
        }
        let least_points = (LEAST_STROKE_PX / picture.spacing_px) as usize;
        agreement.unexplained = count_strokes(unexplained, picture.neighbour_px(), least_points);
        agreement
    }
}

/// Points of a picture and the lines to which they belong.
struct Assigned {
    /// Distance of the nearest point that belongs to each piece of each line, pixels; `None` where there is none.
    errors_px: Vec<Vec<Option<f64>>>,
    /// Points that belong to no line and no mark.
    unexplained: Vec<DVec2>,
}

impl Assigned {
    fn new(picture: &LinePoints, lines: &[ProjectedLine], marks: &[ProjectedMark]) -> Self {
        let mut errors_px: Vec<Vec<Option<f64>>> =
            lines.iter().map(|line| vec![None; line.pieces()]).collect();
        let mut unexplained = Vec::new();
        let is_mark =
            |point: DVec2| marks.iter().any(|mark| mark.center.distance(point) <= mark.radius_px + REACH_PX);
        for &point in &picture.points {
            if let Some(nearest) = nearest_piece(lines, point, REACH_PX) {
                // Of several points beside one piece, the others are something else: a foot, a mark beside the line.
                let error_px = &mut errors_px[nearest.line][nearest.piece];
                *error_px =
                    Some(error_px.map_or(nearest.distance_px, |before| before.min(nearest.distance_px)));
            } else if !is_mark(point) {
                unexplained.push(point);
            }
        }
        Self { errors_px, unexplained }
    }
}

/// Adds one projected line with the errors of its pieces to the counts.
fn add_line(agreement: &mut LineAgreement, line: &ProjectedLine, errors_px: &[Option<f64>]) {
    let length_within = |most_px: f64| -> f64 {
        let pieces = errors_px.iter().enumerate();
        let within = pieces.filter(|(_, error_px)| error_px.is_some_and(|error_px| error_px <= most_px));
        within.map(|(piece, _)| line.length_px(piece)).sum()
    };
    let seen_px = length_within(REACH_PX);
    if seen_px >= LEAST_SEEN_PX {
        agreement.seen += 1;
        agreement.within_5px += u32::from(length_within(5.0) >= PART * seen_px);
        agreement.within_10px += u32::from(length_within(10.0) >= PART * seen_px);
    } else if line.clear_px >= LEAST_CLEAR_PX {
        agreement.unseen += 1;
    }
}
