//! The simulator's camera for C. `include/reality_sim.h`, which is made from these sources, is its documentation for users; types are
//! those of the header without their prefix `Rs`.

mod camera;
mod message;
mod pose;
mod scene;
mod seen;
mod status;

pub use self::{
    camera::{
        Buffers, Camera, Options, rs_camera_close, rs_camera_look, rs_camera_open, rs_camera_project,
        rs_camera_seen, rs_camera_size, rs_camera_usual_pose, rs_options,
    },
    message::{rs_message, rs_version},
    pose::Pose,
    scene::{Ball, Robot, Scene, rs_ball, rs_robot},
    seen::{Class, SeenObject},
    status::Status,
};
