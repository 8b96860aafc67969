//! Tests of things and labels in the pictures of the drawing thread.

use reality_sim_simulator::{Class, PixelBox};

use super::*;
use crate::drive::{
    answer::Drawn,
    overlay::Marks,
    things::{Eye, Gesture, Thing, Things},
};

/// Returns the source, and a request at a true picture's pose with a ball and a robot before the camera.
fn with_things(kinds: &[PictureKind]) -> (Arc<Source>, Wish, Things) {
    let source = source();
    let pose = probe(&source).1;
    let eye = Eye { camera: &source.archive.setup().camera, pose };
    let things = Things::before(eye, source.archive.field());
    let panes = kinds.iter().map(|&kind| Pane::picture(kind)).collect();
    let wish = Wish { panes, things: things.shown().to_vec(), ..wish(&source, pose) };
    (source, wish, things)
}

fn drawn(painted: &BTreeMap<Pane, Painted>, kind: PictureKind) -> &Drawn {
    painted[&Pane::picture(kind)].result.as_ref().unwrap()
}

/// Returns whether two pictures differ in a pixel of a box.
fn differ(one: &Drawn, other: &Drawn, around: PixelBox) -> bool {
    let width = one.picture.size[0];
    let pairs = one.picture.pixels.iter().zip(&other.picture.pixels).enumerate();
    let mut inside = pairs
        .filter(|(index, _)| around.contains((index % width) as u32, (index / width) as u32))
        .map(|(_, pair)| pair);
    inside.any(|(a, b)| a != b)
}

#[test]
fn things_are_in_all_pictures_but_the_true_one() {
    let (source, wish, _) = with_things(&PictureKind::ALL);
    let mut painter = painter(&source);
    let (_, with) = fulfilled(&mut painter, &wish);
    let (_, without) = fulfilled(&mut painter, &Wish { things: Vec::new(), ..wish });
    for kind in PictureKind::ALL {
        let (with, without) = (drawn(&with, kind), drawn(&without, kind));
        let is_true = kind == PictureKind::Truth;
        assert_eq!(with.picture == without.picture, is_true, "{kind:?}");
        assert_eq!(with.things.len(), if is_true { 0 } else { 2 });
        assert!(with.things.iter().all(|seen| seen.visible.is_some()), "{kind:?}");
        assert_eq!(with.facts.likeness_db, without.facts.likeness_db, "the scene is compared");
    }
}

#[test]
fn a_thing_that_moves_is_drawn_elsewhere_and_the_scene_is_not_drawn_again() {
    let (source, wish, mut things) = with_things(&[PictureKind::Blend]);
    let mut painter = painter(&source);
    let (_, before) = fulfilled(&mut painter, &wish);
    let before = drawn(&before, PictureKind::Blend);
    assert!(before.facts.times.drawing_ms.is_some() && before.facts.times.labels_ms.is_none());
    let place = things.shown()[0].place.position_in_world();
    things.obey(Gesture::MoveTo(Thing::Ball, place + DVec2::new(0.0, 0.2)));
    let mut wish = Wish { things: things.shown().to_vec(), ..wish };
    painter.wish(wish.clone());
    let after = next_drawn(&mut painter, &wish);
    assert!(after.facts.times.drawing_ms.is_none() && after.facts.times.things_ms.is_some());
    let [from, to] = [before, &after].map(|drawn| drawn.things[0].visible.unwrap());
    assert_ne!(from, to);
    wish.pose.x_m += 0.01;
    painter.wish(wish.clone());
    assert!(next_drawn(&mut painter, &wish).facts.times.drawing_ms.is_some(), "another scene");
}

