//! Comparison of rendered light and written poses with independently implemented formulas.

use std::path::Path;

use glam::{DMat3, DQuat, DVec2, DVec3, Mat3, Vec3};

use reality_sim_core::pose::Pose2;

use crate::{
    Hidden, Recipe, Walk,
    exposure::Exposer,
    lens::Bend,
    nominal::Nominal,
    rig::Station,
    scene::{Ray, Scene},
    trajectory::Trajectory,
    truth::Truth,
};

const SIZE: [u32; 2] = [640, 480];

struct Shot {
    nominal: Nominal,
    truth: Truth,
    trajectory: Trajectory,
    scene: Scene,
    exposer: Exposer,
}

impl Shot {
    fn new(seed: u64, effects: &[Hidden]) -> Self {
        Self::of(&Recipe { size: SIZE, ..Recipe::new(seed) }, effects)
    }

    fn of(recipe: &Recipe, effects: &[Hidden]) -> Self {
        let setting = recipe.setting();
        let truth = Truth::new(&setting.nominal, effects);
        let trajectory = recipe.trajectory(&setting);
        let scene = Scene::new(recipe.seed, &setting, &truth, &trajectory);
        let exposer = Exposer::new(&truth, SIZE, setting.psf);
        Self { nominal: setting.nominal, truth, trajectory, scene, exposer }
    }

    fn light(&self, time_s: f64) -> [Vec<f32>; 3] {
        self.exposer.expose(&self.scene, &self.trajectory, time_s)
    }
}

/// Projects a point in the world to its pixel by the formula of the lens.
fn pixel_of(truth: &Truth, station: Station, point: DVec3) -> DVec2 {
    let seen = station.world_from_camera.transpose() * (point - station.position);
    let across = seen.x.hypot(seen.y);
    let t = across.atan2(seen.z);
    let Bend::Fisheye([k1, k2, k3, k4]) = truth.lens.bend else {
        unreachable!("standard worlds have fisheyes")
    };
    let bent = t * (1.0 + k1 * t.powi(2) + k2 * t.powi(4) + k3 * t.powi(6) + k4 * t.powi(8));
    DVec2::new(seen.x, seen.y) * (truth.lens.focal_px * bent / across) + truth.lens.center_px
}

/// Interpolates between pixels; returns `None` near the rim.
fn value_at(plane: &[f32], pixel: DVec2) -> Option<f64> {
    let inside = pixel.cmpge(DVec2::splat(3.0)).all() && pixel.x < 636.0 && pixel.y < 476.0;
    inside.then(|| {
        let (corner, part) = (pixel.floor(), pixel - pixel.floor());
        let at = |x: usize, y: usize| f64::from(plane[(corner.y as usize + y) * 640 + corner.x as usize + x]);
        let row = |y| at(0, y) * (1.0 - part.x) + at(1, y) * part.x;
        row(0) * (1.0 - part.y) + row(1) * part.y
    })
}

/// Iterates over points on the centres of straight lines, with the directions across the lines.
fn line_points() -> impl Iterator<Item = (DVec2, DVec2)> {
    let steps = |half: f64| (0..200).map(move |i| half * (f64::from(i) / 100.0 - 0.995));
    let touch = steps(2.9).flat_map(|x| [-2.0, 2.0].map(|y| (DVec2::new(x, y), DVec2::Y)));
    let goal = steps(1.9).flat_map(|y| [-3.0, 3.0].map(|x| (DVec2::new(x, y), DVec2::X)));
    let halfway = steps(1.9).map(|y| (DVec2::new(0.0, y), DVec2::X));
    let clear = |point: &DVec2| (point.length() - 0.6).abs() > 0.15 && point.length() > 0.2;
    let junction = |point: &DVec2| point.x.abs() < 0.15 && point.y.abs() > 1.9;
    let area = |point: &DVec2| point.x.abs() > 2.9 && (point.y.abs() - 1.1).abs() < 0.15;
    touch.chain(goal).chain(halfway).filter(move |(p, _)| clear(p) && !junction(p) && !area(p))
}

