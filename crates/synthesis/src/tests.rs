use std::{path::Path, sync::Arc};

use image::{Rgb, RgbImage};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::{FrameRecord, Sequence, save_image},
    warp::{CpuWarper, Hall, MAX_SOURCES, ProxyGeometry, Warper},
};
use reality_sim_db::{Database, PoseEstimate, PoseSource, index::NoNeighbours};
use tempfile::TempDir;

use crate::{
    quality::{Mask, psnr_db},
    *,
};

/// Frames of the walk that are not in the database.
const LEFT_OUT: std::ops::Range<usize> = 20..30;

fn walk() -> Sequence {
    Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk")).unwrap()
}

/// Stores the walk without some frames in a database.
fn stored(sequence: &Sequence) -> (TempDir, Archive) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.db");
    let poses: Vec<Option<PoseEstimate>> =
        sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    let mut database = Database::create_or_open(&path).unwrap();
    database.ingest(sequence, &poses, &PoseSource::GroundTruth).unwrap();
    let archive = Archive::open(&path, 64 << 20).unwrap();
    (folder, archive)
}

fn without_some_frames() -> (TempDir, Synthesizer) {
    let mut sequence = walk();
    LEFT_OUT.for_each(|frame| sequence.frames[frame].reference_pose = None);
    let (folder, archive) = stored(&sequence);
    (folder, Synthesizer::new(Arc::new(archive)))
}

fn truth(walk: &Sequence, frame: usize) -> (CameraPose, RgbImage) {
    (walk.frames[frame].reference_pose.unwrap(), walk.load_image(frame).unwrap())
}

#[test]
fn frames_that_were_left_out_look_as_they_were_recorded() {
    let walk = walk();
    let (_folder, synthesizer) = without_some_frames();
    let field_psnr_db = |frame: usize, method: MethodKind| {
        let (pose, truth) = truth(&walk, frame);
        let mask = Mask::carpet(synthesizer.camera(), pose, &walk.field);
        psnr_db(&synthesizer.image_at(pose, &method).unwrap().picture, &truth, Some(&mask)).unwrap()
    };
    let mean_db = |method: MethodKind| {
        LEFT_OUT.map(|frame| field_psnr_db(frame, method)).sum::<f64>() / LEFT_OUT.len() as f64
    };
    let [nearest, quadratic, plane, blend] = MethodKind::COMPARED.map(mean_db);
    assert!(plane > nearest + 5.0 && plane > quadratic + 2.0, "{plane} {nearest} {quadratic}");
    assert!(blend > nearest + 8.0 && blend > plane, "{blend} {nearest} {plane}");
}

#[test]
fn at_a_recorded_pose_the_nearest_picture_is_the_one_recorded() {
    let walk = walk();
    let (_folder, synthesizer) = without_some_frames();
    let (pose, recorded) = truth(&walk, 7);
    let found = synthesizer.image_at(pose, &Nearest).unwrap();
    assert_eq!(found.picture, recorded);
    assert_eq!(synthesizer.archive().images()[found.used[0].image as usize].frame_index, 7);
    assert!(found.origins.iter().all(|origin| origin.trust == 255));
}

#[test]
fn the_recorded_picture_is_given_where_there_is_one_and_a_reconstruction_elsewhere() {
    let walk = walk();
    let (_folder, synthesizer) = without_some_frames();
    let (pose, recorded) = truth(&walk, 7);
    assert_eq!(synthesizer.image_at(pose, &Auto).unwrap().picture, recorded);
    let beside = CameraPose { yaw_rad: pose.yaw_rad + 0.02, ..pose };
    let made = synthesizer.image_at(beside, &Auto).unwrap();
    assert_eq!(made, synthesizer.image_at(beside, &Blend).unwrap());
    // Another lens would have shown something else.
    let archive = synthesizer.archive().clone();
    let mut camera = synthesizer.camera().clone();
    camera.fx = 200.0;
    let config = SynthesisConfig::new(&archive);
    let other = Synthesizer::with(archive, camera, Arc::new(CpuWarper), config);
    assert_eq!(other.image_at(pose, &Auto).unwrap().method, "blend");
}

