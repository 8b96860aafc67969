//! Pictures of a camera that looks straight down: whoever moves it by a metre moves all lines by 300 pixels.

use std::{f64::consts::FRAC_PI_2, path::Path};

use super::*;
use crate::{
    camera::{Camera, Distortion},
    field::FieldDimensions,
    localization::mount_of_frame,
    mount::MountPose,
    pose::CameraPose,
    preprocess::{LinePoints, Preprocessor},
    sequence::Sequence,
    test_scene,
};

const PX_PER_M: f64 = 300.0;

fn from_above() -> Camera {
    Camera::new([640, 480], [PX_PER_M, PX_PER_M, 319.5, 239.5], Distortion::Pinhole).unwrap()
}

/// Returns a pose a metre above a place, from which the world's x points up in the picture and its y to the left.
fn above(x_m: f64, y_m: f64) -> CameraPose {
    CameraPose { x_m, y_m, yaw_rad: 0.0, height_m: 1.0, pitch_rad: FRAC_PI_2, roll_rad: 0.0 }
}

fn points(camera: &Camera, pose: CameraPose, field: &FieldDimensions) -> LinePoints {
    let picture = test_scene::render(camera, pose, field);
    Preprocessor::new(camera, field.line_width_m).prepare(picture, MountPose::of(pose)).line_points()
}

/// A line parallel to the field's length 1 m from the centre, and nothing else in view of a camera above (1.2, 1).
fn one_line() -> FieldDimensions {
    let field = test_scene::field();
    FieldDimensions { width_m: 2.0, center_circle_diameter_m: 0.0, goal_area_width_m: 0.0, ..field }
}

#[test]
fn a_line_that_is_off_by_so_many_pixels_is_met_within_more_and_not_within_less() {
    let (camera, field, pose) = (from_above(), one_line(), above(1.2, 1.0));
    let seen = points(&camera, pose, &field);
    let meter = LineMeter::new(&camera, &field);
    for (off_px, within) in
        [(0.0, [1, 1]), (4.0, [1, 1]), (6.0, [0, 1]), (9.0, [0, 1]), (11.0, [0, 0]), (24.0, [0, 0])]
    {
        for side in [-1.0, 1.0] {
            let found = meter.measure(&seen, above(1.2, 1.0 + side * off_px / PX_PER_M));
            assert_eq!([found.within_5px, found.within_10px], within, "{off_px} px: {found:?}");
            assert_eq!([found.seen, found.unseen, found.unexplained], [1, 0, 0], "{off_px} px: {found:?}");
        }
    }
    // Along the line nothing changes.
    assert_eq!(meter.measure(&seen, above(1.3, 1.0)).within_5px, 1);
}

#[test]
fn a_line_beyond_reach_is_missed_twice() {
    let (camera, field) = (from_above(), one_line());
    let seen = points(&camera, above(1.2, 1.0), &field);
    let found = LineMeter::new(&camera, &field).measure(&seen, above(1.2, 1.0 + 40.0 / PX_PER_M));
    assert_eq!(found, LineAgreement { unseen: 1, unexplained: 1, ..LineAgreement::default() });
    assert_eq!(found.fraction_within_10px(), Some(0.0));
}

#[test]
fn a_turned_line_is_judged_by_its_far_ends() {
    let (camera, field, pose) = (from_above(), one_line(), above(1.2, 1.0));
    let seen = points(&camera, pose, &field);
    let meter = LineMeter::new(&camera, &field);
    // The line is 480 px long, and nine tenths of it end 216 px from its middle: there 1° is 3.8 px, 2° are 7.5 px, 3° are 11.3 px.
    for (turn_deg, within) in [(1.0_f64, [1, 1]), (2.0, [0, 1]), (3.0, [0, 0])] {
        let found = meter.measure(&seen, CameraPose { yaw_rad: turn_deg.to_radians(), ..pose });
        assert_eq!([found.within_5px, found.within_10px], within, "{turn_deg}°: {found:?}");
    }
}

#[test]
fn the_right_pose_and_its_mirror_pose_meet_all_lines() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    let meter = LineMeter::new(&camera, &field);
    for pose in test_scene::poses() {
        let seen = points(&camera, pose, &field);
        let right = meter.measure(&seen, pose);
        assert!(right.seen >= 2 && right.unexplained == 0, "{right:?}");
        assert_eq!(right.within_5px, right.seen, "{right:?}");
        assert_eq!(right, meter.measure(&seen, pose.mirrored()));
        let lost = CameraPose { x_m: pose.x_m + 0.7, yaw_rad: pose.yaw_rad + 0.5, ..pose };
        let lost = meter.measure(&seen, lost).fraction_within_5px().unwrap();
        assert!(lost < 0.5, "{lost}");
    }
}

