use super::*;

const STEP: Motion2 = Motion2 { forward_m: 0.05, left_m: 0.0, turn_rad: 0.02 };
/// Line fractions of a pose that fits, of one that neither fits nor is lost, and of one that is lost.
const GOOD: f64 = 0.8;
const POOR: f64 = 0.42;
const BAD: f64 = 0.1;

/// Returns the agreement of a pose with this line fraction that explains all lines of its picture.
fn agreeing(line_fraction: f64) -> Agreement {
    Agreement { line_fraction, explained_fraction: 1.0, is_at_fit: true }
}

fn track(beginning: Beginning) -> Track {
    let start = Pose2::new(-1.0, 0.5, 0.3);
    Track::new(TrackConfig::default(), start, Some(Pose2::default()), beginning)
}

/// Returns a track with a given start whose first picture fitted.
fn settled() -> Track {
    let mut track = track(Beginning::Given);
    assert!(track.settle(Pose2::new(-1.0, 0.5, 0.3), agreeing(GOOD)));
    track
}

/// Predicts the next picture, with odometry that advances by one step.
fn step(track: &mut Track) -> Prediction {
    let odometry = track.odometry.unwrap().moved(STEP);
    track.predict(Some(odometry), &MotionNoise::default())
}

#[test]
fn a_given_start_is_settled_at_the_first_picture_that_fits_and_its_half_is_known() {
    let mut track = track(Beginning::Given);
    assert!(!track.is_unconfirmed() && track.is_half_sure() && track.mirrored_probability() == 0.0);
    assert!(!track.asks_for_half(GOOD), "whoever gave the start knew the half");
    assert!(track.settle(Pose2::new(0.0, 0.0, 0.0), agreeing(GOOD)));
    assert_eq!(track.prior().sigma, TrackConfig::default().settled_sigma);
}

#[test]
fn a_search_with_one_answer_settles_at_once_and_one_with_several_after_four_pictures_that_fit() {
    let mut clear = track(Beginning::Searched { is_clear: true });
    assert!(clear.settle(Pose2::default(), agreeing(GOOD)));

    let mut unclear = track(Beginning::Searched { is_clear: false });
    assert!(unclear.is_unconfirmed());
    let fits: Vec<bool> = (0..5).map(|_| unclear.settle(Pose2::default(), agreeing(GOOD))).collect();
    assert_eq!(fits, [false, false, false, true, true]);
}

#[test]
fn a_pose_that_fits_but_is_not_confirmed_moves_the_anchor_with_the_likely_uncertainty() {
    let mut track = track(Beginning::Searched { is_clear: false });
    let pose = Pose2::new(2.0, 1.0, -0.4);
    assert!(!track.settle(pose, agreeing(GOOD)));
    assert_eq!(track.prior(), Prior { pose, sigma: TrackConfig::default().likely_sigma });
}

#[test]
fn one_picture_that_does_not_fit_begins_the_confirmation_anew() {
    let mut track = track(Beginning::Searched { is_clear: false });
    for _ in 0..3 {
        track.settle(Pose2::default(), agreeing(GOOD));
    }
    assert!(!track.is_unconfirmed());
    track.settle(Pose2::default(), agreeing(POOR / 2.0));
    assert!(track.is_unconfirmed());
}

#[test]
fn both_halves_are_alike_after_a_search_until_goals_have_told() {
    let mut track = track(Beginning::Searched { is_clear: true });
    assert_eq!(track.mirrored_probability(), 0.5);
    assert!(!track.is_half_sure() && track.asks_for_half(GOOD) && !track.asks_for_half(POOR / 2.0));
    let goal = [0.0, -4.0];
    for _ in 0..100 {
        assert!(!track.weigh_halves(Pose2::new(1.0, 0.0, 0.0), goal));
        assert!(!track.is_half_sure(), "a hundred pictures of one view are one");
    }
    assert!(!track.weigh_halves(Pose2::new(0.0, 0.0, 0.0), goal) && track.is_half_sure());
}

