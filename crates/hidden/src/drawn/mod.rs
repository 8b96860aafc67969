//! Worlds in which everything is drawn anew from the seed: field, camera, robot, hall, carpet, and what a person measured.

mod camera;
mod field;
mod hall;
mod measured;
mod robot;

use glam::DVec2;

use crate::{nominal::Nominal, random::Random, setting::Setting};

pub use self::field::another_league;
pub use self::measured::Given;

/// Draws a setting for pictures of this size; `given` says what the files tell of brightness, noise and sharpness, else that
/// is drawn, too.
pub fn setting(seed: u64, size: [u32; 2], given: Option<Given>) -> Setting {
    let stream = |purpose| Random::stream(seed, purpose, 0);
    let field = field::draw(&mut stream("drawn field"));
    let robot = &mut stream("drawn robot");
    let height_m = robot::height_m(robot, field.length_m);
    let camera = &mut stream("drawn camera");
    let lens = camera::lens(camera, size);
    let (light, psf, storage) = camera::sensor(camera);
    let nominal = Nominal { lens, size, height_m, light, field };
    let gait = robot::gait(robot, camera::look_down_rad(&nominal.lens, size));
    let rate_hz = robot::rate_hz(robot);
    let half = DVec2::new(nominal.field.length_m, nominal.field.width_m) / 2.0;
    Setting {
        stated: measured::photometry(&mut stream("drawn nominal"), &nominal, psf, given),
        psf,
        storage,
        rate_hz,
        gait,
        errors: robot::errors(robot),
        reach_m: half - robot.between(0.2, 0.3) * half.min_element(),
        hall: Some(hall::draw(&mut stream("drawn hall"))),
        nominal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{lens::Bend, sights};

    #[test]
    fn drawn_cameras_see_something_in_their_corners_and_can_be_written_down() {
        let (mut kinds, mut dark) = ([0; 3], 0);
        for seed in 0..300 {
            let Setting { nominal, stated, .. } = setting(seed, [640, 480], None);
            kinds[match nominal.lens.bend {
                Bend::Fisheye(_) => 0,
                Bend::Perspective([0.0, 0.0]) => 1,
                Bend::Perspective(_) => 2,
            }] += 1;
            let largest_radius = nominal.lens.largest_radius();
            let corners = [(0.0, 0.0), (639.0, 0.0), (0.0, 479.0), (639.0, 479.0)];
            let sees = |(u, v)| nominal.lens.ray(DVec2::new(u, v), largest_radius).is_some();
            dark += usize::from(!corners.into_iter().all(sees));
            nominal.setup(stated).unwrap();
            nominal.field.validate().unwrap();
            another_league(&nominal.field).validate().unwrap();
        }
        assert!(kinds.iter().all(|count| *count > 30), "{kinds:?}");
        // The widest fisheyes end before a corner, as real ones do.
        assert!(dark <= 6, "{dark}");
    }

    #[test]
    fn most_paths_show_lines() {
        let shows = |seed: u64| {
            let recipe = crate::Recipe::drawn(seed);
            let setting = recipe.setting();
            let times_s: Vec<f64> = (1..=60).map(|frame| f64::from(frame) / setting.rate_hz).collect();
            sights::are_ordinary(&setting.nominal, &recipe.trajectory(&setting), &times_s)
        };
        let count = (0..40).filter(|seed| shows(*seed)).count();
        assert!(count >= 38, "{count}");
    }
}
