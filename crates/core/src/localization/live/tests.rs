//! The camera is faster than the localizer because a test holds the localizer back: no clock decides anything here.

use std::path::Path;

use super::*;
use crate::{
    pose::{Motion2, Pose2},
    sequence::Sequence,
};

/// Localizer that tells when it begins with a picture, and goes on when the test says so.
struct Held {
    localizer: Localizer,
    begins: mpsc::Sender<f64>,
    goes_on: mpsc::Receiver<()>,
}

impl Held {
    fn update(&mut self, observation: &Observation) -> Result<LocalizedFrame, LocalizationError> {
        // The test may have ended.
        let _ = self.begins.send(observation.timestamp_s);
        let _ = self.goes_on.recv();
        assert!(observation.timestamp_s >= 0.0, "a time before the recording");
        self.localizer.update(observation)
    }
}

/// Live localizer of the demonstration walk, and what holds it back.
///
/// The sender is dropped first: then nothing is held back any more, and the thread can end.
struct Scene {
    go_on: mpsc::Sender<()>,
    begins: mpsc::Receiver<f64>,
    live: LiveLocalizer<Held>,
    walk: Sequence,
}

impl Scene {
    fn new(waiting: usize) -> Self {
        let walk = Sequence::open(Path::new("../../assets/walk")).unwrap();
        let localizer =
            Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build().unwrap();
        let (begun, begins) = mpsc::channel();
        let (go_on, goes_on) = mpsc::channel();
        let held = Held { localizer, begins: begun, goes_on };
        let live = LiveLocalizer::start(held, Held::update, NonZeroUsize::new(waiting).unwrap());
        Self { go_on, begins, live, walk }
    }

    fn observation(&self, index: usize) -> Observation {
        Observation::of_frame(&self.walk, index, self.walk.load_image(index).unwrap())
    }

    fn push(&self, index: usize) -> Pushed {
        self.live.feed().push(self.observation(index))
    }

    /// Waits until the localizer has begun with a picture, so that it waits no longer.
    fn begun(&self) -> f64 {
        self.begins.recv().unwrap()
    }

    fn result(&mut self) -> Result<LiveFrame, LiveError> {
        self.go_on.send(()).unwrap();
        self.live.wait().unwrap()
    }
}

#[test]
fn the_oldest_pictures_are_dropped_and_their_motion_is_not_lost() {
    let mut scene = Scene::new(1);
    assert_eq!(scene.push(0), Pushed::Waits);
    scene.begun();
    // While the first is held, the robot walks on.
    assert_eq!(scene.push(1), Pushed::Waits);
    for index in 2..=12 {
        assert_eq!(scene.push(index), Pushed::OldestDropped);
    }
    assert_eq!(scene.live.feed().dropped(), 11);
    let first = scene.result().unwrap();
    assert_eq!((first.frame.timestamp_s, first.dropped_before), (scene.walk.frames[0].timestamp_s, 0));
    let last = scene.result().unwrap();
    let record = &scene.walk.frames[12];
    assert_eq!((last.frame.timestamp_s, last.dropped_before), (record.timestamp_s, 11));
    let [before, now] = [0, 12].map(|index| scene.walk.frames[index].odometry.unwrap());
    let moved: Motion2 = before.motion_to(now);
    assert!(moved.distance_m() > 0.15, "the robot has walked {moved:?}");
    assert_eq!(last.frame.motion, Some(moved));
    let (pose, truth) = (last.frame.pose, record.reference_pose.unwrap());
    assert!((pose.x_m - truth.x_m).hypot(pose.y_m - truth.y_m) < 0.02, "{pose:?}, {truth:?}");
    assert!(last.frame.sure && !last.frame.searched);
}