#[test]
fn evidence_for_the_mirrored_pose_turns_the_track_round() {
    let mut track = track(Beginning::Searched { is_clear: true });
    let pose = Pose2::new(1.0, 0.5, 0.2);
    track.settle(pose, agreeing(GOOD));
    assert!(!track.weigh_halves(pose, [0.0, -1.0]));
    let before = track.mirrored_probability();
    assert!(track.weigh_halves(pose, [0.0, 2.0]));
    assert_eq!(track.prior().pose, pose.mirrored());
    // The evidence counts for the pose that the track has turned to: 2 − 1 for it is as much as 1 against it was.
    assert!((track.mirrored_probability() - before).abs() < 1e-12);
}

#[test]
fn odometry_moves_the_anchor_and_its_uncertainty_grows() {
    let mut track = settled();
    let before = track.prior();
    let prediction = step(&mut track);
    assert!(!prediction.is_kidnapped && !track.needs_search(&prediction));
    let motion = prediction.motion.unwrap();
    assert!((motion.forward_m - STEP.forward_m).abs() < 1e-12 && motion.left_m.abs() < 1e-12);
    let expected = before.pose.moved(STEP);
    assert!((track.prior().pose.position_in_world() - expected.position_in_world()).length() < 1e-12);
    let noise = MotionNoise::default().sigma(Some(STEP));
    assert!(
        (track.prior().sigma.position_m - before.sigma.plus(noise).position_m).abs() < 1e-12,
        "variances add"
    );
}

#[test]
fn without_odometry_the_prediction_stands_still_with_the_noise_of_an_unknown_motion() {
    let noise = MotionNoise::default();
    let mut track = settled();
    let before = track.prior().pose;
    let prediction = track.predict(None, &noise);
    assert_eq!((prediction.motion, prediction.sigma), (None, noise.sigma(None)));
    assert_eq!(track.prior().pose, before.moved(Motion2::default()));
    let prediction = track.predict(Some(Pose2::new(9.0, 0.0, 0.0)), &noise);
    assert_eq!(prediction.motion, None, "a motion takes the odometry of two pictures");
}

#[test]
fn odometry_that_jumps_to_its_origin_is_a_kidnapping_and_the_half_is_unknown() {
    let mut track = settled();
    for _ in 0..3 {
        step(&mut track);
    }
    let prediction = track.predict(Some(Pose2::default()), &MotionNoise::default());
    assert!(prediction.is_kidnapped && prediction.motion.is_none() && track.needs_search(&prediction));
    assert_eq!(prediction.sigma, TrackConfig::default().kidnapped_sigma);
    assert!(!track.is_half_sure());
}

#[test]
fn odometry_near_its_origin_is_no_kidnapping() {
    let mut track = settled();
    step(&mut track);
    let prediction = track.predict(Some(Pose2::default()), &MotionNoise::default());
    assert!(!prediction.is_kidnapped && track.is_half_sure());
}

#[test]
fn a_way_that_is_too_long_for_the_particles_asks_for_a_search() {
    let prediction_of = |forward_m| {
        let mut track = settled();
        let odometry = Pose2::new(forward_m, 0.0, 0.0);
        let prediction = track.predict(Some(odometry), &MotionNoise::default());
        (track, prediction)
    };
    // 0.02 m standing still plus 0.15 m per metre: 0.15 m after 0.87 m, 0.3 m after 1.87 m.
    for (forward_m, is_long, needs_search) in
        [(0.8, false, false), (0.9, true, false), (1.8, true, false), (1.9, true, true)]
    {
        let (track, prediction) = prediction_of(forward_m);
        assert_eq!(track.is_long_way(&prediction), is_long, "{forward_m} m");
        assert_eq!(track.needs_search(&prediction), needs_search, "{forward_m} m");
    }
}

