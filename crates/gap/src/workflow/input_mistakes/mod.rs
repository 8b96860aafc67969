//! Recognition of mistakes in a recording's files before anything is fitted: each file is read in another way, and a reading
//! under which far more lines are where they should be, or the robot's own motion agrees with its poses, is what was meant.
//! Where no reading helps, the lines that the pictures show anywhere tell whether they are those of this field at all.

mod camera_readings;
mod picture_readings;
mod stated_readings;
mod white_lines;

use crate::{
    diagnostics::{finding::Finding, input_mistake::InputMistake},
    linear_model::linearization::MeasureError,
    recording::Recording,
};
use picture_readings::Sample;
pub use white_lines::shows_lines;

/// Returns what is wrong with a recording's files, if anything is.
pub(crate) fn fault(recording: &Recording<'_>) -> Result<Option<Finding>, MeasureError> {
    let sample = Sample::new(recording)?;
    let mistake = match picture_readings::mistake(&sample) {
        // A field is its own mirror image: what the pictures show is the same. The robot's own motion decides.
        Some(InputMistake::PicturesMirrored | InputMistake::PosesToTheRight) => {
            let is_mirrored = stated_readings::is_mirrored(recording);
            let poses = InputMistake::PosesToTheRight;
            Some(if is_mirrored { poses } else { InputMistake::PicturesMirrored })
        }
        Some(mistake) => Some(mistake),
        None => stated_readings::mistake(recording),
    };
    let mistake = mistake.map(|mistake| Finding::InputMistake { mistake });
    Ok(mistake.or_else(|| white_lines::fault(&sample)))
}
