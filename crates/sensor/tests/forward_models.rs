//! Properties that every forward model of the library has: it vanishes at the neutral values, is continuous in its
//! parameters, and is well-defined up to the ends of their plausible ranges.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[allow(dead_code, reason = "shared with other tests")]
mod common;

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use image::RgbImage;
use proptest::prelude::*;
use reality_sim_core::{
    camera::Camera,
    pose::{CameraPose, Motion2},
};
use reality_sim_sensor::{Effect, Model, Noise, Parameter, Renderer, Role, Stage, Surface, Tone, library};

/// Start and end of the recording that fixed parameters state, seconds.
const RECORDING_S: [f64; 2] = [-10.0, 80.0];

/// Arguments of the hooks.
#[derive(Debug, Clone)]
struct Probe {
    camera: Camera,
    pose: CameraPose,
    point: DVec2,
    row: f64,
    radius: f64,
    time_s: f64,
    linear: f64,
    noise: Noise,
    tone: Tone,
    motion: Motion2,
}

fn any_probe() -> impl Strategy<Value = Probe> {
    let camera = prop_oneof![
        Just(common::fisheye([64, 48], 22.0)),
        Just(common::pinhole([64, 48], 40.0)),
        Just(common::barrel([64, 48], 40.0).with_max_angle_rad(0.5).unwrap()),
    ];
    let pose = ([-3.0..3.0, -2.0..2.0, -3.1..3.1], [0.3..0.8, -1.5..1.5, -3.1..3.1])
        .prop_map(|(planar, rest)| common::pose(planar, rest));
    let motion = proptest::array::uniform3(-0.5..0.5).prop_map(|[forward_m, left_m, turn_rad]| Motion2 {
        forward_m,
        left_m,
        turn_rad,
    });
    (camera, pose, [-4.0..4.0, -3.0..3.0], proptest::array::uniform3(0.0..1.0f64), 0.0..1.0f64, motion)
        .prop_map(|(camera, pose, point, [row, radius, linear], noise, motion)| Probe {
            camera,
            pose,
            point: DVec2::from_array(point),
            row,
            radius,
            time_s: 100.0 * noise,
            linear,
            noise: Noise { shot: 0.01 * noise, read_variance: 1e-4 * noise },
            tone: Tone { gamma: 1.4 + noise, contrast: 0.1 * noise },
            motion,
        })
}

fn same_pose(a: CameraPose, b: CameraPose) -> bool {
    let turned = a.rotation_world_from_camera() - b.rotation_world_from_camera();
    a.position_in_world().distance(b.position_in_world()) < 1e-12
        && turned.to_cols_array().iter().all(|value| value.abs() < 1e-9)
}

/// Returns the stages whose hooks change their arguments.
fn changed_stages(effect: &dyn Effect, p: &[f64], probe: &Probe) -> BTreeSet<Stage> {
    let field = common::field();
    let hooks = [
        (
            Stage::World,
            effect.field(p, field.clone()) == field
                && effect.light(p, probe.point, &field) == 1.0
                && Surface::ALL.into_iter().all(|surface| effect.reflectance(p, surface) == 1.0),
        ),
        (
            Stage::Motion,
            effect.delay_s(p, probe.row) == 0.0
                && effect.exposure_s(p) == 0.0
                && effect.clock_s(p) == 0.0
                && effect.picture_delay_s(p, probe.time_s) == 0.0
                && effect.sway(p, probe.pose, probe.time_s) == probe.pose,
        ),
        (Stage::Mount, same_pose(effect.mount(p, probe.pose), probe.pose)),
        (
            Stage::Lens,
            effect.lens(p, probe.camera.clone()) == Ok(probe.camera.clone())
                && effect.shift_px(p, &probe.camera, probe.point.extend(2.0)) == DVec2::ZERO
                && effect.magnification(p) == [1.0; 3]
                && effect.falloff(p, probe.radius) == 1.0
                && effect.glare(p) == 0.0
                && effect.blur_variance_px2(p, probe.radius) == 0.0,
        ),
        (Stage::Exposure, effect.gain(p, probe.time_s) == [1.0; 3]),
        (
            Stage::Sensor,
            effect.respond(p, probe.linear) == probe.linear && effect.noise(p, probe.noise) == probe.noise,
        ),
        (Stage::Encoding, effect.tone(p, probe.tone) == Ok(probe.tone) && effect.sharpening(p) == 0.0),
        (
            Stage::Odometry,
            effect.odometry(p, probe.motion, 0.2) == probe.motion
                && effect.odometry_delay_s(p) == 0.0
                && effect.attitude_delay_s(p) == 0.0,
        ),
    ];
    hooks.into_iter().filter(|(_, same)| !same).map(|(stage, _)| stage).collect()
}

