//! Tests of the player without a window: what it sends after commands.

use std::{
    f64::consts::FRAC_PI_2,
    path::Path,
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use eframe::egui::Context;
use reality_sim_core::{
    backend::BackendError, observation::ObservationKind, pose::Pose2, sequence::Sequence,
};

use super::{
    frame::{FrameView, WeightedParticle},
    player::{Beginning, Command, Message, Player, State},
    settings::{FilterSettings, Speed, Veil, WalkSettings},
};
use crate::Device;

/// Time limit, longer than any test takes on the slowest machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn walk(frames: usize) -> Arc<Sequence> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk");
    let mut sequence = Sequence::open(&folder).unwrap();
    sequence.frames.truncate(frames);
    Arc::new(sequence)
}

fn devices() -> Vec<Device> {
    let broken = || Err(BackendError::new("no such card: choose another one"));
    vec![Device::processor(), Device::adapter("broken", broken)]
}

fn settings(filter: FilterSettings) -> WalkSettings {
    WalkSettings { filter, speed: Speed::Filter, ..WalkSettings::default() }
}

fn player(sequence: &Arc<Sequence>, filter: FilterSettings) -> Player {
    let ctx = Context::default();
    Player::spawn(&ctx, sequence.clone(), devices(), &settings(filter), Beginning::Waiting)
}

fn next(player: &mut Player) -> Message {
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        match player.poll() {
            Some(message) => return message,
            None => thread::sleep(Duration::from_millis(1)),
        }
    }
    panic!("the player says nothing");
}

/// Returns the next frame; panics on a problem.
fn next_frame(player: &mut Player) -> FrameView {
    loop {
        match next(player) {
            Message::Frame(frame) => return *frame,
            Message::Problem(reason) => panic!("{reason}"),
            Message::Begun | Message::State(_) => {}
        }
    }
}

fn next_problem(player: &mut Player) -> String {
    loop {
        if let Message::Problem(reason) = next(player) {
            return reason;
        }
    }
}

/// Returns all frames until the player stops.
fn play(player: &mut Player) -> Vec<FrameView> {
    player.tell(Command::Play);
    let (mut frames, mut has_played) = (Vec::new(), false);
    loop {
        match next(player) {
            Message::Frame(frame) => frames.push(*frame),
            Message::State(state) if state.is_playing => has_played = true,
            Message::State(_) if has_played => return frames,
            Message::Problem(reason) => panic!("{reason}"),
            Message::Begun | Message::State(_) => {}
        }
    }
}

fn error_m(frame: &FrameView) -> f64 {
    frame.record.error_m.unwrap()
}

#[test]
fn every_picture_is_played_once_in_order_and_localized_within_a_centimetre() {
    let mut player = player(&walk(12), FilterSettings::default());
    assert_eq!(next_frame(&mut player).record.index, 0);
    // The window is slow: nothing is lost, and the queue does not grow without bound.
    player.tell(Command::Play);
    thread::sleep(Duration::from_millis(300));
    let frames = play(&mut player);
    let indices: Vec<usize> = frames.iter().map(|frame| frame.record.index).collect();
    assert_eq!(indices, (1..12).collect::<Vec<_>>());
    assert!(frames.iter().all(|frame| error_m(frame) < 0.01 && frame.record.sure));
}

#[test]
fn playing_at_the_end_starts_again() {
    let mut player = player(&walk(3), FilterSettings::default());
    next_frame(&mut player);
    assert_eq!(play(&mut player).len(), 2);
    let again: Vec<usize> = play(&mut player).iter().map(|frame| frame.record.index).collect();
    assert_eq!(again, [0, 1, 2]);
}

#[test]
fn particles_that_are_dragged_away_recover() {
    let mut player = player(&walk(14), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::GoTo(1));
    next_frame(&mut player);
    player.tell(Command::Place(Pose2::new(1.5, -1.0, 0.5)));
    let lost = next_frame(&mut player);
    assert_eq!(lost.record.index, 1);
    assert!(error_m(&lost) > 2.0 && !lost.record.sure);
    let far = |particle: &WeightedParticle| {
        particle.pose.position_in_world().distance(glam::DVec2::new(1.5, -1.0)) < 0.6
    };
    assert!(lost.particles.iter().all(far));
    let frames = play(&mut player);
    assert!(frames.iter().any(|frame| frame.record.searched));
    assert!(error_m(frames.last().unwrap()) < 0.02, "{}", error_m(frames.last().unwrap()));
}