/// An image from another lens of the same size is slightly nearer; the picture of the right lens is returned all the same.
#[test]
fn the_recorded_picture_is_that_of_the_lens_wanted() {
    let mut walk = walk();
    let (folder, archive) = stored(&walk);
    let path = archive.database().path().to_path_buf();
    let (pose, recorded) = truth(&walk, 7);
    walk.name = "another lens".to_owned();
    walk.setup.camera.fx = 200.0;
    let beside = CameraPose { yaw_rad: pose.yaw_rad + 5e-4, ..pose };
    walk.frames[9].reference_pose = Some(beside);
    let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    let mut database = Database::create_or_open(&path).unwrap();
    database.ingest(&walk, &poses, &PoseSource::GroundTruth).unwrap();
    let synthesizer = Synthesizer::new(Arc::new(Archive::open(&path, 64 << 20).unwrap()));
    assert_eq!(synthesizer.camera(), archive.camera_of(7), "of equals the first one");
    assert_eq!(synthesizer.image_at(beside, &Auto).unwrap().picture, recorded);
    drop(folder);
}

#[test]
fn the_maps_of_origin_and_trust_agree_with_what_was_used() {
    let (_folder, synthesizer) = without_some_frames();
    let (pose, _) = truth(&walk(), 25);
    for method in MethodKind::COMPARED {
        let made = synthesizer.image_at(pose, &method).unwrap();
        assert_eq!(made.origins.len(), 640 * 480, "{}", method.name());
        let used: f64 = made.used.iter().map(|used| used.share).sum();
        assert!((used - made.covered()).abs() < 1e-9, "{}", method.name());
        assert!(made.used.len() <= if method.name() == "blend" { synthesizer.config().sources } else { 1 });
        let black = made.origin_picture().pixels().filter(|pixel| pixel.0 == [0; 3]).count();
        let nowhere = made.origins.iter().filter(|origin| !origin.is_recorded()).count();
        assert_eq!(black, nowhere, "{}", method.name());
    }
}

#[test]
fn a_callers_buffer_gets_the_same_pixels_and_keeps_its_own_where_a_pose_is_refused() {
    let (_folder, synthesizer) = without_some_frames();
    let (pose, _) = truth(&walk(), 25);
    let mut buffer = vec![7; 3 * 640 * 480];
    for method in MethodKind::COMPARED {
        let made = synthesizer.image_at(pose, &method).unwrap();
        let provenance = synthesizer.image_into(pose, &method, &mut buffer).unwrap();
        assert!(buffer == *made.picture && provenance.origins == made.origins, "{}", method.name());
    }
    let before = buffer.clone();
    assert!(synthesizer.image_into(CameraPose::default(), &Auto, &mut buffer).is_err());
    assert!(buffer == before);
    let short = synthesizer.image_into(pose, &Auto, &mut buffer[1..]).unwrap_err();
    assert!(matches!(short, SynthesisError::BufferLength { found: 921_599, expected: 921_600 }), "{short}");
}

#[test]
fn what_cannot_be_answered_is_refused_and_the_best_effort_is_not() {
    let (_folder, synthesizer) = without_some_frames();
    let usual = synthesizer.archive().usual_pose();
    let away = usual.with_planar(Pose2::new(2.9, -1.9, -1.5));
    let outside = usual.with_planar(Pose2::new(40.0, 0.0, 0.0));
    for method in MethodKind::COMPARED {
        let error = synthesizer.image_at(outside, &method).unwrap_err();
        assert!(
            matches!(error, SynthesisError::NoNeighbours { reason: NoNeighbours::OutOfReach { .. }, .. }),
            "{error}"
        );
        let nowhere = CameraPose { x_m: f64::NAN, ..usual };
        let error = synthesizer.image_at(nowhere, &method).unwrap_err();
        assert!(
            matches!(error, SynthesisError::NoNeighbours { reason: NoNeighbours::NotFinite, .. }),
            "{error}"
        );
        for impossible in [CameraPose { height_m: -0.1, ..usual }, CameraPose { x_m: 1e9, ..usual }] {
            let error = synthesizer.image_at(impossible, &method).unwrap_err();
            assert!(matches!(error, SynthesisError::ImpossiblePose { .. }), "{error}");
        }
    }
    let error = synthesizer.image_at(away, &Blend).unwrap_err();
    assert!(error.is_refusal(), "{error}");
    let archive = synthesizer.archive().clone();
    let config = SynthesisConfig::new(&archive).best_effort();
    let eager = Synthesizer::with(archive, synthesizer.camera().clone(), Arc::new(CpuWarper), config);
    for method in [&Nearest as &dyn Method, &Plane, &Blend] {
        assert_eq!(eager.image_at(outside, method).unwrap().picture.dimensions(), (640, 480));
    }
}

