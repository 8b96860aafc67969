//! Without a window: the database made of a recording, and the thread that draws.

use std::{
    collections::BTreeMap,
    path::Path,
    sync::{Arc, Mutex, PoisonError, Weak},
    time::{Duration, Instant},
};

use eframe::egui::Context;
use reality_sim_core::{
    backend::BackendError,
    pose::{CameraPose, Pose2, wrap_angle},
    sequence::Sequence,
};

use super::{
    driving::Driving,
    kind::{PictureKind, Shown, View},
    painter::{Answer, Around, Painted, Painter, Wish},
    source::{Poses, Source, build},
};
use crate::{
    background::{Outcome, Task},
    device::Device,
};

/// Far more than any of this takes.
const LIMIT: Duration = Duration::from_secs(120);

fn walk() -> Sequence {
    Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk")).unwrap()
}

fn finished<T: Send + 'static>(task: &Task<T>) -> Result<T, String> {
    let start = Instant::now();
    loop {
        match task.poll() {
            Some(Outcome::Done(value)) => return Ok(value),
            Some(Outcome::Failed(reason)) => return Err(reason),
            Some(Outcome::Cancelled) => return Err("cancelled".to_owned()),
            None => assert!(start.elapsed() < LIMIT),
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn built(sequence: Sequence) -> Source {
    let sequence = Arc::new(sequence);
    let poses = Poses::known(&sequence).unwrap();
    let task = Task::spawn(&Context::default(), "", move |progress| build(&sequence, poses, progress));
    finished(&task).unwrap()
}

/// One for all tests that hold it at the same time; its file goes with the last of them, which a static would not let it.
fn source() -> Arc<Source> {
    static SHARED: Mutex<Weak<Source>> = Mutex::new(Weak::new());
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    shared.upgrade().unwrap_or_else(|| {
        let source = Arc::new(built(walk()));
        *shared = Arc::downgrade(&source);
        source
    })
}

fn wish(source: &Source, pose: CameraPose) -> Wish {
    Wish {
        pose,
        views: PictureKind::ALL.map(View::picture).to_vec(),
        is_best_effort: false,
        wants_triangulation: false,
        probes: source.probes.clone(),
    }
}

/// What the thread says until it has drawn all that was wished for.
fn fulfilled(painter: &mut Painter, wish: &Wish) -> (Around, BTreeMap<View, Painted>) {
    painter.wish(wish.clone());
    let (mut around, mut painted) = (None, BTreeMap::new());
    let start = Instant::now();
    while painted.len() < wish.views.len() {
        match painter.answer() {
            Some(Answer::Around(known)) => around = Some(known),
            Some(Answer::Painted(view, picture)) if picture.pose == wish.pose => {
                painted.insert(view, picture);
            }
            Some(Answer::Painted(..)) => {}
            Some(Answer::Problem(problem)) => panic!("{problem}"),
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(start.elapsed() < LIMIT);
    }
    (around.unwrap(), painted)
}

fn painter(source: &Arc<Source>) -> Painter {
    Painter::spawn(&Context::default(), source.clone(), None)
}

fn probe(source: &Source) -> (usize, CameraPose) {
    source.probes.as_ref().unwrap().poses()[3]
}

#[test]
fn every_fifth_picture_of_a_recording_is_held_back_and_the_file_goes_with_the_last_user() {
    let source = built(walk());
    let held: Vec<usize> = source.probes.as_ref().unwrap().poses().iter().map(|(frame, _)| *frame).collect();
    assert_eq!((held.len(), source.archive.images().len()), (12, 48));
    assert!(source.archive.images().iter().all(|image| !held.contains(&image.frame_index)));
    let file = source.archive.database().path().to_path_buf();
    assert!(file.is_file());
    drop(source);
    assert!(!file.parent().unwrap().exists());
}

#[test]
fn a_short_recording_keeps_all_its_pictures() {
    let mut short = walk();
    short.frames.truncate(6);
    short.groundtruth.truncate(6);
    let source = built(short);
    assert_eq!(source.archive.images().len(), 6);
    assert!(source.probes.is_none());
}

#[test]
fn without_ground_truth_the_filter_finds_where_pictures_were_taken() {
    let mut recording = walk();
    recording.frames.truncate(12);
    let truth = std::mem::replace(&mut recording.groundtruth, vec![None; 12]);
    assert!(Poses::known(&recording).is_none());
    let recording = Arc::new(recording);
    let task = Task::spawn(&Context::default(), "", move |progress| {
        let poses = Poses::found(&recording, None, progress)?;
        build(&recording, poses, progress)
    });
    let source = finished(&task).unwrap();
    let held = source.probes.as_ref().map_or(0, |probes| probes.poses().len());
    assert!(source.archive.images().len() + held >= 10, "{} and {held}", source.archive.images().len());
    for image in source.archive.images() {
        let truth = truth[image.frame_index].unwrap();
        let (away, turned) = (
            (image.pose.x_m - truth.x_m).hypot(image.pose.y_m - truth.y_m),
            image.pose.yaw_rad - truth.yaw_rad,
        );
        assert!(away < 0.05 && wrap_angle(turned).abs() < 0.03, "{away} {turned}");
    }
}

#[test]
fn where_a_true_picture_was_taken_every_method_comes_nearer_to_it_than_the_simulation() {
    let source = source();
    let (frame, pose) = probe(&source);
    let (around, painted) = fulfilled(&mut painter(&source), &wish(&source, pose));
    let facts = |kind| &painted[&View::picture(kind)].result.as_ref().unwrap().facts;
    let shown = facts(PictureKind::Truth).probe.unwrap();
    assert_eq!((shown.frame, shown.distance_px), (frame, 0.0));
    let likeness = |kind: PictureKind| facts(kind).likeness_db.unwrap();
    for kind in [PictureKind::Auto, PictureKind::Nearest, PictureKind::Quadratic, PictureKind::Plane] {
        assert!(likeness(kind) > likeness(PictureKind::Simulated) + 3.0, "{kind:?}");
    }
    assert!(
        likeness(PictureKind::Blend) > 24.0 && likeness(PictureKind::Blend) > likeness(PictureKind::Nearest)
    );
    assert_eq!(facts(PictureKind::Auto).method, "blend", "nothing was recorded at this very pose");
    let nearest = around.nearest.unwrap();
    assert_eq!(facts(PictureKind::Nearest).used[0].image, nearest.image);
    assert_eq!(facts(PictureKind::Nearest).used[0].distance_px, nearest.distance_px);
    let weights: f64 = around.natural.iter().map(|neighbour| neighbour.weight).sum();
    assert!((weights - 1.0).abs() < 1e-6);
}

#[test]
fn where_nothing_was_recorded_the_reason_takes_the_place_of_the_picture() {
    let source = source();
    let usual = source.archive.usual_pose();
    let outwards = wish(&source, usual.with_planar(Pose2::new(3.2, -2.2, -0.8)));
    let mut painter = painter(&source);
    let (_, painted) = fulfilled(&mut painter, &outwards);
    let reason = |kind| painted[&View::picture(kind)].result.as_ref().unwrap_err();
    assert!(reason(PictureKind::Blend).contains("best effort"), "{}", reason(PictureKind::Blend));
    assert!(reason(PictureKind::Truth).contains("px away"), "{}", reason(PictureKind::Truth));
    assert!(painted[&View::picture(PictureKind::Simulated)].result.is_ok());

    let (_, painted) = fulfilled(&mut painter, &Wish { is_best_effort: true, ..outwards });
    assert!(painted[&View::picture(PictureKind::Blend)].result.is_ok());
}

#[test]
fn origins_and_trust_are_of_the_same_picture_and_a_simulated_one_has_none() {
    let source = source();
    let view = |kind, shown| View { kind, shown };
    let views = vec![
        view(PictureKind::Blend, Shown::Picture),
        view(PictureKind::Blend, Shown::Origins),
        view(PictureKind::Blend, Shown::Trust),
        view(PictureKind::Simulated, Shown::Origins),
    ];
    let wish = Wish { views, wants_triangulation: true, ..wish(&source, probe(&source).1) };
    let (around, painted) = fulfilled(&mut painter(&source), &wish);
    let drawn = |index: usize| painted[&wish.views[index]].result.as_ref();
    let used = |index: usize| &drawn(index).unwrap().facts.used;
    assert!(used(0) == used(1) && used(0) == used(2) && used(0).len() > 1);
    assert!(drawn(0).unwrap().picture != drawn(1).unwrap().picture);
    assert!(drawn(3).unwrap_err().contains("choose another method"));
    assert!(around.triangulations.iter().any(|sector| !sector.edges_in_world.is_empty()));
}

#[test]
fn of_many_wishes_the_newest_is_fulfilled() {
    let source = source();
    let mut painter = painter(&source);
    let poses = (0..200).map(|step| CameraPose { yaw_rad: 0.001 * f64::from(step), ..probe(&source).1 });
    let wishes: Vec<Wish> = poses
        .map(|pose| Wish { views: vec![View::picture(PictureKind::Blend)], ..wish(&source, pose) })
        .collect();
    wishes.iter().for_each(|wish| painter.wish(wish.clone()));
    let (start, mut answers) = (Instant::now(), 0);
    loop {
        match painter.answer() {
            Some(Answer::Painted(_, painted)) => {
                answers += 1;
                if painted.pose == wishes[199].pose {
                    break;
                }
            }
            Some(_) => {}
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(start.elapsed() < LIMIT);
    }
    assert!(answers < 100, "{answers} of 200 wishes were drawn");
}

#[test]
fn the_thread_ends_with_the_panel() {
    let source = Arc::new(built(walk()));
    let mut painter = Painter::spawn(&Context::default(), source.clone(), None);
    painter.wish(wish(&source, probe(&source).1));
    drop(painter);
    let start = Instant::now();
    while Arc::strong_count(&source) > 1 {
        assert!(start.elapsed() < LIMIT);
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_device_that_cannot_be_opened_is_told_and_the_processor_draws() {
    let source = source();
    let device = Device {
        name: "broken".to_owned(),
        open: Arc::new(|| Err(BackendError("no driver: install one".to_owned()))),
    };
    let mut painter = Painter::spawn(&Context::default(), source.clone(), Some(device));
    painter.wish(wish(&source, probe(&source).1));
    let start = Instant::now();
    let mut problem = None;
    loop {
        match painter.answer() {
            Some(Answer::Problem(words)) => problem = Some(words),
            Some(Answer::Painted(_, painted)) => {
                assert!(painted.result.is_ok());
                break;
            }
            Some(Answer::Around(_)) => {}
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(start.elapsed() < LIMIT);
    }
    let problem = problem.unwrap();
    assert!(problem.contains("broken: no driver: install one"), "{problem}");
}

#[test]
fn recordings_that_cannot_be_compared_are_refused_by_name() {
    let source = source();
    let mut driving = Driving::new(Source::of_archive(source.archive.clone()));
    assert_eq!(driving.compare_with(&Arc::new(walk())), Ok(()));
    let mut blind = walk();
    blind.groundtruth.fill(None);
    let mut large = walk();
    large.setup.camera.width = 1280;
    for (recording, what) in [(blind, "ground truth"), (large, "1280 x 480 pixels")] {
        let reason = driving.compare_with(&Arc::new(recording)).unwrap_err();
        assert!(reason.contains("assets/walk") && reason.contains(what), "{reason}");
    }
}

#[test]
fn the_nearest_true_picture_is_the_one_that_moves_the_picture_least() {
    let source = source();
    let metric = source.archive.index().metric();
    let (frame, taken) = probe(&source);
    let pose = CameraPose { yaw_rad: taken.yaw_rad + 0.02, ..taken };
    let near = source.probes.as_ref().unwrap().nearest(metric, pose).unwrap();
    assert_eq!((near.frame, near.pose), (frame, taken));
    assert!(
        near.distance_px > 1.0 && near.distance_px < 10.0,
        "a fiftieth of a radian at 215 pixels a radian"
    );
}