proptest! {
    #[test]
    fn neutral_values_change_nothing(probe in any_probe()) {
        for effect in library() {
            let neutral: Vec<f64> = effect.parameters().iter().map(|parameter| parameter.neutral).collect();
            for p in [neutral.as_slice(), &[]] {
                prop_assert_eq!(changed_stages(*effect, p, &probe), BTreeSet::new(), "{}", effect.id());
            }
        }
    }

    #[test]
    fn an_effect_changes_its_own_stage_and_no_other(probe in any_probe()) {
        for effect in library() {
            // Half of the plausible range, within the time of the recording.
            let size = |range: [f64; 2]| if range[1].is_finite() { 0.5 * range[1] } else { probe.time_s };
            let p: Vec<f64> = effect.parameters().iter().map(|parameter| size(parameter.range)).collect();
            let changed = changed_stages(*effect, &p, &probe);
            prop_assert_eq!(changed, BTreeSet::from([effect.stage()]), "{}", effect.id());
        }
    }
}

/// Fractions of the parameters' ranges; the ends are as probable as all that lies between.
fn any_fractions() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0, 0.0..1.0], 16)
}

/// Returns the values at these fractions of the plausible ranges. Parameters that the recording gives are its times.
fn values(effect: &dyn Effect, fraction: impl Fn(usize) -> f64) -> Vec<f64> {
    let value = |(index, parameter): (usize, &Parameter)| match (parameter.role, parameter.range) {
        (Role::Fixed, _) => RECORDING_S[index % 2],
        (_, [low, high]) => low + fraction(index) * (high - low),
    };
    effect.parameters().iter().enumerate().map(value).collect()
}

/// Returns the indices of the parameters that are fitted.
fn fitted(effect: &dyn Effect) -> impl Iterator<Item = usize> {
    let parameters = effect.parameters().iter().enumerate();
    parameters.filter(|(_, parameter)| parameter.role != Role::Fixed).map(|(index, _)| index)
}

/// Returns the values moved by a step, in fractions of the range of one parameter, and back into the range.
fn stepped(effect: &dyn Effect, p: &[f64], index: usize, step: f64) -> Vec<f64> {
    let [low, high] = effect.parameters()[index].range;
    let mut moved = p.to_vec();
    moved[index] += if p[index] < 0.5 * (low + high) { step } else { -step } * (high - low);
    moved
}

/// Returns what all hooks of an effect make of their arguments, as numbers of about 1. Pixels are those of rays well inside
/// every camera's valid angle, in units of the picture's width.
fn outputs(effect: &dyn Effect, p: &[f64], probe: &Probe) -> Vec<f64> {
    let field = effect.field(p, common::field());
    let pose = effect.mount(p, probe.pose);
    let camera = effect.lens(p, probe.camera.clone()).unwrap();
    let pixels = [[0.0, 0.0], [0.3, 0.1], [-0.2, 0.25], [-0.1, -0.3]].map(|[x, y]| {
        let point = DVec3::new(x, y, 1.0);
        let pixel = camera.project_unbounded(point).unwrap() + effect.shift_px(p, &camera, point);
        pixel / f64::from(camera.width)
    });
    let noise = effect.noise(p, probe.noise);
    let odometry = effect.odometry(p, probe.motion, 0.2);
    let mut all = vec![
        field.length_m,
        field.width_m,
        field.goal_area_length_m,
        field.goal_area_width_m,
        field.center_circle_diameter_m,
        effect.light(p, probe.point, &common::field()),
        effect.delay_s(p, probe.row),
        effect.exposure_s(p),
        effect.clock_s(p),
        effect.picture_delay_s(p, probe.time_s),
        effect.sway(p, probe.pose, probe.time_s).pitch_rad,
        effect.sway(p, probe.pose, probe.time_s).height_m,
        effect.odometry_delay_s(p),
        effect.attitude_delay_s(p),
        effect.falloff(p, probe.radius),
        effect.blur_variance_px2(p, probe.radius),
        effect.reflectance(p, Surface::Line),
        effect.reflectance(p, Surface::Carpet),
        effect.glare(p),
        effect.sharpening(p),
        effect.respond(p, probe.linear),
        1e3 * noise.variance(probe.linear),
        effect.tone(p, probe.tone).unwrap().encode(probe.linear),
        odometry.forward_m,
        odometry.left_m,
        odometry.turn_rad,
    ];
    all.extend(pose.position_in_world().to_array());
    all.extend(pose.rotation_world_from_camera().to_cols_array());
    all.extend(pixels.iter().flat_map(DVec2::to_array));
    all.extend(effect.magnification(p));
    all.extend(effect.gain(p, probe.time_s));
    all
}

