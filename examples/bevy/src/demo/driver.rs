//! What moves the camera: the path, or the user's keys.

use bevy::prelude::*;
use reality_sim::{CameraPose, Pose2, pose::Motion2};
use reality_sim_bevy::{RealityCamera, axes::camera_transform};

use super::track::Track;

/// Speed by hand, metres a second.
const SPEED_M_S: f64 = 0.3;
/// Turning by hand, radians a second.
const TURN_RAD_S: f64 = 0.9;
/// Longest step of the simulation, seconds: after a pause, the world does not jump.
const LONGEST_STEP_S: f64 = 0.1;

/// Driver of the camera.
#[derive(Debug, Resource)]
pub struct Driver {
    track: Track,
    /// Time on the track.
    time_s: f64,
    /// Where the user has taken the camera.
    by_hand: Option<Pose2>,
    /// Height, pitch and roll of the camera.
    usual: CameraPose,
}

impl Driver {
    /// Makes a driver at the beginning of a track; height, pitch and roll are those of a pose.
    pub fn new(track: Track, usual: CameraPose) -> Self {
        Self { track, time_s: 0.0, by_hand: None, usual }
    }

    /// Returns the pose of the camera.
    pub fn pose(&self) -> CameraPose {
        self.usual.with_planar(self.by_hand.unwrap_or_else(|| self.track.pose(self.time_s)))
    }

    /// Goes on for some time: by hand as soon as a key moves the camera.
    fn step(&mut self, step_s: f64, keys: &ButtonInput<KeyCode>) {
        let motion = motion(keys, step_s);
        if keys.just_pressed(KeyCode::Space) {
            if let Some(planar) = self.by_hand.take() {
                self.time_s = self.track.time_s_nearest(planar);
            }
        } else if motion != Motion2::default() {
            self.by_hand = Some(self.pose().planar().moved(motion));
        } else if self.by_hand.is_none() {
            self.time_s += step_s;
        }
    }
}

/// Returns the motion that the pressed keys ask for.
fn motion(keys: &ButtonInput<KeyCode>, step_s: f64) -> Motion2 {
    let sign = |plus: [KeyCode; 2], minus: [KeyCode; 2]| {
        f64::from(u8::from(keys.any_pressed(plus))) - f64::from(u8::from(keys.any_pressed(minus)))
    };
    let forward = sign([KeyCode::KeyW, KeyCode::ArrowUp], [KeyCode::KeyS, KeyCode::ArrowDown]);
    let left = sign([KeyCode::KeyQ; 2], [KeyCode::KeyE; 2]);
    let turn = sign([KeyCode::KeyA, KeyCode::ArrowLeft], [KeyCode::KeyD, KeyCode::ArrowRight]);
    Motion2 {
        forward_m: SPEED_M_S * step_s * forward,
        left_m: SPEED_M_S * step_s * left,
        turn_rad: TURN_RAD_S * step_s * turn,
    }
}

/// Returns the time by which the simulated world goes on in this frame, seconds.
pub fn step_s(time: &Time) -> f64 {
    time.delta_secs_f64().min(LONGEST_STEP_S)
}

/// Moves the camera.
pub fn drive(
    time: Res<Time>,
    keys: Res<ButtonInput<KeyCode>>,
    mut driver: ResMut<Driver>,
    mut camera: Single<&mut Transform, With<RealityCamera>>,
) {
    driver.step(step_s(&time), &keys);
    **camera = camera_transform(driver.pose());
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn driver() -> Driver {
        let recorded: Vec<Pose2> =
            (0..41).map(|index| Pose2::new(0.05 * f64::from(index), 0.0, 0.0)).collect();
        Driver::new(Track::along(&recorded), CameraPose::default())
    }

    #[test]
    fn keys_take_the_camera_from_its_path_and_space_leads_back() {
        let (mut driver, mut keys) = (driver(), ButtonInput::default());
        driver.step(3.0, &keys);
        let left_path_at = driver.pose().planar();
        keys.press(KeyCode::KeyQ);
        driver.step(1.0, &keys);
        let motion = left_path_at.motion_to(driver.pose().planar());
        assert!((motion.left_m - SPEED_M_S).abs() < 1e-9 && motion.forward_m.abs() < 1e-9, "{motion:?}");

        keys.reset_all();
        driver.step(1.0, &keys);
        assert_eq!(left_path_at.motion_to(driver.pose().planar()), motion, "it stays where it was left");
        keys.press(KeyCode::Space);
        driver.step(1.0, &keys);
        assert!(left_path_at.motion_to(driver.pose().planar()).distance_m() < 0.05);
    }

    #[test]
    fn left_turns_counter_clockwise_and_up_goes_forwards() {
        let (mut driver, mut keys) = (driver(), ButtonInput::default());
        keys.press(KeyCode::ArrowLeft);
        let start = driver.pose().planar();
        driver.step(0.5 * PI / TURN_RAD_S, &keys);
        keys.reset_all();
        keys.press(KeyCode::ArrowUp);
        driver.step(1.0, &keys);
        let end = driver.pose().planar();
        assert!((end.y_m - start.y_m - SPEED_M_S).abs() < 1e-9 && (end.x_m - start.x_m).abs() < 1e-9);
    }
}
