//! Labels as annotations.

use glam::DVec2;

use super::{
    categories::FIELD_CATEGORY,
    records::{Annotation, SeenCrossingRecord, SeenLineRecord},
    rle::Rle,
};
use crate::{
    class::Class,
    labels::{Extent, Labels, SeenCrossing, SeenLine},
    seen_object::SeenObject,
};

/// Numbers of annotations that are set aside for each picture, so that they do not depend on other pictures.
const IDS_PER_IMAGE: u64 = 100_000;

/// Values of a visibility of a keypoint.
const OUTSIDE_PICTURE: f64 = 0.0;
const HIDDEN: f64 = 1.0;
const VISIBLE: f64 = 2.0;

/// Returns the annotations of a picture; categories and things of which no pixel is seen have none.
pub fn annotations(labels: &Labels, image_id: u64) -> Vec<Annotation> {
    let surfaces = [Class::Carpet, Class::Line].map(|class| {
        let is_inside = |index: usize| labels.classes[index] == class;
        masked(labels, class.number().into(), is_inside)
    });
    let field = field_annotation(labels);
    let things =
        labels.things.iter().enumerate().map(|(number, thing)| thing_annotation(labels, number, thing));
    let seen = surfaces.into_iter().chain(things).chain([field]).filter(|annotation| annotation.area > 0);
    let number = |(index, annotation): (usize, Annotation)| Annotation {
        id: image_id * IDS_PER_IMAGE + index as u64 + 1,
        image_id,
        ..annotation
    };
    seen.enumerate().map(number).collect()
}

/// Returns the lines in view.
pub fn lines(labels: &Labels) -> Vec<SeenLineRecord> {
    let record = |seen: &SeenLine| SeenLineRecord {
        kind: seen.kind.name(),
        line: seen.line,
        pixels: seen.pixels.iter().map(|pixel| rounded(*pixel)).collect(),
    };
    labels.lines.iter().map(record).collect()
}

/// Returns the crossings and marks in the picture.
pub fn crossings(labels: &Labels) -> Vec<SeenCrossingRecord> {
    let record = |seen: &SeenCrossing| {
        Some(SeenCrossingRecord {
            kind: seen.crossing.kind.name(),
            place_m: seen.crossing.point_in_world.to_array(),
            pixel: rounded(seen.pixel?),
            visible: seen.is_visible,
        })
    };
    labels.crossings.iter().filter_map(record).collect()
}

fn field_annotation(labels: &Labels) -> Annotation {
    let is_inside = |index: usize| matches!(labels.classes[index], Class::Carpet | Class::Line);
    let keypoints = labels.crossings.iter().flat_map(|seen| match seen.pixel.map(rounded) {
        Some([u, v]) => [u, v, if seen.is_visible { VISIBLE } else { HIDDEN }],
        None => [0.0, 0.0, OUTSIDE_PICTURE],
    });
    Annotation {
        keypoints: Some(keypoints.collect()),
        num_keypoints: Some(labels.crossings.iter().filter(|seen| seen.pixel.is_some()).count()),
        ..masked(labels, FIELD_CATEGORY, is_inside)
    }
}

fn thing_annotation(labels: &Labels, number: usize, thing: &SeenObject) -> Annotation {
    let instance = number as u16 + 1;
    Annotation {
        visibility: Some(to_thousandths(thing.visibility())),
        truncation: Some(to_thousandths(f64::from(thing.truncation))),
        name: Some(thing.name.clone()),
        instance: Some(instance),
        ..masked(labels, thing.class.number().into(), |index| labels.instances[index] == instance)
    }
}

/// Makes an annotation of some pixels, without numbers of its own.
fn masked(labels: &Labels, category_id: u32, is_inside: impl Fn(usize) -> bool) -> Annotation {
    let Labels { width, height, .. } = *labels;
    let mut extent = Extent::default();
    for index in (0..width * height).filter(|index| is_inside(*index as usize)) {
        extent.add(index % width, index / width);
    }
    let around = extent.around().unwrap_or_default();
    Annotation {
        id: 0,
        image_id: 0,
        category_id,
        bbox: [around.left, around.top, around.width(), around.height()],
        area: extent.count,
        segmentation: Rle::new([width, height], is_inside),
        iscrowd: 0,
        visibility: None,
        truncation: None,
        instance: None,
        name: None,
        keypoints: None,
        num_keypoints: None,
    }
}

/// Rounds a place in the picture to a thousandth of a pixel, far below what a pixel shows: files are shorter.
fn rounded(pixel: DVec2) -> [f64; 2] {
    pixel.to_array().map(to_thousandths)
}

fn to_thousandths(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}
