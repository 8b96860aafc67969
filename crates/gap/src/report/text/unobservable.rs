//! Reasons why effects cannot be seen, in words.

use reality_sim_sensor::effect;

use crate::{
    inference::detection_limit::{MissingInput, UnobservableCause},
    report::data::Unobservable,
};

/// Returns why an effect cannot be seen, as a clause after "because".
pub fn unobservable_reason(cause: &UnobservableCause) -> &'static str {
    match cause {
        UnobservableCause::MissingInput { input } => match input {
            MissingInput::Odometry => "there is no odometry in frames.csv",
            MissingInput::MeasuredPoses => {
                "places and headings come from the pictures themselves, and follow whatever shifts these"
            }
            MissingInput::Reflectance => "nothing in camera.toml says how bright lines and carpet are",
            MissingInput::Noise => "nothing in camera.toml says how much noise to expect",
            MissingInput::Sharpness => "nothing in camera.toml says how sharp the picture should be",
        },
        UnobservableCause::CameraAtRest => {
            "the camera hardly moves: nothing depends on when a row or a picture is taken"
        }
        UnobservableCause::RobotAtRest => "the robot hardly moves: its odometry has nothing to report",
        UnobservableCause::FewViews { .. } => {
            "the frames show only one view or a few: a deviation may come from that place instead of the camera"
        }
        UnobservableCause::NotSeparable => {
            "what it changes in these pictures, other parts of the model or errors of the poses could change as well"
        }
    }
}

/// Returns what to record to see the effect, or what to add to the recording's files, as an imperative.
pub fn unobservable_remedy(report: &Unobservable) -> &'static str {
    match report.cause {
        UnobservableCause::MissingInput { input } => match input {
            MissingInput::Odometry => "write odometry_x_m, odometry_y_m and odometry_yaw_rad into frames.csv",
            MissingInput::MeasuredPoses => {
                "measure the camera's poses, with motion capture or the like, for groundtruth.tum"
            }
            MissingInput::Reflectance => {
                "write line_linear_rgb and carpet_linear_rgb into [photometry] of camera.toml"
            }
            MissingInput::Noise => "write noise_shot and noise_read into [photometry] of camera.toml",
            MissingInput::Sharpness => "write psf_sigma_px into [photometry] of camera.toml",
        },
        _ => effect(&report.id).map_or("", |known| known.recording_that_would_decide()),
    }
}
