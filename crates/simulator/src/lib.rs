//! The camera of a simulator: a recorded picture at any pose, with the ball and the robots that the simulator moves, and with
//! labels.
//!
//! | type | purpose |
//! |---|---|
//! | [`Camera`] | a picture at a pose, drawn into a frame |
//! | [`CameraPool`], [`Request`] | cameras for threads, and many pictures at once |
//! | [`Frame`], [`SeenObject`], [`PixelBox`] | the picture, and what is known of its pixels |
//! | [`Class`] | what a pixel shows |
//! | [`labels`] | what all pixels show, lines and crossings in pixels, boxes |
//! | [`coco`] | labels in the form of COCO |
//! | [`Layer`], [`Object`], [`Sphere`] | something that is drawn over the recorded scene |
//! | [`Ball`], [`Humanoid`], [`Body`], [`PictureLayer`], [`CubeLayer`] | layers that are ready to use |
//! | [`Mesh`], [`Placed`], [`draw_mesh`] | surfaces of triangles, and the rasteriser |
//! | [`View`], [`Canvas`], [`Fragment`] | what a layer sees of the camera, and what it draws on |
//! | [`Light`], [`Shading`], [`light_left`] | the hall's light, how a body looks in it, and what is left of it beside a thing |
//!
//! A ball and a robot before a camera, and where they are in its picture:
//!
//! ```no_run
//! use std::{path::Path, sync::Arc};
//!
//! use glam::Vec3;
//! use reality_sim_core::pose::Pose2;
//! use reality_sim_simulator::{Ball, Camera, Frame, Humanoid};
//! use reality_sim_synthesis::Archive;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let archive = Arc::new(Archive::open(Path::new("walk.db"), 256 << 20)?);
//! let pose = archive.usual_pose().with_planar(Pose2::new(-2.3, 0.2, 1.2));
//! let mut camera = Camera::new(archive);
//! let mut frame = Frame::default();
//! let ball = Ball::on_ground(-1.9, 1.3, 0.065, Vec3::new(0.9, 0.3, 0.03)).glossy(0.3);
//! let robot = Humanoid::standing(Pose2::new(-1.6, 1.6, -1.8), 0.58, Vec3::new(0.1, 0.2, 0.8)).named("goalkeeper");
//! camera.look(pose, &[&ball, &robot], &mut frame)?;
//! for object in &frame.objects {
//!     println!("{} {:?} {:.0} %", object.name, object.visible, 100.0 * object.visibility());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Pictures are RGB, 8 bits per channel; units and frames are those of [`reality_sim_core::pose`].

mod ball;
mod body;
mod camera;
mod canvas;
mod class;
pub mod coco;
mod compose;
mod cube_layer;
mod drawing;
mod error;
mod field_surfaces;
mod frame;
mod humanoid;
pub mod labels;
mod layer;
mod layer_settings;
mod light;
mod light_reference;
mod mesh;
mod path;
mod picture_layer;
mod pixel_box;
mod pool;
mod raster;
mod scene_light;
mod seen_object;
mod shading;
mod shadow;
#[cfg(test)]
mod test_view;
mod view;

pub use self::{
    ball::Ball,
    body::Body,
    camera::Camera,
    canvas::{Canvas, Fragment, PARTS},
    class::Class,
    cube_layer::{CubeFace, CubeLayer, CubeSide, NO_CUBE_OBJECT},
    error::LookError,
    frame::Frame,
    humanoid::Humanoid,
    layer::{Layer, Object, Sphere},
    layer_settings::LayerSettings,
    light::Light,
    light_reference::LightReference,
    mesh::{Mesh, Vertex},
    picture_layer::{LayerPixel, PictureLayer},
    pixel_box::PixelBox,
    pool::{CameraPool, Request},
    raster::{Placed, draw_mesh},
    seen_object::{NO_OBJECT, SeenObject},
    shading::Shading,
    shadow::light_left,
    view::{Instant, SeenPoint, View},
};
