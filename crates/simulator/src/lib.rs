//! The camera of a simulator: a recorded picture at any pose, with the ball and the robots that the simulator moves, and with
//! labels.
//!
//! | type | purpose |
//! |---|---|
//! | [`Camera`] | a picture at a pose, drawn into a frame |
//! | [`Frame`], [`SeenObject`], [`PixelBox`] | the picture, and what is known of its pixels |
//! | [`Class`] | what a pixel shows |
//! | [`Layer`], [`Object`], [`Sphere`] | something that is drawn over the recorded scene |
//! | [`Ball`], [`Humanoid`], [`Body`], [`PictureLayer`] | layers that are ready to use |
//! | [`Mesh`], [`Placed`], [`draw_mesh`] | surfaces of triangles, and the rasteriser |
//! | [`View`], [`Canvas`], [`Fragment`] | what a layer sees of the camera, and what it draws on |
//! | [`Light`], [`Shading`], [`light_left`] | the hall's light, how a body looks in it, and what is left of it beside a thing |
//!
//! Pictures are RGB, 8 bits per channel; units and frames are those of [`reality_sim_core::pose`].

mod ball;
mod body;
mod camera;
mod canvas;
mod class;
mod compose;
mod drawing;
mod error;
mod frame;
mod humanoid;
mod layer;
mod layer_settings;
mod light;
mod light_reference;
mod mesh;
mod picture_layer;
mod pixel_box;
mod raster;
mod scene_light;
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
    error::LookError,
    frame::{Frame, NO_OBJECT, SeenObject},
    humanoid::Humanoid,
    layer::{Layer, Object, Sphere},
    layer_settings::LayerSettings,
    light::Light,
    light_reference::LightReference,
    mesh::{Mesh, Vertex},
    picture_layer::{LayerPixel, PictureLayer},
    pixel_box::PixelBox,
    raster::{Placed, draw_mesh},
    shading::Shading,
    shadow::light_left,
    view::{Instant, SeenPoint, View},
};
