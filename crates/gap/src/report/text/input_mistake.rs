//! Mistakes in a recording's files, in words.

use reality_sim_core::field::preset_names;

use crate::diagnostics::input_mistake::InputMistake;

/// File of the reference poses.
const POSES: &str = "groundtruth.tum";
const FIELD: &str = "field.toml";
const CAMERA: &str = "camera.toml";
const FRAMES: &str = "frames.csv";
/// Folder of the pictures.
const PICTURES: &str = "images";

/// Returns the file, what it seems to hold and the remedy: "the file groundtruth.tum seems to hold millimetres: write metres".
pub(super) fn input_mistake(mistake: InputMistake) -> String {
    if let Some(camera) = of_camera(mistake) {
        return camera;
    }
    let [file, holds, remedy] = words(mistake);
    let remedy = match mistake {
        InputMistake::FieldOfAnotherLeague(preset) => {
            format!("take the field `{}`", preset_names().nth(preset).unwrap_or("of the pictures"))
        }
        _ => remedy.to_owned(),
    };
    let kind = if file == PICTURES { "folder" } else { "file" };
    format!("the {kind} {file} seems to hold {holds}: {remedy}")
}

/// Returns the sentence on a camera file that is wrong by a factor; `None` for mistakes in other files.
fn of_camera(mistake: InputMistake) -> Option<String> {
    let factor = |percent: u32| 100.0 / f64::from(percent);
    Some(match mistake {
        InputMistake::FocalLength { percent } => format!(
            "the file {CAMERA} seems to hold a focal length about {} % too {}: calibrate the camera, or write fx and fy times \
             {:.2}",
            percent.abs_diff(100),
            if percent > 100 { "large" } else { "small" },
            factor(percent)
        ),
        InputMistake::CameraOfOtherSize { percent } => format!(
            "the file {CAMERA} seems to hold the camera of pictures about {percent} % as wide: calibrate the camera, or write fx, \
             fy, cx and cy times {:.2}",
            factor(percent)
        ),
        _ => return None,
    })
}

/// Returns the file, what it seems to hold, and the remedy.
fn words(mistake: InputMistake) -> [&'static str; 3] {
    if let Some([holds, remedy]) = of_poses(mistake) {
        return [POSES, holds, remedy];
    }
    let (file, [holds, remedy]) = match mistake {
        InputMistake::PicturesMirrored => (PICTURES, ["mirrored pictures", "mirror them from left to right"]),
        InputMistake::PicturesUpsideDown => (PICTURES, ["pictures upside down", "turn them by half a turn"]),
        InputMistake::FieldSwapped => {
            (FIELD, ["length and width swapped", "write the length as the longer one, along x"])
        }
        InputMistake::FieldOfAnotherLeague(_) => (FIELD, ["the field of another league", ""]),
        _ => (FRAMES, of_frames(mistake)),
    };
    [file, holds, remedy]
}

/// Returns what the file of the reference poses seems to hold, and the remedy; `None` for mistakes in other files.
fn of_poses(mistake: InputMistake) -> Option<[&'static str; 2]> {
    Some(match mistake {
        InputMistake::PosesInMillimeters => ["millimetres", "write places in metres"],
        InputMistake::PosesInCentimeters => ["centimetres", "write places in metres"],
        InputMistake::PosesCameraFromWorld => {
            ["poses camera from world", "write the inverse, world from camera"]
        }
        InputMistake::PosesRealPartFirst => ["quaternions with w first", "write them in the order x y z w"],
        InputMistake::PosesOfBodyAxes => [
            "rotations of axes ahead, left and up",
            "write those of the camera's axes, x to the right, y down and z into the scene",
        ],
        InputMistake::PosesSwappedAxes | InputMistake::PosesSwappedPlaces => {
            ["x and y swapped", "write x along the field and y to the left"]
        }
        InputMistake::PosesToTheRight | InputMistake::PosesWrongSignOfY => {
            ["a y that is positive to the right", "write y positive to the left"]
        }
        InputMistake::PosesDown => ["a z that is positive down", "write z positive up"],
        InputMistake::PosesPitchUp => {
            ["rotations whose pitch has the wrong sign", "turn the sign round: down is positive"]
        }
        InputMistake::PosesRollCounterClockwise => [
            "rotations whose roll has the wrong sign",
            "turn the sign round: clockwise, seen from behind, is positive",
        ],
        _ => return None,
    })
}

/// Returns what `frames.csv` seems to hold, and the remedy.
fn of_frames(mistake: InputMistake) -> [&'static str; 2] {
    match mistake {
        InputMistake::AnglesInDegrees => ["pitch and roll in degrees", "write them in radians"],
        InputMistake::PitchUp => ["a pitch that is positive up", "write it positive down"],
        InputMistake::RollCounterClockwise => [
            "a roll that is positive counter-clockwise",
            "write it positive clockwise, seen from behind the camera",
        ],
        InputMistake::AnglesSwapped => ["pitch and roll swapped", "swap the two columns"],
        InputMistake::OdometryInMillimeters => ["an odometry in millimetres", "write it in metres"],
        InputMistake::OdometryInDegrees => ["headings of the odometry in degrees", "write them in radians"],
        InputMistake::OdometrySwapped => ["x and y of the odometry swapped", "swap the two columns"],
        _ => ["an odometry whose y and heading are positive to the right", "write them positive to the left"],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_is_one_sentence_with_file_and_remedy() {
        let millimeters = "the file groundtruth.tum seems to hold millimetres: write places in metres";
        assert_eq!(input_mistake(InputMistake::PosesInMillimeters), millimeters);
        let league = "the file field.toml seems to hold the field of another league: take the field `spl`";
        let spl = preset_names().position(|name| name == "spl").unwrap();
        assert_eq!(input_mistake(InputMistake::FieldOfAnotherLeague(spl)), league);
        let focal = "the file camera.toml seems to hold a focal length about 43 % too large: calibrate the camera, or write fx \
                     and fy times 0.70";
        assert_eq!(input_mistake(InputMistake::FocalLength { percent: 143 }), focal);
        let size = "the file camera.toml seems to hold the camera of pictures about 200 % as wide: calibrate the camera, or \
                    write fx, fy, cx and cy times 0.50";
        assert_eq!(input_mistake(InputMistake::CameraOfOtherSize { percent: 200 }), size);
    }
}
