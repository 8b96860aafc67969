use image::GrayImage;
use proptest::prelude::*;

use super::{
    interpolation::{CameraLimits, Cubic, TOLERANCE_PX},
    kernel::{
        contrast_along_lines, contrast_on_any_processor, see_block, sum_along_lines, sum_on_any_processor,
    },
    model::{DARK_LEVEL, flanked, plain},
    samples::{Ground, Samples},
    *,
};
use crate::{
    camera::{Distortion, KernelCamera, LANES, Opencv, OpencvFisheye, Pixels, place_lanes},
    field::{preset_names, sample_lines},
    mount::MountPose,
    pose::Pose2,
    preprocess::Preprocessor,
    test_scene,
};

fn cameras() -> Vec<Camera> {
    let fisheye = |k| Distortion::OpencvFisheye(OpencvFisheye { k });
    let opencv = Opencv { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
    let circle = crate::camera::ImageCircle { cx: 300.0, cy: 390.0, radius: 380.0 };
    vec![
        Camera::new([640, 480], [214.9, 214.9, 319.5, 239.5], fisheye([-0.058, 0.0082, -0.0009, 0.00005]))
            .unwrap(),
        Camera::new([608, 800], [330.2, 330.2, 292.1, 401.3], fisheye([-0.033, 0.001, 0.0, 0.0]))
            .unwrap()
            .with_image_circle(Some(circle)),
        Camera::new([640, 480], [190.0, 190.0, 319.5, 239.5], fisheye([0.0; 4])).unwrap(),
        Camera::new([640, 480], [620.0, 618.0, 306.9, 231.7], Distortion::Opencv(opencv)).unwrap(),
        Camera::new([320, 240], [250.0, 250.0, 160.0, 120.0], Distortion::Pinhole).unwrap(),
    ]
}

fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-4.0..4.0, -3.0..3.0, -3.1..3.1, 0.3..1.0, -0.2..0.9, -0.2..0.2)
        .prop_map(|(x, y, yaw, h, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), h, pitch, roll))
}

/// Returns valid lenses of all models that see up to 90° from the axis, for which the kernel promises 0.01 px; pictures of 320 to 1,280 columns.
fn any_camera() -> impl Strategy<Value = Camera> {
    let lens = prop_oneof![
        prop::array::uniform4(-0.05..0.05).prop_map(|[a, b, c, d]| {
            (0.5..0.8, Distortion::OpencvFisheye(OpencvFisheye { k: [a, 0.3 * b, 0.1 * c, 0.03 * d] }))
        }),
        prop::array::uniform4(-1.0..1.0).prop_map(|[a, b, c, d]| {
            let lens = Opencv { k1: 0.15 * a, k2: 0.05 * b, p1: 0.002 * c, p2: 0.002 * d, k3: 0.0 };
            (0.5..1.5, Distortion::Opencv(lens))
        }),
        Just((0.5..2.0, Distortion::Pinhole)),
    ];
    let size = prop_oneof![Just([320, 240]), Just([640, 480]), Just([1280, 720])];
    let drawn =
        lens.prop_flat_map(move |(focal, lens)| (size.clone(), focal, Just(lens), 0.98..1.02, -0.05..0.05));
    drawn.prop_filter_map("folds within the picture", |(size, focal, lens, aspect, shift)| {
        let [width, height] = size.map(f64::from);
        let intrinsics =
            [focal * width, aspect * focal * width, (0.5 + shift) * width, (0.5 - shift) * height];
        Camera::new(size, intrinsics, lens).ok()
    })
}

fn bits(sums: &[[f32; 2]]) -> Vec<[u32; 2]> {
    sums.iter().map(|sums| sums.map(f32::to_bits)).collect()
}

/// Pixels of the samples of a block, the samples' places on the ground, and whether they are interpolated.
struct View<const N: usize> {
    points: [Ground; N],
    pixels: [Option<Pixels>; N],
    is_interpolated: bool,
}

