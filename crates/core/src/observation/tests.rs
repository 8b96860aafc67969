use image::GrayImage;
use proptest::prelude::*;

use super::{
    kernel::{
        contrast_along_lines, contrast_on_any_processor, project_block, sum_along_lines, sum_on_any_processor,
    },
    model::{DARK_LEVEL, ground_points, line_points},
    *,
};
use crate::{
    camera::{Distortion, KernelCamera, LANES, Opencv, OpencvFisheye},
    field::sample_lines,
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

proptest! {
    /// Compares the single-precision loop with the double-precision camera, for all models.
    #[test]
    fn the_loop_projects_as_the_camera_does(pose in any_pose()) {
        let samples = sample_lines(&test_scene::field(), 0.1);
        let points = ground_points(&samples, 0.0);
        for camera in cameras() {
            let kernel = KernelCamera::new(&camera);
            for (block, ground) in points.blocks.iter().enumerate() {
                let pixels = project_block(&kernel, &CameraFromGround::new(pose), ground);
                for lane in 0..LANES {
                    let Some(sample) = samples.get(block * LANES + lane) else { continue };
                    let exact = camera.project(pose.camera_from_world(sample.point_in_world.extend(0.0)));
                    let (seen, u, v) = pixels.map_or((false, 0.0, 0.0), |p| (p.seen[lane] > 0.0, p.u[lane], p.v[lane]));
                    match exact {
                        Ok(pixel) if seen => {
                            let error = (pixel - glam::DVec2::new(f64::from(u), f64::from(v))).length();
                            prop_assert!(error < 0.01, "{error} px off at {pixel}");
                        }
                        // At the very edge of the picture the two may disagree by a rounding step.
                        Ok(pixel) => {
                            let (right, bottom) = (f64::from(camera.width - 1), f64::from(camera.height - 1));
                            let edge = pixel.x.min(pixel.y).min(right - pixel.x).min(bottom - pixel.y);
                            let rim = camera.image_circle.map_or(f64::INFINITY, |c| c.radius - pixel.distance(glam::DVec2::new(c.cx, c.cy)));
                            prop_assert!(edge < 0.01 || rim < 0.01, "{pixel} was not seen");
                        }
                        Err(reason) => prop_assert!(!seen || (u.min(v) < 0.01 || matches!(reason, crate::camera::NoPixel::OutsideImage { pixel } | crate::camera::NoPixel::OutsideImageCircle { pixel } if (pixel.x as f32 - u).abs() < 0.01 && (pixel.y as f32 - v).abs() < 0.01)), "{reason}"),
                    }
                }
            }
        }
    }

    /// The build for this processor's widest registers and the portable build agree to the last bit: the same recording
    /// gives the same poses everywhere.
    #[test]
    fn every_build_of_the_loops_gives_the_same_sums(pose in any_pose(), seed in any::<u32>()) {
        let picture = GrayImage::from_fn(640, 480, |u, v| {
            image::Luma([(u.wrapping_mul(seed | 1).wrapping_add(v * 31) % 251) as u8])
        });
        let (texture, field) = (Texture::pack(&picture), test_scene::field());
        let samples = sample_lines(&field, 0.05);
        let (plain, flanked) = (ground_points(&samples, 0.0), line_points(&samples, field.line_width_m));
        let pose = CameraFromGround::new(pose);
        let scale = ContrastScale { per_contrast: 2.0, dark_level: DARK_LEVEL, min_width_px: 0.7, per_width_px: 0.5, relative_area: 1.0 };
        for camera in cameras() {
            let camera = KernelCamera::new(&camera);
            let (sum, sum_anywhere) = (
                sum_along_lines(&texture, &camera, &pose, &plain),
                sum_on_any_processor(&texture, &camera, &pose, &plain),
            );
            prop_assert_eq!(sum.map(f32::to_bits), sum_anywhere.map(f32::to_bits));
            let (contrast, contrast_anywhere) = (
                contrast_along_lines(&texture, &camera, &pose, &flanked, scale),
                contrast_on_any_processor(&texture, &camera, &pose, &flanked, scale),
            );
            prop_assert_eq!(contrast.map(f32::to_bits), contrast_anywhere.map(f32::to_bits));
        }
    }

    /// Compares the sum with one written out in double precision. Values rise and fall by at most 28 from column to
    /// column and 12 from row to row, so the 0.01 px that the loop may be off change a sample by at most 0.31.
    #[test]
    fn the_loop_sums_what_lies_along_the_lines(pose in any_pose(), seed in any::<u32>()) {
        let picture = GrayImage::from_fn(640, 480, |u, v| {
            image::Luma([((u * 7 + v * 3 + seed % 97) % 122).abs_diff(61) as u8 * 4])
        });
        let samples = sample_lines(&test_scene::field(), 0.05);
        let (texture, points) = (Texture::pack(&picture), ground_points(&samples, 0.0));
        let camera = &cameras()[0];
        let [sum, seen] = sum_along_lines(&texture, &KernelCamera::new(camera), &CameraFromGround::new(pose), &points);
        let (mut expected, mut count) = (0.0, 0.0);
        for sample in &samples {
            if let Ok(pixel) = camera.project(pose.camera_from_world(sample.point_in_world.extend(0.0))) {
                expected += f64::from(texture.sample(pixel.x as f32, pixel.y as f32));
                count += 1.0;
            }
        }
        prop_assert!((f64::from(seen) - count).abs() <= 2.0);
        let allowed = 1e-5 * expected + 0.31 * count + 2.0 * 255.0 * (f64::from(seen) - count).abs();
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