/// Returns the next picture of a request.
fn next_drawn(painter: &mut Painter, wish: &Wish) -> Drawn {
    let start = Instant::now();
    loop {
        match painter.answer() {
            Some(Answer::Painted(_, painted))
                if painted.pose == wish.pose && painted.things == wish.things =>
            {
                return painted.result.unwrap();
            }
            Some(Answer::Problem(problem)) => panic!("{problem}"),
            Some(_) => {}
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(start.elapsed() < LIMIT);
    }
}

#[test]
fn what_is_removed_leaves_the_picture_as_it_was() {
    let (source, wish, mut things) = with_things(&[PictureKind::Blend]);
    let mut painter = painter(&source);
    let (_, plain) = fulfilled(&mut painter, &Wish { things: Vec::new(), ..wish.clone() });
    let (_, both) = fulfilled(&mut painter, &wish);
    things.obey(Gesture::Choose(Thing::Ball));
    things.remove_chosen();
    let wish = Wish { things: things.shown().to_vec(), ..wish };
    painter.wish(wish.clone());
    let robot = next_drawn(&mut painter, &wish);
    let ball = drawn(&both, PictureKind::Blend).things[0].visible.unwrap();
    let whole = PixelBox { left: 0, top: 0, right: u32::MAX, bottom: u32::MAX };
    assert!(differ(&robot, drawn(&both, PictureKind::Blend), ball), "the ball is gone");
    assert!(!differ(&robot, drawn(&plain, PictureKind::Blend), ball), "nothing is left of it");
    assert!(differ(&robot, drawn(&plain, PictureKind::Blend), whole), "the robot stays");
}

#[test]
fn labels_name_what_is_in_view_where_it_is() {
    let (source, wish, _) = with_things(&[PictureKind::Blend, PictureKind::Truth]);
    let wish = Wish { is_labelled: true, ..wish };
    let (_, painted) = fulfilled(&mut painter(&source), &wish);
    let marks = |kind| -> &Marks { drawn(&painted, kind).marks.as_ref().unwrap() };
    let blend = drawn(&painted, PictureKind::Blend);
    let of = |class: Class| marks(PictureKind::Blend).things.iter().find(move |thing| thing.class == class);
    let ball = of(Class::Ball).unwrap();
    assert_eq!((ball.words.as_str(), Some(ball.around)), ("ball 100 %", blend.things[0].visible));
    assert_eq!(Some(of(Class::Robot).unwrap().around), blend.things[1].visible);
    // The ball lies where the camera projects its middle.
    let middle = wish.things[0].place.position_in_world().extend(0.065);
    let pixel = source.archive.setup().camera.project(wish.pose.camera_from_world(middle)).unwrap();
    assert!(ball.around.contains(pixel.x.round() as u32, pixel.y.round() as u32));
    let truth = marks(PictureKind::Truth);
    assert!(truth.things.iter().all(|thing| thing.class == Class::Goal), "nothing was put into it");
    assert!(!truth.lines.is_empty() && !truth.crossings.is_empty());
}

#[test]
fn where_nothing_was_recorded_things_and_labels_change_nothing_of_the_reason() {
    let (source, wish, _) = with_things(&[PictureKind::Blend]);
    let pose = source.archive.usual_pose().with_planar(Pose2::new(3.2, -2.2, -0.8));
    let outwards = Wish { pose, is_labelled: true, ..wish };
    let mut painter = painter(&source);
    let (_, painted) = fulfilled(&mut painter, &outwards);
    let reason = painted[&Pane::picture(PictureKind::Blend)].result.as_ref().unwrap_err();
    assert!(reason.contains("best effort"), "{reason}");
    // Things far behind the camera are in no picture.
    let (_, painted) = fulfilled(&mut painter, &Wish { is_best_effort: true, ..outwards });
    let drawn = drawn(&painted, PictureKind::Blend);
    assert!(drawn.things.iter().all(|seen| seen.visible.is_none()));
    assert!(drawn.marks.as_ref().unwrap().things.iter().all(|thing| thing.class == Class::Goal));
}

#[test]
fn origins_are_those_of_the_scene_whatever_stands_in_it() {
    let (source, wish, _) = with_things(&[]);
    let pane = Pane { kind: PictureKind::Blend, aspect: Aspect::Origins };
    let wish = Wish { panes: vec![pane], is_labelled: true, ..wish };
    let mut painter = painter(&source);
    let (_, with) = fulfilled(&mut painter, &wish);
    let (_, without) = fulfilled(&mut painter, &Wish { things: Vec::new(), is_labelled: false, ..wish });
    let [with, without] = [&with, &without].map(|painted| painted[&pane].result.as_ref().unwrap());
    assert!(with.picture == without.picture && with.marks.is_none());
}
