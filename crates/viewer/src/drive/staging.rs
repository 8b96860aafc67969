//! Things and labels on their way into a picture.

use std::{cell::OnceCell, sync::Arc, time::Instant};

use glam::Vec3;
use image::RgbImage;
use reality_sim_core::pose::CameraPose;
use reality_sim_sensor::{Model, linear_from_srgb};
use reality_sim_simulator::{
    Ball, Camera, Humanoid, Layer, PixelBox,
    labels::{Labeler, Labels, Overlay},
};
use reality_sim_synthesis::{MethodKind, Synthesizer};

use super::{
    overlay::{Marks, tint},
    things::{PlacedThing, Thing},
};

/// Radius of the ball, metres: FIFA size 1, as in the data sets of the program.
const BALL_RADIUS_M: f64 = 0.065;
/// Share of the light from above that the ball mirrors: that of docs/simulator.md, found on ray-traced balls.
const BALL_GLOSS: f32 = 0.4;
/// Height of robots, metres: that of a NAO.
const ROBOT_HEIGHT_M: f64 = 0.58;

/// Thing in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenThing {
    pub placed: PlacedThing,
    /// Box of the pixels that show it, if there are any.
    pub visible: Option<PixelBox>,
}

/// Picture with things and labels.
pub struct Staged {
    pub picture: RgbImage,
    pub things: Vec<SeenThing>,
    /// Labels, if they were asked for.
    pub marks: Option<Marks>,
    /// Times for things and labels, milliseconds, where there are any.
    pub things_ms: Option<f64>,
    pub labels_ms: Option<f64>,
}

/// Puts things and labels into pictures of one camera.
pub struct Staging {
    camera: Camera,
    /// Made when labels are first asked for.
    labeler: OnceCell<Labeler>,
    labels: Labels,
}

impl Staging {
    /// Prepares pictures of a synthesizer's camera; things go through the effects of a model if there is one.
    pub fn new(synthesizer: Arc<Synthesizer>, model: Option<&Model>) -> Self {
        let plain = Camera::with(synthesizer, MethodKind::default());
        // A model that leaves no valid camera was refused when the file was opened.
        let modelled = model.and_then(|model| plain.clone().with_model(model).ok());
        Self { camera: modelled.unwrap_or(plain), labeler: OnceCell::new(), labels: Labels::default() }
    }

    /// Puts things into a scene that was taken at a pose, and labels if they are wanted.
    pub fn stage(
        &mut self,
        scene: RgbImage,
        pose: CameraPose,
        things: &[PlacedThing],
        is_labelled: bool,
    ) -> Staged {
        let start = Instant::now();
        let layers: Vec<Box<dyn Layer>> = things.iter().map(layer).collect();
        let layers: Vec<&dyn Layer> = layers.iter().map(Box::as_ref).collect();
        let frame = self.camera.compose(pose, &layers, scene);
        let things_ms = (!things.is_empty()).then(|| milliseconds_since(start));
        // The objects of a frame have the order of its layers.
        let seen = things.iter().zip(&frame.objects);
        let seen = seen.map(|(&placed, object)| SeenThing { placed, visible: object.visible }).collect();
        let start = Instant::now();
        let mut picture = frame.picture;
        let marks = (is_labelled && pose.is_possible()).then(|| {
            let overlay = Overlay {
                objects: &frame.objects,
                object_of: &frame.object_of,
                distance_m: &frame.distance_m,
            };
            let labeler = self.labeler.get_or_init(|| labeler(&self.camera));
            labeler.label(pose, &[], overlay, &mut self.labels);
            tint(&mut picture, &self.labels);
            Marks::of(&self.labels)
        });
        let labels_ms = marks.is_some().then(|| milliseconds_since(start));
        Staged { picture, things: seen, marks, things_ms, labels_ms }
    }
}

/// Returns the time since an instant, milliseconds.
pub fn milliseconds_since(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

fn labeler(camera: &Camera) -> Labeler {
    let synthesizer = camera.synthesizer();
    let archive = synthesizer.archive();
    Labeler::new(synthesizer.camera(), archive.field(), archive.proxy_geometry())
}

/// Makes the layer of a thing.
fn layer(placed: &PlacedThing) -> Box<dyn Layer> {
    let PlacedThing { thing, place } = *placed;
    let reflectance = Vec3::from_array(thing.srgb().map(linear_from_srgb));
    match thing {
        Thing::Ball => {
            let ball = Ball::on_ground(place.x_m, place.y_m, BALL_RADIUS_M, reflectance);
            Box::new(ball.glossy(BALL_GLOSS).named(thing.name()))
        }
        Thing::Robot(_) => {
            Box::new(Humanoid::standing(place, ROBOT_HEIGHT_M, reflectance).named(thing.name()))
        }
    }
}
