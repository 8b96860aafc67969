//! Recognition of mistakes in a recording's files before anything is fitted: each file is read in another way, and a reading
//! under which far more lines are where they should be, or the robot's own motion agrees with its poses, is what was meant.

mod picture_readings;
mod stated_readings;

use crate::{
    diagnostics::input_mistake::InputMistake, linear_model::linearization::MeasureError, recording::Recording,
};

/// Returns the mistake in a recording's files, if there is one.
pub(crate) fn input_mistake(recording: &Recording<'_>) -> Result<Option<InputMistake>, MeasureError> {
    match picture_readings::mistake(recording)? {
        // A field is its own mirror image: what the pictures show is the same. The robot's own motion decides.
        Some(InputMistake::PicturesMirrored | InputMistake::PosesToTheRight) => {
            let is_mirrored = stated_readings::is_mirrored(recording);
            let poses = InputMistake::PosesToTheRight;
            Ok(Some(if is_mirrored { poses } else { InputMistake::PicturesMirrored }))
        }
        Some(mistake) => Ok(Some(mistake)),
        None => Ok(stated_readings::mistake(recording)),
    }
}
