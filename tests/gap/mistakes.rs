//! Mistakes that people make in a recording's files are recognised before anything is fitted.

use image::{RgbImage, imageops};
use reality_sim::{
    CameraPose, FieldDimensions, Pose2, Sequence,
    field::preset_names,
    gap::{
        Recording, ReferenceSource,
        report::{Finding, InputMistake, Report, Verdict, text::summary},
        shows_lines,
    },
    glam::{DMat3, DQuat, DVec3},
};
use reality_sim_hidden::{Hidden, Random, Recipe};
use tempfile::TempDir;

use crate::{recorded, reported, small};

/// Mistake with the way in which it changes a value.
type Case<T> = (InputMistake, fn(T) -> T);
/// The same of a picture.
type PictureCase = (InputMistake, fn(&RgbImage) -> RgbImage);

/// Records 16 pictures: a mistake shows in few.
fn short(seed: u64, effects: Vec<Hidden>) -> (TempDir, Sequence) {
    recorded(&Recipe { frames: 16, effects, ..small(seed) })
}

fn mistakes(report: &Report) -> Vec<InputMistake> {
    let mistake = |finding: &Finding| match finding {
        Finding::InputMistake { mistake } => Some(*mistake),
        _ => None,
    };
    report.unexplained.iter().filter_map(mistake).collect()
}

/// Asserts that a mistake is the only thing that is said of a recording in which it was made.
fn assert_recognised(mistake: InputMistake, make: impl Fn(&mut Sequence)) {
    let (_folder, mut sequence) = short(3, Vec::new());
    make(&mut sequence);
    let report = reported(&sequence);
    let said = summary(&report);
    assert_eq!(mistakes(&report), [mistake], "{said}");
    assert_eq!((report.verdict, report.effects.len()), (Verdict::Unknown, 0));
    let files = ["groundtruth.tum", "field.toml", "frames.csv", "folder images"];
    assert!(files.iter().any(|file| said.contains(file)) && !said.contains(". "), "{said}");
}

fn poses(sequence: &mut Sequence, change: impl Fn(CameraPose) -> CameraPose) {
    for pose in sequence.frames.iter_mut().filter_map(|frame| frame.reference_pose.as_mut()) {
        *pose = change(*pose);
    }
}

#[test]
fn places_in_millimetres_or_centimetres() {
    for (mistake, factor) in
        [(InputMistake::PosesInMillimeters, 1e3), (InputMistake::PosesInCentimeters, 1e2)]
    {
        assert_recognised(mistake, |sequence| {
            poses(sequence, |pose| CameraPose {
                x_m: factor * pose.x_m,
                y_m: factor * pose.y_m,
                height_m: factor * pose.height_m,
                ..pose
            });
        });
    }
}

#[test]
fn poses_camera_from_world() {
    assert_recognised(InputMistake::PosesCameraFromWorld, |sequence| {
        poses(sequence, |pose| {
            let camera_from_world = pose.quaternion_world_from_camera().inverse();
            let place = camera_from_world * -pose.position_in_world();
            CameraPose::from_world_from_camera(place, camera_from_world)
        });
    });
}

#[test]
fn quaternions_in_another_order_and_rotations_of_another_body() {
    assert_recognised(InputMistake::PosesRealPartFirst, |sequence| {
        poses(sequence, |pose| {
            let DQuat { x, y, z, w } = pose.quaternion_world_from_camera();
            CameraPose::from_world_from_camera(pose.position_in_world(), DQuat::from_xyzw(w, x, y, z))
        });
    });
    assert_recognised(InputMistake::PosesOfBodyAxes, |sequence| {
        poses(sequence, |pose| {
            // Ahead, left and up of the body in the camera's axes.
            let camera_from_body = DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y);
            let rotation = pose.rotation_world_from_camera() * camera_from_body;
            CameraPose::from_world_from_camera(pose.position_in_world(), DQuat::from_mat3(&rotation))
        });
    });
}

#[test]
fn swapped_axes_and_wrong_signs_of_poses() {
    assert_recognised(InputMistake::PosesSwappedPlaces, |sequence| {
        poses(sequence, |pose| CameraPose { x_m: pose.y_m, y_m: pose.x_m, ..pose });
    });
    assert_recognised(InputMistake::PosesToTheRight, |sequence| {
        poses(sequence, |pose| CameraPose {
            y_m: -pose.y_m,
            yaw_rad: -pose.yaw_rad,
            roll_rad: -pose.roll_rad,
            ..pose
        });
    });
    assert_recognised(InputMistake::PosesDown, |sequence| {
        poses(sequence, |pose| CameraPose { height_m: -pose.height_m, ..pose });
    });
    assert_recognised(InputMistake::PosesPitchUp, |sequence| {
        poses(sequence, |pose| CameraPose { pitch_rad: -pose.pitch_rad, ..pose });
    });
}

#[test]
fn pictures_that_are_mirrored_or_upside_down() {
    let cases: [PictureCase; 2] = [
        (InputMistake::PicturesMirrored, imageops::flip_horizontal),
        (InputMistake::PicturesUpsideDown, imageops::rotate180),
    ];
    for (mistake, change) in cases {
        assert_recognised(mistake, |sequence| {
            for frame in 0..sequence.frames.len() {
                let picture = change(&sequence.load_image(frame).unwrap());
                picture.save(sequence.image_path(frame).unwrap()).unwrap();
            }
        });
    }
}

