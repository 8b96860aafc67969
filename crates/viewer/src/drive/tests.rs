//! Tests without a window: the database made from a recording, and the drawing thread.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::{
        Arc, Mutex, PoisonError, Weak,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use eframe::egui::{Context, Ui};
use egui_kittest::{Harness, kittest::Queryable};
use glam::DVec2;
use reality_sim_core::{
    backend::{Backend, BackendError, CpuBackend},
    camera::ImageCircle,
    pose::{CameraPose, Pose2, wrap_angle},
    sequence::Sequence,
};

use super::{
    DrivePanel, DriveSettings,
    answer::{Answer, Around, Painted},
    driving::Driving,
    kind::{Aspect, Pane, PictureKind},
    painter::Painter,
    source::{Source, build},
    wish::Wish,
};
use crate::{
    background::{Outcome, Task},
    device::Device,
    problems::Problems,
};

mod staged;

/// Time limit, far more than any test takes.
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
    let task = Task::spawn(&Context::default(), "", move |progress| build(&sequence, None, progress));
    finished(&task).unwrap()
}

/// Returns a source shared by tests that run at the same time; its file is deleted with the last of them, unlike with a
/// static.
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
        panes: PictureKind::ALL.map(Pane::picture).to_vec(),
        is_best_effort: false,
        is_clean: false,
        things: Vec::new(),
        is_labelled: false,
        edges_in: None,
        probes: source.probes.clone(),
        device: None,
    }
}