#[test]
fn a_frame_seen_before_is_found_again_where_it_was() {
    let mut player = player(&walk(8), FilterSettings::default());
    next_frame(&mut player);
    let before = play(&mut player)[2].record;
    player.tell(Command::GoTo(before.index));
    let after = next_frame(&mut player).record;
    assert_eq!(after.index, before.index);
    let moved_m = (after.pose.x_m - before.pose.x_m).hypot(after.pose.y_m - before.pose.y_m);
    assert!(moved_m < 0.005, "{moved_m}");
    // The filter continues from there.
    player.tell(Command::GoTo(before.index + 1));
    assert!(error_m(&next_frame(&mut player)) < 0.01);
}

#[test]
fn a_frame_far_ahead_is_reached_by_the_odometry() {
    let mut player = player(&walk(60), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::GoTo(25));
    let frame = next_frame(&mut player);
    assert_eq!(frame.record.index, 25);
    assert!(error_m(&frame) < 0.02, "{}", error_m(&frame));
}

#[test]
fn settings_act_on_the_picture_shown() {
    let mut player = player(&walk(4), FilterSettings::default());
    assert_eq!(next_frame(&mut player).record.particles, 800);
    let mut filter = FilterSettings { particles: 300, ..FilterSettings::default() };
    filter.set_model(ObservationKind::Gauss);
    player.tell(Command::Filter(filter));
    let frame = next_frame(&mut player);
    assert_eq!((frame.record.index, frame.record.particles), (0, 300));
    // The paper's models have no refinement: the result is the filter's own pose.
    assert_eq!(frame.record.pose, frame.best_particle);
    assert!(error_m(&frame) < 0.1);
}

#[test]
fn a_veil_changes_the_picture_and_not_the_pose() {
    let mut player = player(&walk(4), FilterSettings::default());
    let bare = next_frame(&mut player);
    assert!(bare.veil.is_none());
    for veil in [Veil::Blurred, Veil::Evidence, Veil::Distances] {
        player.tell(Command::Veil(veil));
        let frame = next_frame(&mut player);
        assert_eq!(frame.record, bare.record);
        assert_eq!(frame.veil.unwrap().size, [640, 480]);
    }
}

#[test]
fn the_heaviest_particle_is_bright_and_the_lines_run_through_the_picture() {
    let mut player = player(&walk(4), FilterSettings::default());
    let frame = next_frame(&mut player);
    let heaviest = frame.particles.iter().map(|particle| particle.relative_weight).fold(0.0, f32::max);
    assert_eq!(heaviest, 1.0);
    assert_eq!(frame.particles.len(), 800);
    // Estimated and true lines coincide: a point of the centre line is at most half a line width from the nearest edge.
    let truth: Vec<_> = frame.truth_lines.iter().flatten().collect();
    let found: Vec<_> = frame.pose_lines.iter().flatten().collect();
    assert!(truth.len() > 100 && found.len() > 200 && !frame.border.is_empty());
    let near = truth.iter().filter(|point| found.iter().any(|edge| edge.distance(***point) < 12.0)).count();
    assert!(near * 20 > truth.len() * 19, "{near} of {}", truth.len());
}

/// Returns everything sent until the player has received this many commands and stands still.
fn until_still(player: &mut Player, commands: u64) -> (Vec<FrameView>, Vec<String>, State) {
    let (mut frames, mut problems) = (Vec::new(), Vec::new());
    loop {
        match next(player) {
            Message::Frame(frame) => frames.push(*frame),
            Message::Problem(reason) => problems.push(reason),
            Message::State(state) if state.heard >= commands && !state.is_playing => {
                return (frames, problems, state);
            }
            Message::Begun | Message::State(_) => {}
        }
    }
}

fn without_picture(frames: usize, missing: usize) -> Arc<Sequence> {
    let mut sequence = Sequence::clone(&walk(frames));
    sequence.frames[missing].image = "images/none.jpg".into();
    Arc::new(sequence)
}

#[test]
fn playing_goes_past_a_picture_that_is_missing_and_names_it() {
    let mut player = player(&without_picture(5, 2), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::Play);
    let (frames, problems, state) = until_still(&mut player, 1);
    let indices: Vec<usize> = frames.iter().map(|frame| frame.record.index).collect();
    assert_eq!((indices, state.at), (vec![1, 3, 4], 4));
    assert!(problems.len() == 1 && problems[0].contains("none.jpg"), "{problems:?}");
    assert!(frames.iter().all(|frame| error_m(frame) < 0.02));
}

#[test]
fn stepping_goes_onto_a_picture_that_is_missing_and_past_it() {
    let mut player = player(&without_picture(4, 1), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::GoTo(1));
    let (frames, problems, state) = until_still(&mut player, 1);
    assert!(frames.is_empty() && problems.len() == 1 && state.at == 1);
    player.tell(Command::GoTo(2));
    let (frames, problems, state) = until_still(&mut player, 2);
    assert!(
        frames[0].record.index == 2 && error_m(&frames[0]) < 0.02 && problems.is_empty() && state.at == 2
    );
}