proptest! {
    #[test]
    fn a_small_change_of_a_parameter_is_a_small_change_of_what_the_effect_makes(
        probe in any_probe(),
        fractions in any_fractions(),
    ) {
        for effect in library() {
            let p = values(*effect, |index| fractions[index]);
            let before = outputs(*effect, &p, &probe);
            for index in fitted(*effect) {
                let after = outputs(*effect, &stepped(*effect, &p, index, 1e-7), &probe);
                for (before, after) in before.iter().zip(&after) {
                    prop_assert!((before - after).abs() < 1e-4, "{} {p:?} {index}: {before} {after}", effect.id());
                }
            }
        }
    }

    #[test]
    fn within_their_ranges_effects_make_finite_numbers_and_no_negative_light(
        probe in any_probe(),
        fractions in any_fractions(),
    ) {
        for effect in library() {
            let (id, p) = (effect.id(), values(*effect, |index| fractions[index]));
            prop_assert!(outputs(*effect, &p, &probe).iter().all(|value| value.is_finite()), "{id} {p:?}");
            prop_assert!(effect.light(&p, probe.point, &common::field()) > 0.0, "{id} {p:?}");
            prop_assert!(effect.falloff(&p, probe.radius) > 0.0, "{id} {p:?}");
            prop_assert!(effect.gain(&p, probe.time_s).iter().all(|gain| *gain > 0.0), "{id} {p:?}");
            prop_assert!(effect.magnification(&p).iter().all(|factor| *factor > 0.0), "{id} {p:?}");
            prop_assert!(effect.blur_variance_px2(&p, probe.radius) >= 0.0, "{id} {p:?}");
            prop_assert!(effect.exposure_s(&p) >= 0.0, "{id} {p:?}");
            let Noise { shot, read_variance } = effect.noise(&p, probe.noise);
            prop_assert!(shot >= 0.0 && read_variance >= 0.0, "{id} {p:?}");
            prop_assert!(effect.field(&p, common::field()).validate().is_ok(), "{id} {p:?}");
        }
    }

    #[test]
    fn within_their_ranges_effects_leave_rays_that_are_projected_back_to_their_pixels(
        probe in any_probe(),
        fractions in any_fractions(),
    ) {
        for effect in library() {
            let (id, p) = (effect.id(), values(*effect, |index| fractions[index]));
            let camera = effect.lens(&p, probe.camera.clone()).unwrap();
            for pixel in central_pixels(&camera) {
                let back = camera.project_unbounded(camera.unproject(pixel).unwrap()).unwrap();
                prop_assert!(back.distance(pixel) < 1e-6, "{id} {p:?}: {pixel} {back}");
            }
        }
    }
}

/// Parts into which a range is cut in the search for a jump, again and again.
const PARTS: usize = 16;