/// Returns how far the light's edge lies outside the edge of the paint, pixels; `None` where it cannot be measured.
fn edge_error_px(shot: &Shot, plane: &[f32], station: Station, center: DVec2, across: DVec2) -> Option<f64> {
    let middle = pixel_of(&shot.truth, station, center.extend(0.0));
    let edge = pixel_of(&shot.truth, station, (center + 0.025 * across).extend(0.0));
    let half_px = middle.distance(edge);
    let [line, carpet] = [shot.nominal.light.line_rgb[1], shot.nominal.light.carpet_rgb[1]];
    let value = |pixels: f64| value_at(plane, middle + (edge - middle) * (pixels / half_px));
    let painted =
        (value(0.0)? / line - 1.0).abs() < 0.1 && (value(half_px + 2.5)? / carpet - 1.0).abs() < 0.3;
    if half_px < 2.5 || !painted {
        return None;
    }
    let steps = (0..600).map(|step| f64::from(step) * 0.01 + half_px - 3.0);
    let crossing =
        steps.map(|at| (at, value(at))).find(|(_, v)| v.is_some_and(|v| v < 0.5 * (line + carpet)))?;
    Some(crossing.0 - half_px)
}

fn edge_errors_px(effects: &[Hidden], seed: u64) -> Vec<f64> {
    let shot = Shot::new(seed, effects);
    let mut errors = Vec::new();
    for time_s in [0.4, 3.0, 6.0, 9.0] {
        let light = shot.light(time_s);
        let station = shot.trajectory.station(time_s);
        for (center, across) in line_points() {
            for side in [across, -across] {
                errors.extend(edge_error_px(&shot, &light[1], station, center, side));
            }
        }
    }
    errors
}

#[test]
fn edges_of_lines_lie_where_the_forward_formula_puts_them() {
    let errors: Vec<f64> = [1, 2, 3].iter().flat_map(|seed| edge_errors_px(&[], *seed)).collect();
    assert!(errors.len() > 200, "{}", errors.len());
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let mean_size = errors.iter().map(|error| error.abs()).sum::<f64>() / errors.len() as f64;
    let largest = errors.iter().fold(0.0_f64, |largest, error| largest.max(error.abs()));
    assert!(mean.abs() < 0.03 && mean_size < 0.06 && largest < 0.25, "{mean} {mean_size} {largest}");
}

#[test]
fn a_hidden_lens_moves_the_edges_with_the_true_formula() {
    let effects = [
        Hidden::RadialDistortion { k: [0.02, 0.0, 0.0, 0.0] },
        Hidden::FocalLength { scale: 0.02 },
        Hidden::PrincipalPoint { dx_px: 4.0, dy_px: -3.0 },
    ];
    let errors = edge_errors_px(&effects, 2);
    assert!(errors.len() > 50 && errors.iter().all(|error| error.abs() < 0.3), "{errors:?}");
}

#[test]
fn the_carpet_has_its_nominal_colour_on_average() {
    let shot = Shot::new(4, &[]);
    let down = Mat3::from_cols(Vec3::Y, Vec3::X, -Vec3::Z);
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for (i, j) in (0..500).flat_map(|i| (0..340).map(move |j| (i, j))) {
        let (x, y) = (i as f32 * 0.0147 - 3.67, j as f32 * 0.0157 - 2.66);
        if shot.truth.pattern.distance_m(x, y) > 0.01 {
            let ray = Ray {
                origin: Vec3::new(x, y, 0.5),
                direction: -Vec3::Z,
                steps_in_camera: [Vec3::X * 1e-3, Vec3::Y * 1e-3],
                world_from_camera: &down,
            };
            sum += shot.scene.light(&ray, std::iter::empty(), &[]);
            count += 1.0;
        }
    }
    for (mean, nominal) in (sum / count).to_array().iter().zip(shot.nominal.light.carpet_rgb) {
        assert!((f64::from(*mean) / nominal - 1.0).abs() < 0.01, "{mean} {nominal}");
    }
}

/// Returns the numbers of every row of the written reference poses.
fn reference_rows(folder: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder.join("groundtruth.tum")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.map(|row| row.split(' ').map(|number| number.parse().unwrap()).collect()).collect()
}

