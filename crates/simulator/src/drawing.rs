//! The way of layers into the picture: drawn, composed by depth, developed, put over what was recorded.

use rayon::prelude::*;
use reality_sim_core::{
    pose::CameraPose,
    sequence::CameraSetup,
    warp::{Placement, RayTable, Target},
};
use reality_sim_sensor::{Chain, Development, Twist};
use reality_sim_synthesis::Archive;

use crate::{
    canvas::Canvas,
    compose::{Composed, Scene, Tally, areas, compose},
    field_surfaces::FieldSurfaces,
    frame::Frame,
    layer::Layer,
    layer_settings::LayerSettings,
    light_reference::LightReference,
    scene_light::SceneLight,
    seen_object::SeenObject,
    shadow::{Shadow, darken},
    view::View,
};

/// Time and motion of a picture.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Moment {
    pub(crate) time_s: f64,
    pub(crate) twist: Twist,
}

/// What is known of a camera before a picture is taken.
#[derive(Debug)]
pub(crate) struct Drawing {
    development: Development,
    rays: RayTable,
    reference: LightReference,
    surfaces: FieldSurfaces,
}

impl Drawing {
    pub(crate) fn new(chain: &Chain, archive: &Archive, setup: &CameraSetup) -> Self {
        Self {
            development: Development::new(chain),
            rays: RayTable::new(chain.camera()),
            reference: LightReference::new(archive, setup, chain),
            surfaces: FieldSurfaces::new(archive.field()),
        }
    }

    /// Draws layers over the frame's picture.
    pub(crate) fn add(
        &self,
        archive: &Archive,
        (pose, moment): (CameraPose, Moment),
        layers: &[&dyn Layer],
        settings: LayerSettings,
        canvases: &mut Vec<Vec<Canvas>>,
        frame: &mut Frame,
    ) {
        let chain = self.development.chain();
        let pose = chain.mounted(pose);
        let proxy = archive.proxy_geometry().holding(pose);
        let target = Target { rays: &self.rays, placement: Placement::new(pose), proxy: &proxy };
        let exposure = self.development.exposure(&frame.picture, moment.time_s, settings.noise_seed);
        let light = SceneLight {
            reference: &self.reference,
            development: &self.development,
            surfaces: &self.surfaces,
            picture: settings.matches_light.then_some(&frame.picture),
            pose,
            gain: exposure.gain,
        };
        let view = |magnification: f64| View {
            chain,
            pose,
            world_from_camera: pose.rotation_world_from_camera(),
            twist: moment.twist,
            time_s: moment.time_s,
            magnification,
            light,
        };
        let green = view(chain.magnification()[1]);
        if chain.splits_colors() {
            draw(&chain.magnification().map(view), layers, canvases);
        } else {
            draw(std::slice::from_ref(&green), layers, canvases);
        }
        let spheres = layers.iter().filter(|_| settings.casts_shadows).flat_map(|layer| layer.occluders());
        let shadows: Vec<Shadow> = spheres.filter_map(|sphere| Shadow::new(sphere, &green)).collect();
        darken(&mut frame.picture, &target, &self.development, &shadows);
        let scene = scene(target, pose, chain);
        let first_object = list_objects(layers, frame);
        let boxes = canvases.iter().flatten().map(Canvas::area);
        let size = [chain.camera().width, chain.camera().height];
        let areas = areas(boxes, self.development.reach_px() as u32, size);
        let made: Vec<(Composed, Vec<[u8; 3]>)> = areas
            .into_par_iter()
            .map(|area| {
                let mut composed = compose(&scene, canvases, &first_object, frame.objects.len(), area);
                let pixels = self.development.compose(&mut composed.tile, &frame.picture, &exposure);
                (composed, pixels)
            })
            .collect();
        made.iter().for_each(|(composed, pixels)| put(composed, pixels, frame));
        note_objects(&made, canvases, &first_object, &mut frame.objects);
    }
}

fn scene<'a>(target: Target<'a>, pose: CameraPose, chain: &Chain) -> Scene<'a> {
    let focal_px = chain.camera().fx.min(chain.camera().fy) as f32;
    Scene { target, height_m: pose.height_m as f32, focal_px }
}

/// Draws every layer on a canvas of its own, once for each view.
fn draw(views: &[View<'_>], layers: &[&dyn Layer], canvases: &mut Vec<Vec<Canvas>>) {
    canvases.resize_with(views.len(), Vec::new);
    for canvases in &mut *canvases {
        canvases.resize_with(layers.len(), Canvas::default);
    }
    let pairs = views.iter().zip(canvases).flat_map(|(view, canvases)| {
        canvases.iter_mut().zip(layers).map(move |(canvas, layer)| (view, canvas, layer))
    });
    pairs.collect::<Vec<_>>().into_par_iter().with_max_len(1).for_each(|(view, canvas, layer)| {
        canvas.clear(view.size());
        layer.draw(view, canvas);
    });
}

/// Lists the objects of all layers in the frame, and returns the number of each layer's first one.
fn list_objects(layers: &[&dyn Layer], frame: &mut Frame) -> Vec<u16> {
    let mut first_object = Vec::with_capacity(layers.len());
    for layer in layers {
        first_object.push(u16::try_from(frame.objects.len()).unwrap_or(u16::MAX));
        frame.objects.extend(layer.objects().into_iter().map(|object| SeenObject {
            class: object.class,
            name: object.name.into_owned(),
            visible: None,
            whole: None,
            visible_pixels: 0,
            whole_pixels: 0,
            truncation: 0.0,
        }));
    }
    first_object
}

/// Puts a part of the picture into the frame.
fn put(composed: &Composed, pixels: &[[u8; 3]], frame: &mut Frame) {
    let picture_width = frame.picture.width() as usize;
    let area = composed.area;
    let width = area.width() as usize;
    let (colors, _) = frame.picture.as_chunks_mut::<3>();
    for (row, (pixels, objects)) in pixels.chunks(width).zip(composed.objects.chunks(width)).enumerate() {
        let first = (area.top as usize + row) * picture_width + area.left as usize;
        colors[first..first + width].copy_from_slice(pixels);
        for (column, (object, distance_m)) in objects.iter().enumerate() {
            frame.object_of[first + column] = *object;
            frame.distance_m[first + column] = *distance_m;
        }
    }
}

/// Notes how much of each object is seen.
fn note_objects(
    made: &[(Composed, Vec<[u8; 3]>)],
    canvases: &[Vec<Canvas>],
    first_object: &[u16],
    objects: &mut [SeenObject],
) {
    let mut tallies = vec![Tally::default(); objects.len()];
    for (composed, _) in made {
        tallies.iter_mut().zip(&composed.tallies).for_each(|(sum, tally)| sum.add(tally));
    }
    for (object, tally) in objects.iter_mut().zip(tallies) {
        object.visible = (!tally.visible.is_empty()).then_some(tally.visible);
        object.whole = (!tally.whole.is_empty()).then_some(tally.whole);
        (object.visible_pixels, object.whole_pixels) = (tally.visible_pixels, tally.whole_pixels);
    }
    let layers = canvases.get(canvases.len() / 2).into_iter().flatten().zip(first_object);
    for (canvas, first) in layers {
        let own = objects.iter_mut().skip(usize::from(*first)).enumerate();
        let next = first_object
            .iter()
            .find(|next| *next > first)
            .map_or(usize::MAX, |next| usize::from(*next - first));
        for (index, object) in own.take(next) {
            object.truncation = canvas.truncation(index as u16);
        }
    }
}