#[test]
fn a_long_way_takes_two_pictures_that_fit_to_be_confirmed() {
    let mut track = settled();
    track.confirm_after_long_way();
    assert!(!track.is_unconfirmed(), "it was right before");
    assert!(!track.settle(Pose2::default(), agreeing(GOOD)));
    assert!(track.settle(Pose2::default(), agreeing(GOOD)));
}

#[test]
fn a_long_way_does_not_shorten_a_confirmation_under_way() {
    let mut track = track(Beginning::Searched { is_clear: false });
    track.confirm_after_long_way();
    assert!(track.is_unconfirmed());
}

#[test]
fn what_fits_is_measured_against_what_is_usual_here() {
    let mut track = settled();
    assert!((track.fits_from() - 0.55 * GOOD).abs() < 1e-12);
    assert!((track.lost_below() - 0.5 * GOOD).abs() < 1e-12);
    assert!(!track.settle(Pose2::default(), agreeing(POOR)));
    assert_eq!(track.doubtful_frames, 0, "neither fits nor lost");
}

#[test]
fn the_usual_line_fraction_follows_slowly_and_fades_while_nothing_is_settled() {
    let mut track = settled();
    assert_eq!(track.usual_line_fraction, GOOD, "the first picture is all that is known");
    track.settle(Pose2::default(), agreeing(0.6));
    assert!((track.usual_line_fraction - (GOOD + 0.05 * (0.6 - GOOD))).abs() < 1e-12);
    let before = track.usual_line_fraction;
    track.settle(Pose2::default(), agreeing(BAD));
    assert!((track.usual_line_fraction - 0.95 * before).abs() < 1e-12);
}

#[test]
fn doubt_widens_the_prior_with_every_bad_picture_up_to_a_limit_and_ends_with_a_good_one() {
    let mut track = settled();
    let lost = TrackConfig::default().lost_sigma.position_m;
    assert_eq!(track.prior_of_lost().sigma.position_m, lost, "the first doubt");
    for times in [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.0, 9.0] {
        assert!(!track.settle(Pose2::new(7.0, 7.0, 0.0), agreeing(BAD)));
        assert!((track.prior().sigma.position_m - times * lost).abs() < 1e-12, "{times}");
    }
    assert_eq!(track.prior().pose, Pose2::new(-1.0, 0.5, 0.3), "the anchor stays where it last fitted");
    track.settle(Pose2::default(), agreeing(GOOD));
    assert_eq!(track.prior().sigma, TrackConfig::default().settled_sigma);
}

#[test]
fn a_relocalization_with_several_answers_is_unconfirmed_and_one_with_a_single_answer_is_not() {
    let mut track = settled();
    let prior = track.prior_of_lost();
    track.relocalize(Some(prior.pose), false, prior);
    assert!(track.is_unconfirmed());
    track.relocalize(Some(prior.pose), true, prior);
    assert!(!track.is_unconfirmed() && track.settle(prior.pose, agreeing(GOOD)));
    track.relocalize(None, false, prior);
    assert!(track.is_unconfirmed(), "nothing was found");
}

#[test]
fn a_relocalization_doubts_the_half_as_much_as_the_prior_does() {
    let pose = Pose2::new(2.0, 0.0, 0.0);
    let prior_of = |position_m, yaw_rad| Prior { pose, sigma: PlanarSigma { position_m, yaw_rad } };
    let mut near = settled();
    near.relocalize(Some(pose), true, prior_of(0.5, 0.4));
    assert!(near.is_half_sure());
    let mut far = settled();
    far.relocalize(Some(pose), true, prior_of(40.0, 40.0));
    assert!(!far.is_half_sure() && far.asks_for_half(GOOD));
    // The wrong half is never more probable than the prior says, and searching does not restore certainty.
    far.relocalize(Some(pose), true, prior_of(0.5, 0.4));
    assert!(!far.is_half_sure());
}
