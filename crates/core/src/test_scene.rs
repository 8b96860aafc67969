//! Pictures for tests, rendered independently of the code under test: every pixel's rays are followed to the ground and
//! coloured by plain geometry.

use glam::DVec2;
use image::{Rgb, RgbImage};

use crate::{
    camera::{Camera, Distortion, OpencvFisheye},
    field::FieldDimensions,
    pose::CameraPose,
};

/// Number of rays along each side of a pixel.
const SUPERSAMPLING: u32 = 3;

pub(crate) fn field() -> FieldDimensions {
    FieldDimensions::preset("humanoid-kidsize-2010").unwrap()
}

/// Returns a fisheye of 320 × 240 pixels that sees about 150° across.
pub(crate) fn fisheye() -> Camera {
    let lens = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
    Camera::new([320, 240], [120.0, 121.0, 159.0, 120.5], Distortion::OpencvFisheye(lens)).unwrap()
}

/// Returns poses spread over the field, looking a little down.
pub(crate) fn poses() -> Vec<CameraPose> {
    let pose = |x_m, y_m, yaw_rad, pitch_rad, roll_rad| CameraPose {
        x_m,
        y_m,
        yaw_rad,
        height_m: 0.5,
        pitch_rad,
        roll_rad,
    };
    vec![
        pose(-1.7, 0.3, 0.4, 0.42, 0.02),
        pose(0.8, -0.9, 2.2, 0.38, -0.03),
        pose(2.0, 1.1, -2.6, 0.45, 0.0),
        pose(-0.4, 1.4, -1.2, 0.40, 0.01),
    ]
}

pub(crate) fn render(camera: &Camera, pose: CameraPose, field: &FieldDimensions) -> RgbImage {
    let rotation = pose.rotation_world_from_camera();
    let curves = field.curves();
    let extent = field.carpet_half_extent_m();
    let color = |pixel: DVec2| -> [f64; 3] {
        let Ok(ray_in_camera) = camera.unproject(pixel) else { return [0.0; 3] };
        let ray = rotation * ray_in_camera;
        if ray.z >= -1e-3 {
            return [120.0, 115.0, 118.0];
        }
        let ground = (pose.position_in_world() - pose.height_m / ray.z * ray).truncate();
        if ground.x.abs() > extent.x || ground.y.abs() > extent.y {
            [140.0, 110.0, 100.0]
        } else if curves.iter().any(|curve| curve.distance_m(ground) <= field.line_width_m / 2.0) {
            [230.0, 232.0, 228.0]
        } else {
            [60.0, 150.0, 70.0]
        }
    };
    RgbImage::from_fn(camera.width, camera.height, |u, v| {
        let mut sum = [0.0; 3];
        for i in 0..SUPERSAMPLING * SUPERSAMPLING {
            let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(SUPERSAMPLING) - 0.5;
            let pixel = DVec2::new(
                f64::from(u) + offset(i % SUPERSAMPLING),
                f64::from(v) + offset(i / SUPERSAMPLING),
            );
            sum.iter_mut().zip(color(pixel)).for_each(|(sum, value)| *sum += value);
        }
        Rgb(sum.map(|sum| (sum / f64::from(SUPERSAMPLING * SUPERSAMPLING)).round() as u8))
    })
}
