//! Accuracy of localization on the demonstration walk: with unknown start, after kidnapping, and smoothed.

use std::path::Path;

use reality_sim::{
    CameraPose, LocalizedFrame, Localizer, LocalizerConfig, ObservationKind, Pose2, Sequence,
    localization::Picture,
};

fn walk() -> Sequence {
    Sequence::open(Path::new("assets/walk")).expect("the demonstration walk is part of the repository")
}

/// Cuts a range of frames out as a recording of its own.
fn cut(mut sequence: Sequence, frames: std::ops::Range<usize>) -> Sequence {
    sequence.frames = sequence.frames[frames].to_vec();
    sequence
}

fn localize(
    sequence: &Sequence,
    start: Option<Pose2>,
    config: LocalizerConfig,
) -> (Localizer, Vec<LocalizedFrame>) {
    let builder = Localizer::builder(&sequence.setup.camera, &sequence.field).config(config).start(start);
    let mut localizer = builder.build().expect("the processor never fails");
    let frames: Result<_, _> = localizer.run(sequence).collect();
    (localizer, frames.expect("every picture can be read"))
}

fn is_right(pose: CameraPose, truth: CameraPose) -> bool {
    let turn = (pose.yaw_rad - truth.yaw_rad).sin().atan2((pose.yaw_rad - truth.yaw_rad).cos());
    (pose.x_m - truth.x_m).hypot(pose.y_m - truth.y_m) < 0.5 && turn.abs() < 0.5
}

#[test]
fn an_unknown_start_is_found_within_five_pictures_without_odometry() {
    let config = LocalizerConfig::default().with_odometry(false);
    for first in [0, 9, 21, 33, 47, 55] {
        let sequence = cut(walk(), first..first + 5);
        let (_, frames) = localize(&sequence, None, config);
        let (last, truth) = (&frames[4], sequence.frames[4].reference_pose.expect("exact truth"));
        assert!(
            is_right(last.pose, truth) || is_right(last.pose.mirrored(), truth),
            "from picture {first}: {:?} instead of {truth:?}",
            last.pose
        );
    }
}

#[test]
fn goals_of_two_colours_tell_the_halves_of_the_field_apart() {
    let config = LocalizerConfig::default();
    let sequence = walk();
    let (_, frames) = localize(&sequence, None, config);
    let last = frames.last().expect("sixty pictures");
    assert!(is_right(last.pose, sequence.frames[59].reference_pose.expect("exact truth")));
    assert!(last.mirrored_probability < 0.05, "{}", last.mirrored_probability);

    let plain = Sequence {
        field: reality_sim::FieldDimensions {
            goal_srgb_positive_x: None,
            goal_srgb_negative_x: None,
            ..sequence.field.clone()
        },
        ..cut(sequence, 0..3)
    };
    let (_, frames) = localize(&plain, None, config);
    assert!(frames.iter().all(|frame| frame.mirrored_probability == 0.5), "nothing tells them apart");
}

/// The robot is carried between pictures: pictures are missing, and the odometry starts again.
#[test]
fn a_kidnapped_robot_is_found_again_and_never_sure_of_a_wrong_pose() {
    for kind in [ObservationKind::Contrast, ObservationKind::Gauss, ObservationKind::Distance] {
        let mut sequence = walk();
        let origin = sequence.frames[40].odometry.expect("the walk has odometry");
        for frame in &mut sequence.frames[40..] {
            let motion = origin.motion_to(frame.odometry.expect("the walk has odometry"));
            frame.odometry = Some(Pose2::default().moved(motion));
        }
        sequence.frames.drain(10..40);
        let (_, frames) = localize(&sequence, sequence.start, LocalizerConfig::new(kind));
        for (index, frame) in frames.iter().enumerate() {
            let truth = sequence.frames[index].reference_pose.expect("exact truth");
            let right = is_right(frame.pose, truth);
            assert!(right || !frame.sure, "{kind:?}: sure and wrong at picture {index}");
            // Only the colours of the goals tell in which half it was put down, once one is in view.
            let found = right || is_right(frame.pose.mirrored(), truth);
            assert!(found || (10..20).contains(&index), "{kind:?}: lost at picture {index}");
        }
    }
}

/// Compares pose errors, in units of their covariance, with the quantiles of χ² with three degrees of freedom.
#[test]
fn smoothed_poses_are_accurate_and_their_covariances_match_their_errors() {
    let sequence = walk();
    let config = LocalizerConfig::default().with_refinement(true);
    let (localizer, frames) = localize(&sequence, sequence.start, config);
    let picture = |index| sequence.load_image(index).map(Picture::from);
    let smoothed = localizer
        .smoother()
        .smooth(&frames, picture)
        .expect("every picture can be read")
        .expect("there are lines");
    let (mut worst_m, mut inside) = (0.0_f64, [0; 3]);
    for (pose, truth) in smoothed.iter().zip(sequence.reference_poses()) {
        let truth = truth.expect("exact truth");
        let error = [pose.pose.x_m - truth.x_m, pose.pose.y_m - truth.y_m, pose.pose.yaw_rad - truth.yaw_rad];
        worst_m = worst_m.max(error[0].hypot(error[1]));
        let planar = pose.covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let inverse = planar.try_inverse().expect("a covariance is positive");
        let squared: f64 =
            (0..3).map(|i| (0..3).map(|j| error[i] * inverse[(i, j)] * error[j]).sum::<f64>()).sum();
        for (count, quantile) in inside.iter_mut().zip([2.366, 6.251, 7.815]) {
            *count += usize::from(squared < quantile);
        }
    }
    assert!(worst_m < 0.016, "{worst_m} m");
    // For sixty poses, two standard errors of a count are 8, 5 and 4.
    let [half, ninety, ninety_five] = inside;
    assert!((20..=46).contains(&half), "{half} of 60 in the 50 % region");
    assert!(
        ninety >= 47 && ninety_five >= 51,
        "{ninety} and {ninety_five} of 60 in the 90 % and 95 % regions"
    );
}

#[test]
fn the_number_of_threads_does_not_change_the_poses() {
    let sequence = cut(walk(), 0..4);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
        let (_, frames) = pool.install(|| localize(&sequence, None, LocalizerConfig::default()));
        frames.into_iter().map(|frame| frame.pose).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(3));
}