#[test]
fn threads_get_the_same_pictures_and_the_cache_keeps_its_bound() {
    let walk = walk();
    let folder;
    let synthesizer;
    {
        let (temporary, archive) = stored(&walk);
        let path = archive.database().path().to_path_buf();
        // The cache has room for three pictures.
        synthesizer = Synthesizer::new(Arc::new(Archive::open(&path, 3 * 640 * 480 * 4).unwrap()));
        folder = temporary;
    }
    let poses: Vec<CameraPose> =
        (0..6).map(|frame| walk.frames[10 * frame].reference_pose.unwrap()).collect();
    let alone: Vec<_> = poses.iter().map(|&pose| synthesizer.image_at(pose, &Blend).unwrap()).collect();
    std::thread::scope(|scope| {
        for thread in 0..3 {
            let (synthesizer, poses, alone) = (&synthesizer, &poses, &alone);
            scope.spawn(move || {
                for step in 0..poses.len() {
                    let index = (step + 2 * thread) % poses.len();
                    assert_eq!(synthesizer.image_at(poses[index], &Blend).unwrap(), alone[index]);
                }
            });
        }
    });
    assert!(synthesizer.archive().cached_bytes() <= 3 * 640 * 480 * 4);
    drop(folder);
}

#[test]
fn what_was_prepared_needs_no_more_decoding() {
    let (_folder, synthesizer) = without_some_frames();
    let (pose, _) = truth(&walk(), 25);
    synthesizer.prepare(pose).unwrap();
    let held = synthesizer.archive().cached_bytes();
    let picture_bytes = 640 * 480 * 4;
    assert!((1..=synthesizer.config().sources + 1).contains(&(held / picture_bytes)), "{held}");
    synthesizer.image_at(pose, &Blend).unwrap();
    assert_eq!(synthesizer.archive().cached_bytes(), held);
}

/// Returns a pose that the picture moves away from by about this much.
fn moved_px(synthesizer: &Synthesizer, pose: CameraPose, distance_px: f64) -> CameraPose {
    let turned = |turn_rad: f64| CameraPose { yaw_rad: pose.yaw_rad + turn_rad, ..pose };
    let per_rad = synthesizer.archive().index().metric().distance_px(pose, turned(0.01)) / 0.01;
    turned(distance_px / per_rad)
}

#[test]
fn a_camera_that_moves_keeps_its_neighbours_for_some_pixels() {
    let (_folder, synthesizer) = without_some_frames();
    let (pose, _) = truth(&walk(), 25);
    let mut memory = Memory::default();
    let mut buffer = vec![0; 3 * 640 * 480];
    let mut along = |pose: CameraPose, memory: &mut Memory| {
        let provenance = synthesizer.image_along(pose, &Blend, memory, &mut buffer).unwrap();
        (buffer.clone(), provenance.used)
    };
    let images = |used: &[UsedImage]| used.iter().map(|used| used.image).collect::<Vec<_>>();
    let (first, used) = along(pose, &mut memory);
    assert_eq!(first, synthesizer.image_at(pose, &Blend).unwrap().picture.into_raw());
    let near = moved_px(&synthesizer, pose, 6.0);
    let (_, near_used) = along(near, &mut memory);
    assert_eq!(images(&near_used), images(&used));
    assert_eq!(memory.chosen_at(), Some(pose));
    assert_ne!(near_used[0].distance_px, used[0].distance_px, "distances are those of the new pose");
    // Farther away, and after forgetting, nothing is left of what was before.
    let far = moved_px(&synthesizer, pose, 30.0);
    assert_eq!(along(far, &mut memory).0, synthesizer.image_at(far, &Blend).unwrap().picture.into_raw());
    assert_eq!(memory.chosen_at(), Some(far));
    let (_, _) = along(moved_px(&synthesizer, far, 6.0), &mut memory);
    memory.forget();
    assert_eq!(along(near, &mut memory).0, synthesizer.image_at(near, &Blend).unwrap().picture.into_raw());
}