#[test]
fn the_field_of_another_league_and_one_whose_sides_are_swapped() {
    let kid_size = preset_names().position(|name| name == "humanoid-kidsize-2010").unwrap();
    assert_recognised(InputMistake::FieldOfAnotherLeague(kid_size), |sequence| {
        sequence.field = FieldDimensions::preset("spl").unwrap();
    });
    assert_recognised(InputMistake::FieldSwapped, |sequence| {
        let (length_m, width_m) = (sequence.field.width_m, sequence.field.length_m);
        sequence.field = FieldDimensions { length_m, width_m, ..sequence.field.clone() };
    });
}

#[test]
fn pitch_and_roll_in_degrees_swapped_or_with_the_wrong_sign() {
    let cases: [Case<[f64; 2]>; 4] = [
        (InputMistake::AnglesInDegrees, |angles| angles.map(f64::to_degrees)),
        (InputMistake::PitchUp, |[pitch, roll]| [-pitch, roll]),
        (InputMistake::RollCounterClockwise, |[pitch, roll]| [pitch, -roll]),
        (InputMistake::AnglesSwapped, |[pitch, roll]| [roll, pitch]),
    ];
    for (mistake, change) in cases {
        assert_recognised(mistake, |sequence| {
            for frame in &mut sequence.frames {
                [frame.pitch_rad, frame.roll_rad] = change([frame.pitch_rad, frame.roll_rad]);
            }
        });
    }
}

#[test]
fn odometry_in_other_units_swapped_or_to_the_right() {
    let cases: [Case<Pose2>; 4] = [
        (InputMistake::OdometryInMillimeters, |pose| Pose2 {
            x_m: 1e3 * pose.x_m,
            y_m: 1e3 * pose.y_m,
            ..pose
        }),
        (InputMistake::OdometryInDegrees, |pose| Pose2 { yaw_rad: pose.yaw_rad.to_degrees(), ..pose }),
        (InputMistake::OdometrySwapped, |pose| Pose2 { x_m: pose.y_m, y_m: pose.x_m, ..pose }),
        (InputMistake::OdometryToTheRight, |pose| Pose2 { y_m: -pose.y_m, yaw_rad: -pose.yaw_rad, ..pose }),
    ];
    for (mistake, change) in cases {
        assert_recognised(mistake, |sequence| {
            for frame in &mut sequence.frames {
                frame.odometry = frame.odometry.map(change);
            }
        });
    }
}

#[test]
fn nothing_and_no_effect_is_taken_for_a_mistake() {
    let random = &mut Random::new(1);
    for id in ["principal_point", "mount_pitch", "field_dimensions", "odometry_scale"] {
        let effect = Hidden::of(id, 30.0, random).unwrap();
        let (_folder, sequence) = short(5, vec![effect]);
        assert_eq!(mistakes(&reported(&sequence)), [], "{id}");
    }
    for seed in 100..103 {
        let (_folder, sequence) = short(seed, Vec::new());
        assert_eq!(mistakes(&reported(&sequence)), [], "seed {seed}");
    }
}

#[test]
fn a_camera_file_that_is_wrong_by_a_factor() {
    for (factor, percent) in [(1.43, 143_u32), (0.7, 70)] {
        for seed in [3, 4] {
            let (_folder, mut sequence) = short(seed, Vec::new());
            let camera = &mut sequence.setup.camera;
            (camera.fx, camera.fy) = (factor * camera.fx, factor * camera.fy);
            let found = mistakes(&reported(&sequence));
            let [InputMistake::FocalLength { percent: found }] = found[..] else { panic!("{found:?}") };
            assert!(found.abs_diff(percent) <= 4, "seed {seed}: {found} % instead of {percent} %");
        }
    }
    let (_folder, mut sequence) = short(3, Vec::new());
    let camera = &mut sequence.setup.camera;
    for value in [&mut camera.fx, &mut camera.fy, &mut camera.cx, &mut camera.cy] {
        *value *= 2.0;
    }
    let found = mistakes(&reported(&sequence));
    assert!(matches!(found[..], [InputMistake::CameraOfOtherSize { percent: 190..=210 }]), "{found:?}");
}

#[test]
fn pictures_that_show_no_lines() {
    for level in [0, 255] {
        let (_folder, sequence) = short(3, Vec::new());
        for frame in 0..sequence.frames.len() {
            let [width, height] = [sequence.setup.camera.width, sequence.setup.camera.height];
            let picture = RgbImage::from_pixel(width, height, image::Rgb([level; 3]));
            picture.save(sequence.image_path(frame).unwrap()).unwrap();
        }
        assert!(!shows_lines(&sequence).unwrap());
        let report = reported(&sequence);
        assert_eq!((report.verdict, &report.unexplained[..]), (Verdict::Unknown, &[Finding::NoLines][..]));
        assert!(summary(&report).starts_with("No picture shows a white line"), "{}", summary(&report));
    }
    assert!(shows_lines(&short(3, Vec::new()).1).unwrap());
}

#[test]
fn pictures_of_another_field() {
    let (_folder, mut sequence) = short(101, Vec::new());
    sequence.field.length_m = 200.0;
    let report = reported(&sequence);
    let [Finding::ForeignLines { share, .. }] = report.unexplained[..] else {
        panic!("{}", summary(&report))
    };
    assert!(share > 0.5 && report.effects.is_empty(), "{share}");
    assert!(summary(&report).contains("are no lines of the field in field.toml"), "{}", summary(&report));
}

#[test]
fn missing_pictures_are_said_before_missing_poses() {
    let (_folder, sequence) = short(3, Vec::new());
    let poses = vec![None; sequence.frames.len()];
    for frame in 0..sequence.frames.len() {
        std::fs::remove_file(sequence.image_path(frame).unwrap()).unwrap();
    }
    let error = Recording::new(&sequence, &poses, ReferenceSource::Tagged, None).unwrap_err().to_string();
    assert!(error.contains("16 of its 16 pictures are missing (no such file: "), "{error}");
}