/// Returns what the loops see of all samples.
fn views<const N: usize>(camera: &KernelCamera, pose: CameraPose, samples: &Samples<N>) -> Vec<View<N>> {
    let pose = CameraFromGround::new(pose);
    let quads = samples.quads.iter().flat_map(|quad| {
        let nodes = quad.nodes.each_ref().map(|nodes| place_lanes(camera, &pose.in_camera(nodes)));
        let wrong = nodes.each_ref().map(|nodes| quad.limits.wrong(nodes));
        let pose = &pose;
        (0..quad.blocks.len()).map(move |block| {
            let is_interpolated = wrong.iter().all(|wrong| wrong[block] == 0);
            let see = |point| {
                see_block(&Cubic::new(), camera, pose, quad, &nodes[point], is_interpolated, [block, point])
            };
            View { points: quad.blocks[block].points, pixels: std::array::from_fn(see), is_interpolated }
        })
    });
    quads.collect()
}

proptest! {
    /// Compares the single-precision loop with the double-precision camera.
    #[test]
    fn the_loop_projects_as_the_camera_does(pose in any_pose(), drawn in any_camera()) {
        let samples = sample_lines(&test_scene::field(), 0.02);
        for camera in cameras().into_iter().chain([drawn]) {
            let kernel = KernelCamera::new(&camera);
            let samples = plain(&samples, &CameraLimits::new(&kernel));
            for View { points: [[x, y]], pixels: [pixels], is_interpolated } in views(&kernel, pose, &samples) {
                let tolerance = if is_interpolated { 0.01 + f64::from(TOLERANCE_PX) } else { 0.01 };
                for lane in (0..LANES).filter(|lane| !x[*lane].is_nan()) {
                    let ground = glam::DVec3::new(f64::from(x[lane]), f64::from(y[lane]), 0.0);
                    let exact = camera.project(pose.camera_from_world(ground));
                    let (seen, u, v) = pixels.map_or((false, 0.0, 0.0), |p| (p.seen[lane] > 0.0, f64::from(p.u[lane]), f64::from(p.v[lane])));
                    let place = glam::DVec2::new(u, v);
                    match exact {
                        Ok(pixel) if seen => {
                            let error = (pixel - place).length();
                            prop_assert!(error < tolerance, "{error} px off at {pixel}, interpolated: {is_interpolated}");
                        }
                        // At the very edge of the picture the two may disagree by a rounding step.
                        Ok(pixel) => {
                            let (right, bottom) = (f64::from(camera.width - 1), f64::from(camera.height - 1));
                            let edge = pixel.x.min(pixel.y).min(right - pixel.x).min(bottom - pixel.y);
                            let rim = camera.image_circle.map_or(f64::INFINITY, |c| c.radius - pixel.distance(glam::DVec2::new(c.cx, c.cy)));
                            prop_assert!(edge < tolerance || rim < tolerance, "{pixel} was not seen");
                        }
                        Err(reason) => prop_assert!(!seen || (u.min(v) < tolerance || matches!(reason, crate::camera::NoPixel::OutsideImage { pixel } | crate::camera::NoPixel::OutsideImageCircle { pixel } if (pixel - place).length() < tolerance)), "{reason}"),
                    }
                }
            }
        }
    }

    /// Compares what is interpolated with what is projected, for the flanks and the nearness, too, on other fields.
    #[test]
    fn what_is_interpolated_is_what_would_be_projected(
        pose in any_pose(), camera in any_camera(), preset in prop::sample::select(preset_names().collect::<Vec<_>>()), spacing_m in 0.01..0.05,
    ) {
        let field = FieldDimensions::preset(preset).unwrap();
        let kernel = KernelCamera::new(&camera);
        let samples =
            flanked(&sample_lines(&field, spacing_m), field.line_width_m, &CameraLimits::new(&kernel));
        let in_camera = CameraFromGround::new(pose);
        for view in views(&kernel, pose, &samples).iter().filter(|view| view.is_interpolated) {
            for (pixels, points) in view.pixels.iter().zip(view.points) {
                let Some(pixels) = pixels else { continue };
                let exact = place_lanes(&kernel, &in_camera.in_camera(&points));
                for lane in (0..LANES).filter(|lane| pixels.seen[*lane] > 0.0) {
                    prop_assert!(exact.cos[lane] >= kernel.min_cos);
                    let (du, dv) = (pixels.u[lane] - exact.u[lane], pixels.v[lane] - exact.v[lane]);
                    prop_assert!(du.hypot(dv) < TOLERANCE_PX, "{} px off", du.hypot(dv));
                    prop_assert!((pixels.nearness[lane] / exact.nearness[lane] - 1.0).abs() < 2e-3);
                }
            }
        }
    }

    /// The build for this processor's widest registers and the portable build agree to the last bit: the same recording
    /// gives the same poses everywhere.
    #[test]
    fn every_build_of_the_loops_gives_the_same_sums(pose in any_pose(), other in any_pose(), seed in any::<u32>()) {
        let picture = GrayImage::from_fn(640, 480, |u, v| {
            image::Luma([(u.wrapping_mul(seed | 1).wrapping_add(v * 31) % 251) as u8])
        });
        let (texture, field) = (Texture::pack(&picture), test_scene::field());
        let samples = sample_lines(&field, 0.05);
        let poses = [CameraFromGround::new(pose), CameraFromGround::new(other)];
        let scale = ContrastScale { per_contrast: 2.0, dark_level: DARK_LEVEL, min_width_px: 0.7, per_width_px: 0.5, relative_area: 1.0 };
        for camera in cameras() {
            let camera = KernelCamera::new(&camera);
            let limits = CameraLimits::new(&camera);
            let (plain, flanked) =
                (plain(&samples, &limits), flanked(&samples, field.line_width_m, &limits));
            let (sum, sum_anywhere) = (
                sum_along_lines(&texture, &camera, &poses, &plain),
                sum_on_any_processor(&texture, &camera, &poses, &plain),
            );
            prop_assert_eq!(bits(&sum), bits(&sum_anywhere));
            // What a pose sees does not depend on the others.
            let alone = sum_along_lines(&texture, &camera, &poses[1..], &plain);
            prop_assert_eq!(bits(&sum[1..]), bits(&alone));
            let (contrast, contrast_anywhere) = (
                contrast_along_lines(&texture, &camera, &poses, &flanked, scale),
                contrast_on_any_processor(&texture, &camera, &poses, &flanked, scale),
            );
            prop_assert_eq!(bits(&contrast), bits(&contrast_anywhere));
        }
    }

    /// Compares the sum with one written out in double precision. Values rise and fall by at most 28 from column to
    /// column and 12 from row to row, so the 0.06 px that the loop may be off change a sample by at most 1.83.
    #[test]
    fn the_loop_sums_what_lies_along_the_lines(pose in any_pose(), seed in any::<u32>()) {
        let picture = GrayImage::from_fn(640, 480, |u, v| {
            image::Luma([((u * 7 + v * 3 + seed % 97) % 122).abs_diff(61) as u8 * 4])
        });
        let samples = sample_lines(&test_scene::field(), 0.05);
        let camera = &cameras()[0];
        let kernel = KernelCamera::new(camera);
        let (texture, points) = (Texture::pack(&picture), plain(&samples, &CameraLimits::new(&kernel)));
        let sums = sum_along_lines(&texture, &kernel, &[CameraFromGround::new(pose)], &points);
        let [sum, seen] = sums[0];
        let (mut expected, mut count) = (0.0, 0.0);
        for sample in &samples {
            if let Ok(pixel) = camera.project(pose.camera_from_world(sample.point_in_world.extend(0.0))) {
                expected += f64::from(texture.sample(pixel.x as f32, pixel.y as f32));
                count += 1.0;
            }
        }
        prop_assert!((f64::from(seen) - count).abs() <= 2.0);
        let allowed = 1e-5 * expected + 1.83 * count + 2.0 * 255.0 * (f64::from(seen) - count).abs();
        prop_assert!((f64::from(sum) - expected).abs() <= allowed, "{sum} instead of {expected}, {seen} and {count} seen");
    }
}