/// Returns the change of a function over the shortest part of 0 to 1 to which the search for its steepest part leads: about 0
/// where it is continuous.
fn jump(function: impl Fn(f64) -> f64) -> f64 {
    let (mut start, mut length, mut change) = (0.0, 1.0, 0.0);
    for _ in 0..7 {
        length /= PARTS as f64;
        let at = |part: usize| function(start + part as f64 * length);
        let steps = (0..PARTS).map(|part| (part, (at(part + 1) - at(part)).abs()));
        let (part, largest) = steps.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        (start, change) = (start + part as f64 * length, largest);
    }
    change
}

#[test]
fn a_jump_is_found() {
    let with_jump = |x: f64| x.powi(2) + if x > 0.3217 { 0.2 } else { 0.0 };
    assert!((jump(with_jump) - 0.2).abs() < 1e-6);
    assert!(jump(|x| x.powi(2)) < 1e-6);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    #[test]
    fn no_effect_jumps_anywhere_in_its_range(probe in any_probe(), fractions in any_fractions()) {
        for effect in library() {
            let p = values(*effect, |index| fractions[index]);
            for index in fitted(*effect) {
                let [low, high] = effect.parameters()[index].range;
                let along = |fraction: f64| {
                    let mut moved = p.clone();
                    moved[index] = low + fraction * (high - low);
                    outputs(*effect, &moved, &probe)
                };
                let ends = [along(0.0), along(0.5), along(1.0)];
                let changed = (0..ends[0].len()).filter(|output| ends.iter().any(|end| end[*output] != ends[0][*output]));
                for output in changed {
                    let jump = jump(|fraction| along(fraction)[output]);
                    prop_assert!(jump < 1e-4, "{} {p:?} {index}: {jump}", effect.id());
                }
            }
        }
    }
}

/// Returns the pixels of the picture around its principal point, as far as a third of the way to a corner: every plausible
/// lens sees something there.
fn central_pixels(camera: &Camera) -> impl Iterator<Item = DVec2> {
    let principal_point = DVec2::new(camera.cx, camera.cy);
    let radius_px = f64::from(camera.width).hypot(camera.height.into()) / 6.0;
    let pixels =
        (0..camera.width).flat_map(|u| (0..camera.height).map(move |v| DVec2::new(u.into(), v.into())));
    pixels.filter(move |pixel| pixel.distance(principal_point) < radius_px)
}

/// Returns values at which an effect is drawn: neutral ones, all at one end of their ranges, and each alone at one end.
fn drawn_values(effect: &dyn Effect) -> Vec<Vec<f64>> {
    let value = |(index, parameter): (usize, &Parameter)| match parameter.role {
        Role::Fixed => RECORDING_S[index % 2],
        _ => parameter.neutral,
    };
    let neutral: Vec<f64> = effect.parameters().iter().enumerate().map(value).collect();
    let mut all = vec![neutral.clone()];
    for end in [0, 1] {
        all.push(values(effect, |_| end as f64));
        all.extend(fitted(effect).map(|alone| {
            let mut p = neutral.clone();
            p[alone] = effect.parameters()[alone].range[end];
            p
        }));
    }
    all
}

/// Draws the picture that a walking robot takes with one effect, with noise.
fn drawn(effect: &'static dyn Effect, p: Vec<f64>) -> RgbImage {
    let setup = common::measured_setup(common::fisheye([64, 48], 22.0));
    let model = Model::default().with(effect, p);
    let renderer = Renderer::with_model(&setup, &common::field(), common::colors(), &model).unwrap();
    renderer.draw_at(&common::walk(), 0.05, Some(3)).unwrap()
}

#[test]
fn a_picture_at_any_end_of_the_ranges_changes_by_one_level_at_most_with_a_small_step() {
    for effect in library() {
        for p in drawn_values(*effect) {
            let near = fitted(*effect).fold(p.clone(), |near, index| stepped(*effect, &near, index, 1e-6));
            let pictures = [p.clone(), near].map(|p| drawn(*effect, p));
            let changes = pictures[0].iter().zip(pictures[1].iter()).map(|(a, b)| a.abs_diff(*b));
            let changes: Vec<u8> = changes.collect();
            assert!(changes.iter().all(|change| *change <= 1), "{} {p:?}", effect.id());
            let changed = changes.iter().filter(|change| **change > 0).count();
            assert!(100 * changed < changes.len(), "{} {p:?}: {changed}", effect.id());
        }
    }
}