#[test]
fn without_its_first_picture_a_recording_is_found_from_the_second() {
    let mut player = player(&without_picture(4, 0), FilterSettings::default());
    assert!(next_problem(&mut player).contains("none.jpg"));
    player.tell(Command::GoTo(1));
    let (frames, _, _) = until_still(&mut player, 1);
    assert!(frames[0].record.index == 1 && error_m(&frames[0]) < 0.02);
}

#[test]
fn settings_and_a_frame_that_are_requested_together_both_count() {
    for is_settings_first in [true, false] {
        let mut player = player(&walk(12), FilterSettings::default());
        next_frame(&mut player);
        // The player is busy while these three arrive.
        player.tell(Command::GoTo(1));
        let filter = Command::Filter(FilterSettings { particles: 300, ..FilterSettings::default() });
        let both = if is_settings_first { [filter, Command::GoTo(9)] } else { [Command::GoTo(9), filter] };
        both.into_iter().for_each(|command| player.tell(command));
        let (frames, _, state) = until_still(&mut player, 3);
        let last = frames.last().unwrap().record;
        assert_eq!((last.index, last.particles, state.at), (9, 300, 9));
        assert!(last.error_m.unwrap() < 0.02);
    }
}

#[test]
fn particles_moved_on_the_way_to_another_frame_are_moved_there() {
    let mut player = player(&walk(12), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::GoTo(1));
    player.tell(Command::GoTo(6));
    player.tell(Command::Place(Pose2::new(1.5, -1.0, 0.5)));
    let (frames, _, _) = until_still(&mut player, 3);
    let last = frames.last().unwrap();
    assert!(last.record.index == 6 && error_m(last) > 2.0);
}

#[test]
fn a_device_that_does_not_open_is_a_problem_and_another_one_helps() {
    let broken = FilterSettings { device: "broken".to_owned(), ..FilterSettings::default() };
    let mut player = player(&walk(4), broken);
    assert!(next_problem(&mut player).contains("no such card"));
    player.tell(Command::Filter(FilterSettings {
        device: Device::processor().name().to_owned(),
        ..FilterSettings::default()
    }));
    assert!(error_m(&next_frame(&mut player)) < 0.01);
}

#[test]
fn the_thread_ends_with_the_window() {
    let sequence = walk(30);
    let mut player = player(&sequence, FilterSettings::default());
    player.tell(Command::Play);
    next_frame(&mut player);
    drop(player);
    let begin = Instant::now();
    while Arc::strong_count(&sequence) > 1 {
        assert!(begin.elapsed() < PATIENCE, "it goes on");
        thread::sleep(Duration::from_millis(5));
    }
}

fn demonstration(sequence: &Arc<Sequence>, filter: FilterSettings) -> Player {
    let ctx = Context::default();
    Player::spawn(&ctx, sequence.clone(), devices(), &settings(filter), Beginning::Gathering)
}

/// Returns the steps of the gathering among frames.
fn steps(frames: &[FrameView]) -> Vec<u32> {
    frames.iter().filter_map(|frame| frame.gathering).map(|step| step.number).collect()
}

/// Returns the share of the particles at most half a metre from the true pose or its mirror pose.
fn share_at_place(frame: &FrameView) -> f64 {
    let truth = frame.truth.unwrap().planar();
    let is_near = |pose: Pose2| {
        let distance_m = |place: Pose2| pose.position_in_world().distance(place.position_in_world());
        distance_m(truth) < 0.5 || distance_m(truth.mirrored()) < 0.5
    };
    let near = frame.particles.iter().filter(|particle| is_near(particle.pose)).count();
    near as f64 / frame.particles.len() as f64
}