/// Every model prefers the pose from which a picture was drawn to poses a little beside it and to poses far away.
#[test]
fn the_true_pose_scores_best() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    for pose in test_scene::poses() {
        let mount = MountPose::of(pose);
        let picture = test_scene::render(&camera, pose, &field);
        let prepared = Preprocessor::new(&camera, field.line_width_m).prepare(picture, mount);
        for kind in ObservationKind::ALL {
            let mut scorer = CpuScorer::new(&camera, &field, ObservationConfig::new(kind));
            scorer.load(&prepared).unwrap();
            let moved = |x: f64, y: f64, yaw: f64| CameraPose {
                x_m: pose.x_m + x,
                y_m: pose.y_m + y,
                yaw_rad: pose.yaw_rad + yaw,
                ..pose
            };
            let mut poses = vec![pose];
            for step in [-1.0, 1.0] {
                poses.extend([
                    moved(0.08 * step, 0.0, 0.0),
                    moved(0.0, 0.08 * step, 0.0),
                    moved(0.0, 0.0, 0.06 * step),
                ]);
                poses.extend([moved(step, 0.3, 0.9), moved(0.5 * step, -0.7, -1.4)]);
            }
            let scores = scorer.log_weights(&poses).unwrap();
            assert!(scores[1..].iter().all(|score| *score < scores[0]), "{kind:?} at {pose:?}: {scores:?}");
        }
    }
}