#[test]
fn neighbours_that_were_kept_show_what_new_ones_would() {
    let walk = walk();
    let (_folder, synthesizer) = without_some_frames();
    let mut buffer = RgbImage::new(640, 480);
    let mut lost_db = 0.0;
    for frame in LEFT_OUT {
        let (pose, truth) = truth(&walk, frame);
        let mask = Mask::carpet(synthesizer.camera(), pose, &walk.field);
        let psnr_db = |picture: &RgbImage| psnr_db(picture, &truth, Some(&mask)).unwrap();
        let side = if frame % 2 == 0 { 7.5 } else { -7.5 };
        let mut memory = Memory::default();
        for pose in [moved_px(&synthesizer, pose, side), pose] {
            synthesizer.image_along(pose, &Blend, &mut memory, &mut buffer).unwrap();
        }
        assert_ne!(memory.chosen_at(), Some(pose));
        lost_db += psnr_db(&synthesizer.image_at(pose, &Blend).unwrap().picture) - psnr_db(&buffer);
    }
    assert!(lost_db / (LEFT_OUT.len() as f64) < 0.2, "{lost_db}");
}

#[test]
fn a_device_of_ones_own_gets_what_a_blended_picture_is_made_from() {
    let (_folder, synthesizer) = without_some_frames();
    let (pose, _) = truth(&walk(), 25);
    let blended = synthesizer.image_at(pose, &Blend).unwrap();
    let mut memory = Memory::default();
    let warped = synthesizer
        .draw_with(pose, &mut memory, |target, sources, weights| {
            CpuWarper.blend(target, sources, weights).unwrap()
        })
        .unwrap();
    assert_eq!(warped.colors.as_flattened(), blended.picture.as_raw().as_slice());
    let nowhere = CameraPose { x_m: f64::NAN, ..pose };
    assert!(synthesizer.draw_with(nowhere, &mut memory, |_, _, _| ()).is_err());
}