#[test]
fn without_lines_there_is_no_fraction_and_no_judgement() {
    let (camera, field) = (from_above(), one_line());
    let nothing = LineMeter::new(&camera, &field).measure(&LinePoints::default(), above(1.2, 4.0));
    assert_eq!((nothing, nothing.fraction_within_5px()), (LineAgreement::default(), None));
    let quality = RecordingQuality::new([(nothing, true); 3]);
    assert_eq!((quality.verdict(), quality.completeness), (Verdict::NothingSeen, 1.0));
    assert_eq!(RecordingQuality::new([]).verdict(), Verdict::Bad);
    // Poses that are not finite project nothing.
    let seen = points(&camera, above(1.2, 1.0), &field);
    let nowhere = CameraPose { x_m: f64::NAN, ..above(1.2, 1.0) };
    assert_eq!(LineMeter::new(&camera, &field).measure(&seen, nowhere).fraction_within_5px(), Some(0.0));
}

#[test]
fn a_recording_is_the_mean_over_its_solutions() {
    let picture = |within_5px, within_10px, unseen| LineAgreement {
        seen: 4,
        within_5px,
        within_10px,
        unseen,
        unexplained: 0,
    };
    let pictures = [
        (picture(4, 4, 0), true),
        (picture(2, 4, 4), true),
        (picture(0, 0, 0), false),
        (LineAgreement::default(), true),
    ];
    let quality = RecordingQuality::new(pictures);
    assert_eq!((quality.lines_within_5px, quality.lines_within_10px), (0.625, 0.75));
    assert_eq!((quality.completeness, quality.measured, quality.verdict()), (0.75, 2, Verdict::Doubtful));
    assert_eq!(
        quality.sentence(),
        "62 % of the field's lines are met within 5 px, 75 % within 10 px; 75 % of the pictures have a solution: \
         doubtful, as at poses 5 cm off or a focal length 2 % off"
    );
    assert_eq!(RecordingQuality::new([(picture(4, 4, 0), true)]).verdict(), Verdict::Good);
    assert_eq!(RecordingQuality::new([(picture(1, 4, 0), true)]).verdict(), Verdict::Bad);
    let unsolved = RecordingQuality::new([(picture(4, 4, 0), false)]);
    assert_eq!((unsolved.lines_within_5px, unsolved.verdict()), (0.0, Verdict::Bad));
    assert_eq!(unsolved.sentence(), "0 % of the pictures have a solution: bad, as most have none");
    let few = RecordingQuality::new((0..10).map(|index| (picture(4, 4, 0), index < 4)));
    assert!(
        few.sentence().ends_with("40 % of the pictures have a solution: bad, as most have none"),
        "{}",
        few.sentence()
    );
}

/// Pictures of two other renderers, with their ground truth.
#[test]
fn in_ray_traced_walks_right_poses_are_good_and_wrong_ones_are_not() {
    for folder in ["../../assets/walk", "../../assets/pitch"] {
        let walk = Sequence::open(Path::new(folder)).unwrap();
        let preprocessor = Preprocessor::new(&walk.setup.camera, walk.field.line_width_m);
        let seen: Vec<(LinePoints, CameraPose)> = (0..walk.frames.len())
            .step_by(6)
            .map(|index| {
                let picture = walk.load_image(index).unwrap();
                let prepared = preprocessor.prepare(picture, mount_of_frame(&walk, index));
                (prepared.line_points(), walk.frames[index].reference_pose.unwrap())
            })
            .collect();
        let meter = LineMeter::new(&walk.setup.camera, &walk.field);
        let quality = |wrong: &dyn Fn(CameraPose) -> CameraPose| {
            RecordingQuality::new(
                seen.iter().map(|(points, pose)| (meter.measure(points, wrong(*pose)), true)),
            )
        };
        let right = quality(&|pose| pose);
        assert!(right.lines_within_5px > 0.95, "{folder}: {right:?}");
        assert_eq!(right.verdict(), Verdict::Good);
        assert_eq!(quality(&CameraPose::mirrored).verdict(), Verdict::Good);
        let beside = quality(&|pose| CameraPose { x_m: pose.x_m + 0.07, y_m: pose.y_m - 0.07, ..pose });
        assert_eq!(beside.verdict(), Verdict::Bad, "{folder}: {beside:?}");
        let lost = quality(&|pose| CameraPose { x_m: -0.5 * pose.y_m, yaw_rad: pose.yaw_rad + 1.0, ..pose });
        assert!(lost.lines_within_10px < 0.2, "{folder}: {lost:?}");
    }
}