/// Collects the thread's answers until it has drawn everything requested.
fn fulfilled(painter: &mut Painter, wish: &Wish) -> (Around, BTreeMap<Pane, Painted>) {
    painter.wish(wish.clone());
    let (mut around, mut painted) = (None, BTreeMap::new());
    let start = Instant::now();
    while painted.len() < wish.panes.len() {
        match painter.answer() {
            Some(Answer::Around(known)) => around = Some(known),
            Some(Answer::Painted(pane, picture)) if picture.pose == wish.pose => {
                painted.insert(pane, picture);
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
    Painter::spawn(&Context::default(), source.clone())
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
    let source = built(short);
    assert_eq!(source.archive.images().len(), 6);
    assert!(source.probes.is_none());
}

#[test]
fn without_ground_truth_the_filter_finds_where_pictures_were_taken() {
    let mut recording = walk();
    recording.frames.truncate(12);
    let truth: Vec<_> = recording.frames.iter_mut().map(|frame| frame.reference_pose.take()).collect();
    let recording = Arc::new(recording);
    let task = Task::spawn(&Context::default(), "", move |progress| build(&recording, None, progress));
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
    let facts = |kind| &painted[&Pane::picture(kind)].result.as_ref().unwrap().facts;
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
    let reason = |kind| painted[&Pane::picture(kind)].result.as_ref().unwrap_err();
    assert!(reason(PictureKind::Blend).contains("best effort"), "{}", reason(PictureKind::Blend));
    assert!(reason(PictureKind::Truth).contains("px away"), "{}", reason(PictureKind::Truth));
    assert!(painted[&Pane::picture(PictureKind::Simulated)].result.is_ok());

    let (_, painted) = fulfilled(&mut painter, &Wish { is_best_effort: true, ..outwards });
    assert!(painted[&Pane::picture(PictureKind::Blend)].result.is_ok());
}

#[test]
fn origins_and_trust_are_of_the_same_picture_and_a_simulated_one_has_none() {
    let source = source();
    let pane = |kind, aspect| Pane { kind, aspect };
    let panes = vec![
        pane(PictureKind::Blend, Aspect::Picture),
        pane(PictureKind::Blend, Aspect::Origins),
        pane(PictureKind::Blend, Aspect::Trust),
        pane(PictureKind::Simulated, Aspect::Origins),
    ];
    let wish = Wish {
        panes,
        edges_in: Some([DVec2::splat(-9.0), DVec2::splat(9.0)]),
        ..wish(&source, probe(&source).1)
    };
    let (around, painted) = fulfilled(&mut painter(&source), &wish);
    let drawn = |index: usize| painted[&wish.panes[index]].result.as_ref();
    let used = |index: usize| &drawn(index).unwrap().facts.used;
    assert!(used(0) == used(1) && used(0) == used(2) && used(0).len() > 1);
    assert!(drawn(0).unwrap().picture != drawn(1).unwrap().picture);
    assert!(drawn(3).unwrap_err().contains("choose another method"));
    assert!(around.edges.iter().any(|sector| !sector.shown_in_world.is_empty()));
}

#[test]
fn the_newest_of_many_requests_is_fulfilled() {
    let source = source();
    let mut painter = painter(&source);
    let poses = (0..200).map(|step| CameraPose { yaw_rad: 0.001 * f64::from(step), ..probe(&source).1 });
    let wishes: Vec<Wish> = poses
        .map(|pose| Wish { panes: vec![Pane::picture(PictureKind::Blend)], ..wish(&source, pose) })
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
fn every_pane_has_its_turn_while_requests_keep_changing() {
    let source = source();
    let mut painter = painter(&source);
    let panes = wish(&source, probe(&source).1).panes;
    let (start, mut step, mut drawn) = (Instant::now(), 0, Vec::new());
    while !panes.iter().all(|pane| drawn.contains(pane)) {
        // The pose changes whenever a picture arrives, as when the mouse never rests.
        step += 1;
        let pose = CameraPose { yaw_rad: 0.0001 * f64::from(step), ..probe(&source).1 };
        painter.wish(wish(&source, pose));
        match painter.answer() {
            Some(Answer::Painted(pane, _)) => drawn.push(pane),
            Some(Answer::Problem(problem)) => panic!("{problem}"),
            Some(Answer::Around(_)) | None => std::thread::sleep(Duration::from_millis(1)),
        }
        assert!(start.elapsed() < LIMIT, "{drawn:?}");
    }
    assert_eq!(drawn[..panes.len()], panes, "one after the other");
}

#[test]
fn pictures_are_not_drawn_again_for_another_part_of_the_map() {
    let source = source();
    let mut painter = painter(&source);
    let first = wish(&source, probe(&source).1);
    fulfilled(&mut painter, &first);
    let panes =
        vec![Pane::picture(PictureKind::Blend), Pane { kind: PictureKind::Blend, aspect: Aspect::Trust }];
    let part = [DVec2::new(-9.0, -9.0), DVec2::new(0.0, 9.0)];
    painter.wish(Wish { panes, edges_in: Some(part), ..first });
    let start = Instant::now();
    let mut painted = Vec::new();
    while painted.is_empty() {
        match painter.answer() {
            Some(Answer::Painted(pane, _)) => painted.push(pane),
            Some(Answer::Around(around)) => assert!(!around.edges.is_empty()),
            Some(Answer::Problem(problem)) => panic!("{problem}"),
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(start.elapsed() < LIMIT);
    }
    assert_eq!(painted[0].aspect, Aspect::Trust, "the picture itself was there");
}

#[test]
fn dropping_the_painter_waits_for_its_thread() {
    let source = Arc::new(built(walk()));
    let mut painter = Painter::spawn(&Context::default(), source.clone());
    painter.wish(wish(&source, probe(&source).1));
    drop(painter);
    assert_eq!(Arc::strong_count(&source), 1);
}

#[test]
fn another_device_is_opened_once_when_it_is_chosen() {
    let source = source();
    let opened = Arc::new(AtomicUsize::new(0));
    let count = opened.clone();
    let open = move || -> Result<Arc<dyn Backend>, BackendError> {
        count.fetch_add(1, Ordering::SeqCst);
        Ok(Arc::new(CpuBackend))
    };
    let device = Device::adapter("another", open);
    let mut painter = painter(&source);
    let first = Wish { panes: vec![Pane::picture(PictureKind::Blend)], ..wish(&source, probe(&source).1) };
    fulfilled(&mut painter, &first);
    assert_eq!(opened.load(Ordering::SeqCst), 0);
    let second = Wish { device: Some(device), ..first };
    fulfilled(&mut painter, &second);
    fulfilled(
        &mut painter,
        &Wish { pose: CameraPose { x_m: second.pose.x_m + 0.01, ..second.pose }, ..second },
    );
    assert_eq!(opened.load(Ordering::SeqCst), 1);
}

/// Environment variable that is set only by the test below when it starts itself.
const ALONE: &str = "REALITY_SIM_VIEWER_TEST_TEMPORARY";

/// Drops a panel while its database is being made, in a process of its own with its own temporary folder.
#[test]
fn the_panel_that_is_left() {
    let Some(parent) = std::env::var_os(ALONE).map(PathBuf::from) else { return };
    let (sequence, start) = (Arc::new(walk()), Instant::now());
    let panel = DrivePanel::of_recording(sequence, None);
    let show = |ui: &mut Ui, panel: &mut DrivePanel| {
        panel.ui(ui, &mut DriveSettings::default(), &[], &mut Problems::default());
    };
    let mut window = Harness::builder().with_size([900.0, 600.0]).build_ui_state(show, panel);
    while fs::read_dir(&parent).unwrap().next().is_none() {
        window.step();
        assert!(start.elapsed() < LIMIT);
    }
    drop(window);
    assert!(fs::read_dir(&parent).unwrap().next().is_none(), "the folder is still there");
}

#[cfg(unix)]
#[test]
fn leaving_while_the_database_is_made_leaves_no_file_behind() {
    let folder = tempfile::tempdir().unwrap();
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "drive::tests::the_panel_that_is_left"])
        .env(ALONE, folder.path())
        .env("TMPDIR", folder.path())
        .stdout(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
}

#[test]
fn the_provenance_states_how_poses_were_found() {
    let mut recording = walk();
    recording.frames.truncate(4);
    recording.frames.iter_mut().for_each(|frame| frame.reference_pose = None);
    let recording = Arc::new(recording);
    let task = Task::spawn(&Context::default(), "", move |progress| build(&recording, None, progress));
    let source = finished(&task).unwrap();
    let described = source.archive.database().pose_sources().unwrap();
    let text = format!("{described:?}");
    for key in ["observation", "particles", "iterations", "resampling", "seed", "backend", "smoothed"] {
        assert!(text.contains(key), "{key} is not in {text}");
    }
}

#[test]
fn a_long_recording_becomes_a_database_only_on_request() {
    let mut long = walk();
    long.frames = vec![long.frames[0].clone(); 2001];
    let show = |ui: &mut Ui, panel: &mut DrivePanel| {
        panel.ui(ui, &mut DriveSettings::default(), &[], &mut Problems::default());
    };
    let panel = DrivePanel::of_recording(Arc::new(long), None);
    let mut window = Harness::builder().with_size([900.0, 600.0]).build_ui_state(show, panel);
    window.run_steps(3);
    window.get_by_label_contains("its 2001 pictures");
    window.get_by_label("Build the database").click();
    window.run_steps(2);
    window.get_by_label("Cancel");
}

#[test]
fn a_device_that_does_not_open_is_reported_and_the_processor_draws() {
    let source = source();
    let device = Device::adapter("broken", || Err(BackendError::new("no driver: install one")));
    let mut painter = Painter::spawn(&Context::default(), source.clone());
    painter.wish(Wish { device: Some(device), ..wish(&source, probe(&source).1) });
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
    let changed = |change: fn(&mut Sequence)| {
        let mut recording = walk();
        change(&mut recording);
        recording
    };
    let renamed = changed(|recording| recording.field.name = "another name".to_owned());
    assert_eq!(driving.compare_with(&Arc::new(renamed)), Ok(()), "names do not matter");
    let refused = [
        (
            changed(|recording| recording.frames.iter_mut().for_each(|frame| frame.reference_pose = None)),
            "ground truth",
        ),
        (changed(|recording| recording.setup.camera.width = 1280), "1280 x 480 pixels"),
        (changed(|recording| recording.setup.camera.fx += 1.0), "another lens"),
        (
            changed(|recording| {
                recording.setup.camera.image_circle =
                    Some(ImageCircle { cx: 319.5, cy: 239.5, radius: 99.0 });
            }),
            "part of the lens's image",
        ),
        (changed(|recording| recording.field.length_m += 0.1), "field has other dimensions"),
    ];
    for (recording, what) in refused {
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