#[test]
fn a_few_pictures_may_wait_and_come_in_their_order() {
    let mut scene = Scene::new(3);
    assert_eq!(scene.push(0), Pushed::Waits);
    scene.begun();
    let pushed: Vec<Pushed> = (1..=5).map(|index| scene.push(index)).collect();
    let [waits, dropped] = [Pushed::Waits, Pushed::OldestDropped];
    assert_eq!(pushed, [waits, waits, waits, dropped, dropped]);
    scene.live.close();
    assert_eq!(scene.push(6), Pushed::Refused, "it is closed");
    let results: Vec<LiveFrame> = (0..4).map(|_| scene.result().unwrap()).collect();
    let found: Vec<(f64, u64)> =
        results.iter().map(|result| (result.frame.timestamp_s, result.dropped_before)).collect();
    let time = |index: usize| scene.walk.frames[index].timestamp_s;
    assert_eq!(found, [(time(0), 0), (time(3), 2), (time(4), 0), (time(5), 0)]);
    assert!(scene.live.wait().is_none(), "all pictures have their results");
    assert!(scene.live.stop().is_some(), "the localizer comes back");
}

#[test]
fn an_error_is_told_and_the_next_picture_is_localized() {
    let mut scene = Scene::new(2);
    let small = Observation { picture: image::RgbImage::new(4, 3).into(), ..scene.observation(0) };
    let _ = scene.live.feed().push(small);
    scene.begun();
    let _ = scene.push(0);
    let error = scene.result().unwrap_err();
    assert_eq!(error.timestamp_s, scene.walk.frames[0].timestamp_s);
    assert!(error.to_string().contains("4 x 3 pixels"), "{error}");
    assert!(scene.result().unwrap().frame.sure);
}

#[test]
fn a_restart_of_the_odometry_is_dropped_last() {
    let scene = Scene::new(2);
    let mut carried = scene.observation(0);
    carried.timestamp_s = 3.0;
    carried.odometry = Some(Pose2::new(2.0, 1.0, 0.5));
    let restarted = Observation { timestamp_s: 4.0, odometry: Some(Pose2::default()), ..carried.clone() };
    let later = |timestamp_s| Observation {
        timestamp_s,
        odometry: Some(Pose2::new(0.1, 0.0, 0.0)),
        ..carried.clone()
    };
    let feed = scene.live.feed();
    let _ = feed.push(carried.clone());
    scene.begun();
    for observation in [restarted, later(5.0), later(6.0), later(7.0)] {
        let _ = feed.push(observation);
    }
    scene.go_on.send(()).unwrap();
    assert_eq!(scene.begun(), 4.0);
    scene.go_on.send(()).unwrap();
    assert_eq!(scene.begun(), 7.0);
    assert_eq!(feed.dropped(), 2);
}

#[test]
fn results_that_nobody_reads_hold_localization_back_and_none_is_lost() {
    let mut scene = Scene::new(1);
    let wrong = Observation { picture: image::RgbImage::new(4, 3).into(), ..scene.observation(0) };
    let feed = scene.live.feed();
    // As many as there is room for, and one that finds none.
    for index in 0..=RESULTS {
        let _ = feed.push(Observation { timestamp_s: index as f64, ..wrong.clone() });
        assert_eq!(scene.begun(), index as f64);
        scene.go_on.send(()).unwrap();
    }
    for _ in 0..100 {
        let _ = feed.push(Observation { timestamp_s: 1e3, ..wrong.clone() });
    }
    assert_eq!(feed.dropped(), 99);
    let times: Vec<f64> =
        (0..=RESULTS).map(|_| scene.live.wait().unwrap().unwrap_err().timestamp_s).collect();
    assert_eq!(times, (0..=RESULTS).map(|index| index as f64).collect::<Vec<_>>());
}

#[test]
fn it_can_be_stopped_at_any_time() {
    let scene = Scene::new(1);
    for index in 0..3 {
        let _ = scene.push(index);
    }
    scene.begun();
    let feed = scene.live.feed();
    scene.go_on.send(()).unwrap();
    drop(scene);
    let refused = feed.push(Scene::new(1).observation(0));
    assert_eq!(refused, Pushed::Refused);
}

#[test]
#[should_panic(expected = "a time before the recording")]
fn a_panic_is_told_to_the_reader() {
    let mut scene = Scene::new(1);
    let _ = scene.live.feed().push(Observation { timestamp_s: -1.0, ..scene.observation(0) });
    scene.go_on.send(()).unwrap();
    while scene.live.wait().is_some() {}
}