/// More light must not change the contrast model's log-weights.
#[test]
fn contrast_does_not_depend_on_the_light() {
    let (camera, field, pose) = (test_scene::fisheye(), test_scene::field(), test_scene::poses()[0]);
    let mount = MountPose::of(pose);
    let bright = test_scene::render(&camera, pose, &field);
    let mut dim = bright.clone();
    dim.iter_mut().for_each(|value| *value = (f32::from(*value) * 0.55) as u8);
    let fraction = |picture: image::RgbImage| {
        let mut scorer = CpuScorer::new(&camera, &field, ObservationConfig::new(ObservationKind::Contrast));
        scorer.load(&Preprocessor::new(&camera, field.line_width_m).prepare(picture, mount)).unwrap();
        scorer.line_fraction(pose).unwrap()
    };
    let (bright, dim) = (fraction(bright), fraction(dim));
    assert!(bright > 0.4 && (bright - dim).abs() < 0.05, "{bright} in full light, {dim} in half");
}

#[test]
fn poses_without_sense_have_a_weight_all_the_same() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    for kind in ObservationKind::ALL {
        let scorer = CpuScorer::new(&camera, &field, ObservationConfig::new(kind));
        let nowhere = CameraPose { x_m: f64::NAN, ..Default::default() };
        let far = CameraPose { x_m: 1e30, height_m: -3.0, ..Default::default() };
        assert!(scorer.log_weights(&[nowhere, far]).unwrap().iter().all(|weight| weight.is_finite()));
    }
}

/// Most blocks of a fine sampling are interpolated for every camera, or the loops would be slow.
#[test]
fn most_samples_are_interpolated() {
    let samples = sample_lines(&test_scene::field(), 0.02);
    for camera in cameras() {
        let kernel = KernelCamera::new(&camera);
        let limits = CameraLimits::new(&kernel);
        let samples = plain(&samples, &limits);
        let seen = |view: &&View<1>| view.pixels[0].is_some();
        let views: Vec<View<1>> =
            test_scene::poses().into_iter().flat_map(|pose| views(&kernel, pose, &samples)).collect();
        let [all, interpolated] = [false, true]
            .map(|only| views.iter().filter(seen).filter(|view| !only || view.is_interpolated).count());
        assert!(2 * interpolated > all, "{interpolated} of {all}: {limits:?} {camera:?}");
    }
}