#[test]
fn the_demonstration_plays_at_once_and_its_particles_gather_from_all_over_the_field() {
    let sequence = walk(4);
    let mut player = demonstration(&sequence, FilterSettings::default());
    let (frames, problems, _) = until_still(&mut player, 0);
    assert!(problems.is_empty(), "{problems:?}");
    let numbers = steps(&frames);
    let count = numbers.len();
    assert!((9..=21).contains(&count) && numbers == (0..count as u32).collect::<Vec<_>>(), "{numbers:?}");
    assert!(frames[..count].iter().all(|frame| frame.record.index == 0 && !frame.record.sure));

    // Every square metre of the carpet has its particles, in all directions.
    let half = sequence.field.carpet_half_extent_m();
    for quarter in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        for heading in 0..4 {
            let is_there = |particle: &&WeightedParticle| {
                let pose = particle.pose;
                let quadrant = (pose.yaw_rad / FRAC_PI_2).floor() as i32;
                pose.x_m * quarter.0 > 0.5 * half.x
                    && pose.y_m * quarter.1 > 0.5 * half.y
                    && quadrant.rem_euclid(4) == heading
            };
            assert!(frames[0].particles.iter().any(|particle| is_there(&particle)), "{quarter:?} {heading}");
        }
    }
    let shares: Vec<f64> = frames[..count].iter().map(share_at_place).collect();
    assert!(shares[0] < 0.1 && shares[count - 1] > 0.9, "{shares:?}");

    // Then the walk begins, found from its start.
    let indices: Vec<usize> = frames[count..].iter().map(|frame| frame.record.index).collect();
    assert_eq!(indices, [0, 1, 2, 3]);
    assert!(frames[count..].iter().all(|frame| error_m(frame) < 0.02));
}

#[test]
fn a_recording_that_waits_gathers_nothing() {
    let mut player = player(&walk(4), FilterSettings::default());
    let (frames, _, state) = until_still(&mut player, 0);
    assert_eq!((frames.len(), steps(&frames).len(), state.at), (1, 0, 0));
}

#[test]
fn the_gathering_pauses_and_goes_on_and_a_restart_begins_it_anew() {
    let mut player = demonstration(&walk(3), FilterSettings::default());
    assert_eq!(next_frame(&mut player).gathering.unwrap().number, 0);
    player.tell(Command::Pause);
    let (before, ..) = until_still(&mut player, 1);
    player.tell(Command::Veil(Veil::Blurred));
    let (paused, ..) = until_still(&mut player, 2);
    // What is shown once more is the step at which it was paused.
    let at = steps(&before).last().copied().unwrap_or(0);
    assert!(steps(&paused) == [at] && paused[0].veil.is_some());
    assert_eq!(steps(&play(&mut player))[0], at + 1);
    // At the end, playing starts again.
    let again = play(&mut player);
    assert_eq!(steps(&again)[..2], [0, 1]);
    player.tell(Command::Restart);
    let (frames, _, state) = until_still(&mut player, 5);
    assert_eq!((steps(&frames), state.at), (vec![0], 0));
}

#[test]
fn another_picture_or_pose_ends_the_gathering() {
    for command in [Command::GoTo(5), Command::Place(Pose2::new(1.5, -1.0, 0.5))] {
        let mut player = demonstration(&walk(8), FilterSettings::default());
        next_frame(&mut player);
        player.tell(Command::Pause);
        until_still(&mut player, 1);
        player.tell(command.clone());
        let (frames, _, state) = until_still(&mut player, 2);
        assert_eq!((frames.len(), steps(&frames).len()), (1, 0), "{command:?}");
        let is_there = if state.at == 5 { error_m(&frames[0]) < 0.02 } else { error_m(&frames[0]) > 2.0 };
        assert!(is_there, "{command:?}");
    }
}

#[test]
fn settings_changed_while_particles_gather_spread_them_anew() {
    let mut player = demonstration(&walk(3), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::Pause);
    until_still(&mut player, 1);
    player.tell(Command::Filter(FilterSettings { particles: 7000, ..FilterSettings::default() }));
    let (frames, ..) = until_still(&mut player, 2);
    assert_eq!((steps(&frames), frames[0].record.particles), (vec![0], 7000));
    player.tell(Command::Filter(FilterSettings { device: "broken".to_owned(), ..FilterSettings::default() }));
    assert!(next_problem(&mut player).contains("no such card"));
}

#[test]
fn the_particles_gather_with_every_model_and_any_seed() {
    for kind in ObservationKind::ALL {
        for seed in 0..3 {
            let mut filter = FilterSettings { seed, ..FilterSettings::default() };
            filter.set_model(kind);
            let mut player = demonstration(&walk(1), filter);
            let (frames, ..) = until_still(&mut player, 0);
            let last = frames.iter().rfind(|frame| frame.gathering.is_some()).unwrap();
            assert!(share_at_place(last) > 0.85, "{kind} {seed}: {}", share_at_place(last));
        }
    }
}

#[test]
fn without_its_first_picture_the_demonstration_begins_with_the_second() {
    let mut player = demonstration(&without_picture(4, 0), FilterSettings::default());
    let (frames, problems, _) = until_still(&mut player, 0);
    let indices: Vec<usize> = frames.iter().map(|frame| frame.record.index).collect();
    assert_eq!((indices, steps(&frames).len()), (vec![1, 2, 3], 0));
    assert!(!problems.is_empty() && problems[0].contains("none.jpg"), "{problems:?}");
}