#[test]
fn written_reference_poses_are_the_true_ones_with_the_noise_of_motion_capture() {
    let folder = tempfile::tempdir().unwrap();
    let recipe = Recipe { frames: 60, size: [16, 16], ..Recipe::new(5) };
    recipe.record(folder.path()).unwrap();
    let trajectory = recipe.trajectory(&recipe.setting());
    let (mut metres, mut radians) = (0.0, 0.0);
    for n in reference_rows(folder.path()) {
        let station = trajectory.station(n[0]);
        metres += DVec3::new(n[1], n[2], n[3]).distance_squared(station.position) / 180.0;
        let rotation = DMat3::from_quat(DQuat::from_xyzw(n[4], n[5], n[6], n[7]));
        let turn = DQuat::from_mat3(&(station.world_from_camera.transpose() * rotation));
        radians += turn.to_scaled_axis().length_squared() / 180.0;
    }
    assert!((metres.sqrt() / 0.003 - 1.0).abs() < 0.2, "{}", metres.sqrt());
    assert!((radians.sqrt().to_degrees() / 0.14 - 1.0).abs() < 0.2, "{}", radians.sqrt());
}

#[test]
fn a_hidden_mount_turns_and_raises_the_camera() {
    let pitch_rad = 0.05;
    let level = Shot::new(6, &[]);
    let pitched = Shot::new(6, &[Hidden::MountPitch { angle_rad: pitch_rad }]);
    let time_s = 1.0;
    let mut station = level.trajectory.station(time_s);
    // This is the camera pitched down by the angle, computed from its axes.
    let axes = station.world_from_camera;
    let forward = axes.z_axis * pitch_rad.cos() + axes.y_axis * pitch_rad.sin();
    station.world_from_camera = DMat3::from_cols(axes.x_axis, forward.cross(axes.x_axis), forward);
    let light = pitched.light(time_s);
    let errors: Vec<f64> = line_points()
        .filter_map(|(center, across)| edge_error_px(&pitched, &light[1], station, center, across))
        .collect();
    assert!(errors.len() > 10 && errors.iter().all(|error| error.abs() < 0.3), "{errors:?}");
}

#[test]
fn exact_reference_poses_are_the_true_ones() {
    let recipe = Recipe { frames: 3, size: [32, 24], exact_references: true, ..Recipe::new(5) };
    let folder = tempfile::tempdir().unwrap();
    recipe.record(folder.path()).unwrap();
    let trajectory = recipe.trajectory(&recipe.setting());
    let rows = reference_rows(folder.path());
    assert_eq!(rows.len(), 3);
    for n in rows {
        let station = trajectory.station(n[0]);
        assert!((DVec3::new(n[1], n[2], n[3]) - station.position).length() < 1e-6);
        let rotation = DMat3::from_quat(DQuat::from_xyzw(n[4], n[5], n[6], n[7]));
        assert!(
            (rotation - station.world_from_camera).to_cols_array().iter().all(|error| error.abs() < 1e-6)
        );
    }
}

#[test]
fn a_visited_place_looks_as_it_does_to_the_robot_that_stands_there() {
    let recipe =
        Recipe { frames: 1, size: [64, 48], walk: Walk::Standing, exact_references: true, ..Recipe::new(6) };
    let (robot, visitor) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let stands = recipe.record(robot.path()).unwrap();
    let place = stands.frames[0].reference_pose.unwrap().planar();
    let elsewhere = Pose2::new(-place.x_m, 0.5, place.yaw_rad + 1.0);
    let visits = recipe.visit(&[place, elsewhere, place], visitor.path()).unwrap();
    for (frame, expected) in visits.frames.iter().zip([place, elsewhere, place]) {
        let found = frame.reference_pose.unwrap().planar();
        assert!((found.x_m - expected.x_m).abs() < 1e-6 && (found.y_m - expected.y_m).abs() < 1e-6);
        assert!((DVec2::from_angle(found.yaw_rad) - DVec2::from_angle(expected.yaw_rad)).length() < 1e-6);
        assert_eq!(frame.odometry, None);
    }
    // The noise of the first pictures is the same.
    assert_eq!(visits.load_image(0).unwrap(), stands.load_image(0).unwrap());
    assert_ne!(visits.load_image(1).unwrap(), stands.load_image(0).unwrap());
}
