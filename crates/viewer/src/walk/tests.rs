//! The player without a window: what it sends when it is told something.

use std::{
    path::Path,
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use eframe::egui::Context;
use reality_sim_core::{
    backend::{BackendError, CpuBackend},
    observation::ObservationKind,
    pose::Pose2,
    sequence::Sequence,
};

use super::{
    frame::FrameView,
    player::{Command, Message, Player},
    settings::{FilterSettings, Speed, Veil},
};
use crate::Device;

/// Longer than anything here takes, on the slowest machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn walk(frames: usize) -> Arc<Sequence> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk");
    let mut sequence = Sequence::open(&folder).unwrap();
    sequence.frames.truncate(frames);
    sequence.groundtruth.truncate(frames);
    Arc::new(sequence)
}

fn devices() -> Vec<Device> {
    let broken = || Err(BackendError("no such card: choose another one".to_owned()));
    vec![
        Device { name: "processor".to_owned(), open: Arc::new(|| Ok(Arc::new(CpuBackend))) },
        Device { name: "broken".to_owned(), open: Arc::new(broken) },
    ]
}

fn player(sequence: &Arc<Sequence>, filter: FilterSettings) -> Player {
    Player::spawn(&Context::default(), sequence.clone(), devices(), filter, Speed::Filter, Veil::None)
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

/// The next frame; a problem ends the test.
fn next_frame(player: &mut Player) -> FrameView {
    loop {
        match next(player) {
            Message::Frame(frame) => return *frame,
            Message::Problem(reason) => panic!("{reason}"),
            Message::Begun | Message::Playing(_) => {}
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

/// All frames until it stands still.
fn play(player: &mut Player) -> Vec<FrameView> {
    player.tell(Command::Play);
    let (mut frames, mut has_played) = (Vec::new(), false);
    loop {
        match next(player) {
            Message::Frame(frame) => frames.push(*frame),
            Message::Playing(is_playing) if is_playing => has_played = true,
            Message::Playing(_) if has_played => return frames,
            Message::Problem(reason) => panic!("{reason}"),
            Message::Begun | Message::Playing(_) => {}
        }
    }
}

fn error_m(frame: &FrameView) -> f64 {
    frame.record.error_m.unwrap()
}

#[test]
fn every_picture_is_played_once_in_its_order_and_found_to_a_centimetre() {
    let mut player = player(&walk(12), FilterSettings::default());
    assert_eq!(next_frame(&mut player).record.index, 0);
    // The window is slow: nothing gets lost, and nothing is played ahead without end.
    player.tell(Command::Play);
    thread::sleep(Duration::from_millis(300));
    let frames = play(&mut player);
    let indices: Vec<usize> = frames.iter().map(|frame| frame.record.index).collect();
    assert_eq!(indices, (1..12).collect::<Vec<_>>());
    assert!(frames.iter().all(|frame| error_m(frame) < 0.01 && frame.record.sure));
}

#[test]
fn playing_at_the_end_begins_again() {
    let mut player = player(&walk(3), FilterSettings::default());
    next_frame(&mut player);
    assert_eq!(play(&mut player).len(), 2);
    let again: Vec<usize> = play(&mut player).iter().map(|frame| frame.record.index).collect();
    assert_eq!(again, [0, 1, 2]);
}

#[test]
fn particles_dragged_away_are_lost_and_find_back() {
    let mut player = player(&walk(14), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::GoTo(1));
    next_frame(&mut player);
    player.tell(Command::Place(Pose2::new(1.5, -1.0, 0.5)));
    let lost = next_frame(&mut player);
    assert_eq!(lost.record.index, 1);
    assert!(error_m(&lost) > 2.0 && !lost.record.sure);
    let far = |particle: &super::frame::WeightedParticle| {
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
    // And from there it goes on.
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
    // The paper's models have no fit: the filter's own pose is the one given.
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
    // Found and true lines lie on each other: a point of the centre line is half a line from the nearest edge at most.
    let truth: Vec<_> = frame.truth_lines.iter().flatten().collect();
    let found: Vec<_> = frame.pose_lines.iter().flatten().collect();
    assert!(truth.len() > 100 && found.len() > 200 && !frame.border.is_empty());
    let near = truth.iter().filter(|point| found.iter().any(|edge| edge.distance(***point) < 12.0)).count();
    assert!(near * 20 > truth.len() * 19, "{near} of {}", truth.len());
}

#[test]
fn a_picture_that_is_missing_is_a_problem_and_the_next_is_shown_all_the_same() {
    let mut sequence = Sequence::clone(&walk(4));
    sequence.frames[1].image = "images/none.jpg".into();
    let mut player = player(&Arc::new(sequence), FilterSettings::default());
    next_frame(&mut player);
    player.tell(Command::Play);
    let problem = next_problem(&mut player);
    assert!(problem.contains("none.jpg"), "{problem}");
    player.tell(Command::GoTo(2));
    let frame = next_frame(&mut player);
    assert_eq!(frame.record.index, 2);
    assert!(error_m(&frame) < 0.02);
}

#[test]
fn a_device_that_does_not_open_is_a_problem_and_another_one_helps() {
    let broken = FilterSettings { device: "broken".to_owned(), ..FilterSettings::default() };
    let mut player = player(&walk(4), broken);
    assert!(next_problem(&mut player).contains("no such card"));
    player.tell(Command::Filter(FilterSettings {
        device: "processor".to_owned(),
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
