//! Robots: how high they carry the camera, how they walk, and how well they and the motion capture measure.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    log::{Errors, ReferenceErrors},
    nominal::rounded,
    random::Random,
    trajectory::Gait,
};

/// Draws the height of the camera: small robots play on small fields.
pub fn height_m(random: &mut Random, field_length_m: f64) -> f64 {
    let [low, high] = if field_length_m > 12.0 { [0.7, 1.2] } else { [0.35, 0.75] };
    rounded(random.between(low, high), 1e4)
}

/// Draws a gait.
pub fn gait(random: &mut Random, look_down_rad: [f64; 2]) -> Gait {
    let scans = random.uniform() < 0.4;
    Gait {
        speed_m_per_s: random.between(0.1, 0.45),
        max_turn_rad_per_s: random.between(PI / 6.0, PI / 2.5),
        frequency_hz: random.between(0.6, 1.6),
        roll_rad: random.between(0.3, 2.2).to_radians(),
        pitch_rad: random.between(0.3, 2.0).to_radians(),
        lateral_m: random.between(0.002, 0.015),
        bob_m: random.between(0.002, 0.01),
        look_down_rad,
        scan_rad: if scans { random.between(0.15, 0.6) } else { 0.0 },
        scan_period_s: random.between(3.0, 9.0),
    }
}

/// Draws the number of pictures per second.
pub fn rate_hz(random: &mut Random) -> f64 {
    [4.0, 5.0, 6.0, 8.0, 10.0, 15.0][random.below(6) as usize]
}

/// Draws the errors of what is logged.
pub fn errors(random: &mut Random) -> Errors {
    let (position_m, rotation_rad) = (random.between(0.001, 0.005), random.between(0.001, 0.005));
    let slow = random.between(0.1, 0.7);
    let (white, slow) = ((1.0_f64 - slow).sqrt(), slow.sqrt());
    let mut within = |largest: f64| {
        let direction = DVec3::new(random.normal(), random.normal(), random.normal());
        direction.normalize_or_zero() * random.between(0.0, largest)
    };
    let (constant_m, constant_rad) = (within(0.003), within(0.002));
    Errors {
        reference: ReferenceErrors {
            white_m: white * position_m,
            white_rad: white * rotation_rad,
            slow_m: slow * position_m,
            slow_rad: slow * rotation_rad,
            decay_s: random.between(0.5, 5.0),
            constant_m,
            constant_rad,
        },
        imu_rad: random.between(0.08, 0.4).to_radians(),
        odometry_m: random.between(0.0015, 0.006),
        odometry_rad: random.between(0.15, 0.6).to_radians(),
    }
}
