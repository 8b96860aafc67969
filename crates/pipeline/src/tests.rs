//! The demonstration walk through the pipeline, complete and cancelled.

use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use reality_sim_core::{
    backend::{BackendError, CpuBackend},
    sequence::Sequence,
};
use reality_sim_db::{Database, PoseSource};

use crate::*;

fn walk(frames: usize) -> Arc<Sequence> {
    let mut walk = Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk")).unwrap();
    walk.frames.truncate(frames);
    Arc::new(walk)
}

fn without_reference(frames: usize) -> Arc<Sequence> {
    let mut walk = (*walk(frames)).clone();
    walk.frames.iter_mut().for_each(|frame| frame.reference_pose = None);
    Arc::new(walk)
}

fn events(plan: Plan) -> Vec<Event> {
    plan.start().map(Result::unwrap).collect()
}

fn poses(events: &[Event]) -> Vec<&FoundPoses> {
    let found = events.iter().filter_map(|event| match event {
        Event::PosesFound { poses, .. } => Some(poses),
        _ => None,
    });
    found.collect()
}

#[test]
fn a_recording_with_reference_poses_is_stored_with_them_and_nothing_is_localized() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let plan = Plan::new([walk(6)], PoseChoice::ReferenceElseFilter).with_database(&path).with_hall(false);
    let events = events(plan);
    assert_eq!(poses(&events)[0].source, PoseSource::GroundTruth);
    assert!(!events.iter().any(|event| matches!(event, Event::Localized { .. })));
    let stored = events.iter().filter(|event| matches!(event, Event::Stored { of: 6, .. }));
    assert_eq!(stored.count(), 6);
    assert_eq!(events.last(), Some(&Event::Completed { images: 6, hall: None }));
    assert_eq!(Database::open(&path).unwrap().images().unwrap().len(), 6);
}

#[test]
fn a_recording_without_reference_poses_is_localized_and_smoothed() {
    let events = events(Plan::new([without_reference(4)], PoseChoice::ReferenceElseFilter));
    let localized = events.iter().filter(|event| matches!(event, Event::Localized { of: 4, .. }));
    assert_eq!(localized.count(), 4);
    let found = poses(&events)[0];
    let truth = walk(4);
    for (estimate, truth) in found.estimates.iter().zip(truth.reference_poses()) {
        let (pose, truth) = (estimate.unwrap().pose, truth.unwrap());
        assert!((pose.x_m - truth.x_m).hypot(pose.y_m - truth.y_m) < 0.05);
    }
    assert!(
        matches!(&found.source, PoseSource::Filter { settings } if settings.contains("\"smoothed\":true"))
    );
}

#[test]
fn the_device_is_opened_once_for_all_recordings_and_not_at_all_where_no_filter_runs() {
    let opened = Arc::new(AtomicUsize::new(0));
    let count = opened.clone();
    let open: OpenDevice = Arc::new(move || {
        count.fetch_add(1, Ordering::SeqCst);
        Ok(Device { name: "counted".to_owned(), backend: Arc::new(CpuBackend) })
    });
    let filter = FilterPlan::default().with_device(open).with_smoothing(false);
    let reference = Plan::new([walk(2)], PoseChoice::ReferenceElseFilter).with_filter(filter.clone());
    events(reference);
    assert_eq!(opened.load(Ordering::SeqCst), 0);
    let both = [without_reference(2), without_reference(3)];
    let found = events(Plan::new(both, PoseChoice::Filter).with_filter(filter));
    assert_eq!((poses(&found).len(), opened.load(Ordering::SeqCst)), (2, 1));
}

#[test]
fn a_device_that_cannot_be_opened_ends_the_stream_with_its_error_and_makes_no_database() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let broken: OpenDevice = Arc::new(|| Err(BackendError::new("no driver")));
    let filter = FilterPlan::default().with_device(broken);
    let plan = Plan::new([walk(2)], PoseChoice::Filter).with_filter(filter).with_database(&path);
    let events: Vec<_> = plan.start().collect();
    assert!(matches!(events.as_slice(), [Err(PipelineError::Device(_))]));
    assert!(!path.exists());
}

#[test]
fn a_pipeline_that_is_dropped_stops_and_another_one_goes_on_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let plan = Plan::new([walk(20)], PoseChoice::ReferenceElseFilter).with_database(&path).with_hall(false);
    let mut pipeline = plan.clone().start();
    let stored = pipeline.find(|event| matches!(event, Ok(Event::Stored { done: 5, .. })));
    assert!(stored.is_some());
    drop(pipeline);
    let before = Database::open(&path).unwrap().images().unwrap().len();
    assert!((5..20).contains(&before), "{before} images were stored");
    let report = events(plan).into_iter().find_map(|event| match event {
        Event::Ingested { report, .. } => Some(report),
        _ => None,
    });
    assert_eq!(report.map(|report| (report.added, report.already_there)), Some((20 - before, before)));
}

#[test]
fn frames_held_back_are_not_stored_and_their_poses_are_told() {
    let rule = HoldBack { every: 5, at_least: 10 };
    let held = |frames| {
        let plan = Plan::new([walk(frames)], PoseChoice::ReferenceElseFilter).with_hold_back(rule);
        poses(&events(plan))[0].clone()
    };
    let found = held(12);
    let frames: Vec<usize> = found.held_back.iter().map(|(frame, _)| *frame).collect();
    assert_eq!(frames, [2, 7]);
    assert!(found.estimates.iter().enumerate().all(|(i, pose)| pose.is_none() == frames.contains(&i)));
    assert!(held(9).held_back.is_empty(), "too few to spare any");
}

#[test]
fn a_file_of_poses_at_other_times_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("poses.tum");
    std::fs::write(&file, "").unwrap();
    let events: Vec<_> = Plan::new([walk(2)], PoseChoice::File(file.clone())).start().collect();
    assert!(matches!(&events[0], Err(PipelineError::NoPoses { .. } | PipelineError::Sequence(_))));
    assert!(events[0].as_ref().unwrap_err().to_string().contains(file.to_str().unwrap()));
}