#[test]
fn what_is_expected_is_decoded_in_the_background() {
    let (_folder, synthesizer) = without_some_frames();
    let synthesizer = Arc::new(synthesizer);
    let (pose, _) = truth(&walk(), 25);
    let ahead = Ahead::new(synthesizer.clone());
    ahead.expect(CameraPose { x_m: f64::NAN, ..pose });
    ahead.expect(pose);
    let at_least = (synthesizer.config().sources * 3 / 4 * 640 * 480 * 4, 60_000);
    for _ in 0..at_least.1 {
        if synthesizer.archive().cached_bytes() >= at_least.0 {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    panic!("nothing was decoded");
}

/// Jumps of the exposure would show at the borders between pictures if the gains did not match.
#[test]
fn pictures_of_different_brightness_are_brought_together() {
    let folder = tempfile::tempdir().unwrap();
    let mut bright_and_dark = walk();
    bright_and_dark.folder = folder.path().to_path_buf();
    for frame in 0..bright_and_dark.frames.len() {
        let factor = if frame % 2 == 0 { 0.75 } else { 1.0 };
        let mut picture = walk().load_image(frame).unwrap();
        picture.pixels_mut().for_each(|Rgb(rgb)| *rgb = rgb.map(|value| (f64::from(value) * factor) as u8));
        let name = Path::new("images").join(format!("{frame:06}.png"));
        save_image(&folder.path().join(&name), &picture).unwrap();
        bright_and_dark.frames[frame].image = name;
    }
    let (_folder, archive) = stored(&bright_and_dark);
    let synthesizer = Synthesizer::new(Arc::new(archive));
    let (_even_folder, even) = stored(&walk());
    let even = Synthesizer::new(Arc::new(even));
    let (pose, _) = truth(&walk(), 25);
    let [made, wanted] = [&synthesizer, &even].map(|from| from.image_at(pose, &Blend).unwrap().picture);
    // Only a common factor remains of the jumps.
    let ratios: Vec<f64> = made
        .pixels()
        .zip(wanted.pixels())
        .filter(|(_, b)| b.0[1] > 60)
        .map(|(a, b)| f64::from(a.0[1]) / f64::from(b.0[1]))
        .collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let spread =
        (ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / ratios.len() as f64).sqrt();
    assert!((0.74..1.01).contains(&mean) && spread < 0.05, "{mean} ± {spread}");
}

/// Paints a hall with known walls, photographs it, and measures it.
#[test]
fn the_hall_is_measured_from_what_pictures_agree_on() {
    let walk = walk();
    let hall = Hall {
        min_m: glam::DVec2::new(-5.2, -3.3),
        max_m: glam::DVec2::new(4.4, 4.6),
        ceiling_m: 2.6,
        goal_depth_m: 0.4,
    };
    let mut proxy = ProxyGeometry::new(&hall, &walk.field);
    proxy.billboards.iter_mut().for_each(|billboard| billboard.half_width_m = -1.0);
    let (_pictures, sequence) = painted(&walk, &proxy);
    let (_folder, archive) = stored(&sequence);
    let found = measure_hall(&archive).unwrap().unwrap();
    assert!((found.min_m - hall.min_m).abs().max_element() < 0.15, "{found:?}");
    assert!((found.max_m - hall.max_m).abs().max_element() < 0.15, "{found:?}");
    assert!((found.ceiling_m - hall.ceiling_m).abs() < 0.15, "{found:?}");
}

/// Makes a recording of a painted hall from many places.
fn painted(walk: &Sequence, proxy: &ProxyGeometry) -> (TempDir, Sequence) {
    let pictures = tempfile::tempdir().unwrap();
    let folder = pictures.path().to_path_buf();
    let mut setup = walk.setup.clone();
    let lens = setup.camera.distortion;
    setup.camera = reality_sim_core::camera::Camera::new([160, 120], [54.0, 54.0, 79.5, 59.5], lens).unwrap();
    let mut frames = Vec::new();
    for number in 0..60 {
        // The places and headings fill the field evenly (Roberts' sequence).
        let part = |step: f64| (0.5 + f64::from(number) * step).fract();
        let planar = Pose2::new(
            5.0 * part(0.819_173) - 2.5,
            3.4 * part(0.671_044) - 1.7,
            std::f64::consts::TAU * part(0.549_7),
        );
        let pose = CameraPose::new(planar, 0.5, 0.25, 0.0);
        let image = Path::new("images").join(format!("{number:06}.png"));
        let picture = RgbImage::from_fn(160, 120, |u, v| {
            let pixel = glam::DVec2::new(f64::from(u), f64::from(v));
            let ray = pose.rotation_world_from_camera() * setup.camera.unproject(pixel).unwrap();
            let mut distance = f64::INFINITY;
            for axis in 0..3 {
                let wall = if ray[axis] < 0.0 { proxy.min_in_world[axis] } else { proxy.max_in_world[axis] };
                distance = distance.min((wall - pose.position_in_world()[axis]) / ray[axis]);
            }
            let end = pose.position_in_world() + distance * ray;
            Rgb([end.x, end.y, end.z + 0.5 * end.x].map(|at| (128.0 + 90.0 * (2.0 * at).sin()) as u8))
        });
        save_image(&folder.join(&image), &picture).unwrap();
        frames.push(FrameRecord {
            timestamp_s: f64::from(number),
            image,
            odometry: None,
            pitch_rad: pose.pitch_rad,
            roll_rad: 0.0,
            reference_pose: Some(pose),
        });
    }
    (pictures, Sequence { folder, setup, frames, ..walk.clone() })
}

#[test]
fn a_database_without_images_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("empty.db");
    drop(Database::create_or_open(&path).unwrap());
    let error = Archive::open(&path, 0).unwrap_err();
    assert!(matches!(error, SynthesisError::Empty { .. }), "{error}");
}

#[test]
fn more_sources_than_can_be_mixed_are_cut_off() {
    let (_folder, archive) = stored(&walk());
    let archive = Arc::new(archive);
    let config = SynthesisConfig::new(&archive).with_sources(3 * MAX_SOURCES);
    let camera = archive.setup().camera.clone();
    let synthesizer = Synthesizer::with(archive, camera, Arc::new(CpuWarper), config);
    let (pose, _) = truth(&walk(), 25);
    assert!(synthesizer.image_at(pose, &Blend).unwrap().used.len() <= MAX_SOURCES);
}
