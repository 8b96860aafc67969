//! Camera models by COLMAP's names, which map points in the camera's axes to pixels and back.
//!
//! A pixel's centre has integer coordinates; the first pixel's centre is (0, 0). Every model first distorts the
//! direction into the plane of unit focal length (one file per model), then scales: `u = fx a + cx`, `v = fy b + cy`.

mod kernel;
mod opencv;
mod opencv_fisheye;
mod rim;

use glam::{DVec2, DVec3};

pub(crate) use self::kernel::{Places, inside_lanes, place_lanes};
use self::rim::PINHOLE_MAX_ANGLE_RAD;
pub use self::{
    kernel::{KernelCamera, LANES, Lanes, Lens, Pixels, RADIAL_TERMS, project_lanes},
    opencv::Opencv,
    opencv_fisheye::OpencvFisheye,
};
use crate::pose::CameraPose;

/// Maximum width and height of a picture, pixels: half of what a JPEG can have.
pub const MAX_SIDE_PX: u32 = 1 << 15;

/// Maximum number of pixels of a picture, four times those of 4K video. Measured at 8192 x 4096 pixels, `render` takes 1.8 GB of
/// memory for a simulated picture, and 0.7 GB for one from small recorded pictures.
pub const MAX_PIXELS: u32 = 1 << 25;

/// Minimum of the largest valid angle, radians: a camera with less would see no more than a pixel.
const SMALLEST_MAX_ANGLE_RAD: f64 = 1e-3;

/// Maximum angle by which rounding may carry a ray of the rim beyond it, radians: every ray of a pixel can be
/// projected.
const RIM_ROUNDING_RAD: f64 = 1e-9;

/// Map from a direction to a point in the plane of unit focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distortion {
    /// No distortion: COLMAP's `PINHOLE`.
    Pinhole,
    /// Brown–Conrady: COLMAP's `OPENCV`.
    Opencv(Opencv),
    /// Kannala–Brandt: COLMAP's `OPENCV_FISHEYE`.
    OpencvFisheye(OpencvFisheye),
}

impl Distortion {
    /// Returns the model's name in COLMAP and nerfstudio.
    pub fn colmap_name(&self) -> &'static str {
        match self {
            Self::Pinhole => "PINHOLE",
            Self::Opencv(_) => "OPENCV",
            Self::OpencvFisheye(_) => "OPENCV_FISHEYE",
        }
    }

    /// Returns the distortion's parameters, in the order of the model's file format.
    pub fn parameters(&self) -> Vec<f64> {
        match self {
            Self::Pinhole => Vec::new(),
            Self::Opencv(model) => vec![model.k1, model.k2, model.p1, model.p2, model.k3],
            Self::OpencvFisheye(model) => model.k.to_vec(),
        }
    }

    /// Returns the names of the parameters, in the order of [`Distortion::parameters`].
    pub fn names(&self) -> &'static [&'static str] {
        match self {
            Self::Pinhole => &[],
            Self::Opencv(_) => &["k1", "k2", "p1", "p2", "k3"],
            Self::OpencvFisheye(_) => &["k1", "k2", "k3", "k4"],
        }
    }

    /// Returns the angle from the optical axis at which the distortion stops growing, radians.
    fn natural_max_angle_rad(&self) -> f64 {
        match self {
            Self::Pinhole => PINHOLE_MAX_ANGLE_RAD,
            Self::Opencv(model) => model.max_angle_rad(),
            Self::OpencvFisheye(model) => model.max_angle_rad(),
        }
    }

    /// Projects a direction to a point in the plane of unit focal length.
    fn distort(&self, point_in_camera: DVec3) -> DVec2 {
        match self {
            Self::Pinhole => point_in_camera.truncate() / point_in_camera.z,
            Self::Opencv(model) => model.distort(point_in_camera.truncate() / point_in_camera.z),
            Self::OpencvFisheye(model) => model.distort(point_in_camera),
        }
    }

    /// Returns the gradients of the two plane coordinates with respect to the point in the camera's axes, one per row.
    fn distort_gradients(&self, point_in_camera: DVec3) -> [DVec3; 2] {
        let perspective = || {
            let (x, y, z) = point_in_camera.into();
            [DVec3::new(1.0 / z, 0.0, -x / (z * z)), DVec3::new(0.0, 1.0 / z, -y / (z * z))]
        };
        match self {
            Self::Pinhole => perspective(),
            Self::Opencv(model) => {
                let [dx, dy] = perspective();
                model
                    .distort_gradients(point_in_camera.truncate() / point_in_camera.z)
                    .map(|row| row.x * dx + row.y * dy)
            }
            Self::OpencvFisheye(model) => model.distort_gradients(point_in_camera),
        }
    }

    /// Returns the derivatives of the plane coordinates by each parameter, in the order of [`Distortion::parameters`].
    fn parameter_gradients(&self, point_in_camera: DVec3) -> Vec<DVec2> {
        match self {
            Self::Pinhole => Vec::new(),
            Self::Opencv(model) => {
                model.parameter_gradients(point_in_camera.truncate() / point_in_camera.z).to_vec()
            }
            Self::OpencvFisheye(model) => model.parameter_gradients(point_in_camera).to_vec(),
        }
    }

    /// Returns the direction (not normalised) seen at a point in the plane of unit focal length, up to the given angle.
    fn undistort(&self, place: DVec2, max_angle_rad: f64) -> Option<DVec3> {
        match self {
            Self::Pinhole => Some(place.extend(1.0)),
            Self::Opencv(model) => {
                model.undistort(place, max_angle_rad).map(|undistorted| undistorted.extend(1.0))
            }
            Self::OpencvFisheye(model) => model.undistort(place, max_angle_rad),
        }
    }
}

/// Circle outside which the picture of a fisheye is black.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageCircle {
    /// Column of the centre, pixels from the first pixel's centre.
    pub cx: f64,
    /// Row of the centre, pixels from the first pixel's centre.
    pub cy: f64,
    /// Radius, pixels.
    pub radius: f64,
}

impl ImageCircle {
    /// Returns whether a pixel lies inside.
    pub fn contains(&self, pixel: DVec2) -> bool {
        pixel.distance_squared(DVec2::new(self.cx, self.cy)) <= self.radius * self.radius
    }
}

/// Reason why a point in space has no pixel.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoPixel {
    /// The point is not a finite triple of numbers, or lies in the projection centre.
    #[error("the point has no direction from the camera")]
    NoDirection,
    /// The direction is farther from the optical axis than the model is valid.
    #[error("{angle_rad:.3} rad from the optical axis, the camera is valid up to {max_angle_rad:.3} rad")]
    BeyondMaxAngle {
        /// Angle between the direction and the optical axis.
        angle_rad: f64,
        /// Largest valid angle of the camera.
        max_angle_rad: f64,
    },
    /// The pixel would lie outside the picture.
    #[error("pixel ({:.1}, {:.1}) is outside the picture", .pixel.x, .pixel.y)]
    OutsideImage {
        /// Position that it would have.
        pixel: DVec2,
    },
    /// The pixel lies in the black outside the lens's image circle.
    #[error("pixel ({:.1}, {:.1}) is outside the lens's image circle", .pixel.x, .pixel.y)]
    OutsideImageCircle {
        /// Position that it would have.
        pixel: DVec2,
    },
}

/// Reason why a pixel has no ray, or no point on the ground.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoRay {
    /// No direction within the camera's largest valid angle is seen at the pixel.
    #[error("no direction within the camera's valid angle is seen at this pixel")]
    BeyondMaxAngle,
    /// The ray does not meet the ground: it points at or above the horizon.
    #[error("the ray points at or above the horizon")]
    AboveHorizon,
    /// The camera is not above the ground, or its pose is not made of finite numbers.
    #[error("the camera is not above the ground")]
    NotAboveGround,
}

/// Reason why a camera's parameters cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InvalidCamera {
    /// Width or height is zero or above [`MAX_SIDE_PX`], or the picture has more pixels than [`MAX_PIXELS`].
    #[error(
        "width and height must be between 1 and {MAX_SIDE_PX} pixels and their product at most {MAX_PIXELS}, not {width} x {height}"
    )]
    Size {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
    /// A focal length is not a positive number.
    #[error("fx and fy must be positive numbers of pixels, not {fx} and {fy}")]
    FocalLength {
        /// Focal length along the rows, pixels.
        fx: f64,
        /// Focal length along the columns, pixels.
        fy: f64,
    },
    /// A parameter is NaN or infinite.
    #[error("{name} is not a finite number")]
    NotFinite {
        /// Name of the parameter.
        name: &'static str,
    },
    /// The distortion stops growing right beside the optical axis, or the given angle is out of the lens's range.
    #[error(
        "max_angle_rad is {max_angle_rad}: it must be above 0 and at most where the distortion polynomial stops growing ({natural_rad:.4})"
    )]
    MaxAngle {
        /// Given angle, radians.
        max_angle_rad: f64,
        /// Angle at which the polynomial stops growing, radians.
        natural_rad: f64,
    },
}

/// Intrinsic parameters of a camera: COLMAP's model, the picture's size and the range in which the model holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Focal length along the rows, pixels.
    pub fx: f64,
    /// Focal length along the columns, pixels.
    pub fy: f64,
    /// Column of the principal point, pixels from the first pixel's centre.
    pub cx: f64,
    /// Row of the principal point, pixels from the first pixel's centre.
    pub cy: f64,
    /// Distortion of the lens.
    pub distortion: Distortion,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
    /// Angle from the optical axis beyond which directions have no pixel, radians.
    max_angle_rad: f64,
    /// Circle outside which the picture is black.
    pub image_circle: Option<ImageCircle>,
}

impl Camera {
    /// Makes a camera from its size, `[fx, fy, cx, cy]` in pixels and its distortion. It is valid up to the angle at
    /// which the polynomial stops growing. Fails if a parameter cannot be used.
    pub fn new(
        [width, height]: [u32; 2],
        [fx, fy, cx, cy]: [f64; 4],
        distortion: Distortion,
    ) -> Result<Self, InvalidCamera> {
        let fits = [width, height].iter().all(|side| (1..=MAX_SIDE_PX).contains(side));
        if !fits || width * height > MAX_PIXELS {
            return Err(InvalidCamera::Size { width, height });
        }
        for (name, value) in [("fx", fx), ("fy", fy), ("cx", cx), ("cy", cy)] {
            if !value.is_finite() {
                return Err(InvalidCamera::NotFinite { name });
            }
        }
        if distortion.parameters().iter().any(|value| !value.is_finite()) {
            return Err(InvalidCamera::NotFinite { name: "distortion" });
        }
        if fx <= 0.0 || fy <= 0.0 {
            return Err(InvalidCamera::FocalLength { fx, fy });
        }
        let max_angle_rad = distortion.natural_max_angle_rad();
        if max_angle_rad < SMALLEST_MAX_ANGLE_RAD {
            return Err(InvalidCamera::MaxAngle { max_angle_rad, natural_rad: max_angle_rad });
        }
        Ok(Self { fx, fy, cx, cy, distortion, width, height, max_angle_rad, image_circle: None })
    }

    /// Returns the same lens with pictures of another size, width and height in pixels. Fails if they have too many or no pixels.
    pub fn resized(&self, size: [u32; 2]) -> Result<Self, InvalidCamera> {
        let across = f64::from(size[0]) / f64::from(self.width);
        let down = f64::from(size[1]) / f64::from(self.height);
        // Pixel centres have whole coordinates: the picture starts half a pixel before the first one.
        let place = |u: f64, v: f64| [(u + 0.5) * across - 0.5, (v + 0.5) * down - 0.5];
        let [cx, cy] = place(self.cx, self.cy);
        let resized = Self::new(size, [self.fx * across, self.fy * down, cx, cy], self.distortion)?;
        let image_circle = self.image_circle.map(|circle| {
            let [cx, cy] = place(circle.cx, circle.cy);
            ImageCircle { cx, cy, radius: circle.radius * across.min(down) }
        });
        Ok(Self { max_angle_rad: self.max_angle_rad, image_circle, ..resized })
    }

    /// Limits the camera to directions up to this angle from the optical axis, radians. Fails if the angle is not above
    /// 0 or is larger than the angle at which the polynomial stops growing.
    pub fn with_max_angle_rad(self, max_angle_rad: f64) -> Result<Self, InvalidCamera> {
        let natural_rad = self.distortion.natural_max_angle_rad();
        if !(max_angle_rad > 0.0 && max_angle_rad <= natural_rad) {
            return Err(InvalidCamera::MaxAngle { max_angle_rad, natural_rad });
        }
        Ok(Self { max_angle_rad, ..self })
    }

    /// Sets the circle outside which the picture is black.
    pub fn with_image_circle(self, image_circle: Option<ImageCircle>) -> Self {
        Self { image_circle, ..self }
    }

    /// Returns the angle from the optical axis beyond which directions have no pixel, radians.
    pub fn max_angle_rad(&self) -> f64 {
        self.max_angle_rad
    }

    /// Projects a point in the camera's axes to its pixel. Fails if the camera does not see the point.
    pub fn project(&self, point_in_camera: DVec3) -> Result<DVec2, NoPixel> {
        let pixel = self.project_unbounded(point_in_camera)?;
        self.check_inside(pixel)?;
        Ok(pixel)
    }

    /// Works as [`Camera::project`], but the pixel may lie outside the picture. Fails if the point has no direction or
    /// lies beyond the largest valid angle.
    pub fn project_unbounded(&self, point_in_camera: DVec3) -> Result<DVec2, NoPixel> {
        let (scaled, _) = self.scaled_point(point_in_camera)?;
        self.pixel_from_plane(self.distortion.distort(scaled))
    }

    /// Projects a point as [`Camera::project`] does, and returns also the gradients of u and v with respect to the point
    /// (pixels per metre). Fails if the camera does not see the point.
    pub fn project_with_gradients(&self, point_in_camera: DVec3) -> Result<(DVec2, [DVec3; 2]), NoPixel> {
        let (scaled, scale_m) = self.scaled_point(point_in_camera)?;
        let pixel = self.pixel_from_plane(self.distortion.distort(scaled))?;
        self.check_inside(pixel)?;
        let [da, db] = self.distortion.distort_gradients(scaled);
        Ok((pixel, [self.fx * da / scale_m, self.fy * db / scale_m]))
    }

    /// Returns the derivatives of the pixel by each intrinsic parameter: fx, fy, cx, cy, then those of the distortion.
    /// Fails if the point has no direction or lies beyond the largest valid angle.
    pub fn intrinsic_gradients(&self, point_in_camera: DVec3) -> Result<Vec<DVec2>, NoPixel> {
        let (scaled, _) = self.scaled_point(point_in_camera)?;
        let plane = self.distortion.distort(scaled);
        self.check_inside(self.pixel_from_plane(plane)?)?;
        let mut gradients = vec![DVec2::new(plane.x, 0.0), DVec2::new(0.0, plane.y), DVec2::X, DVec2::Y];
        let focal = DVec2::new(self.fx, self.fy);
        gradients.extend(self.distortion.parameter_gradients(scaled).iter().map(|&g| g * focal));
        Ok(gradients)
    }

    /// Returns a point on the same ray with coordinates of at most 1, whose squares cannot overflow, and the scale
    /// factor.
    fn scaled_point(&self, point_in_camera: DVec3) -> Result<(DVec3, f64), NoPixel> {
        if !point_in_camera.is_finite() || point_in_camera == DVec3::ZERO {
            return Err(NoPixel::NoDirection);
        }
        let scale_m = point_in_camera.abs().max_element();
        let scaled = point_in_camera / scale_m;
        let angle_rad = angle_from_axis_rad(scaled);
        if angle_rad > self.max_angle_rad + 2.0 * RIM_ROUNDING_RAD {
            return Err(NoPixel::BeyondMaxAngle { angle_rad, max_angle_rad: self.max_angle_rad });
        }
        Ok((scaled, scale_m))
    }

    /// Returns the unit direction, in the camera's axes, that is seen at a pixel. Fails if it is beyond the largest
    /// valid angle.
    pub fn unproject(&self, pixel: DVec2) -> Result<DVec3, NoRay> {
        let place = DVec2::new((pixel.x - self.cx) / self.fx, (pixel.y - self.cy) / self.fy);
        let direction = self.distortion.undistort(place, self.max_angle_rad).ok_or(NoRay::BeyondMaxAngle)?;
        let direction = direction.try_normalize().ok_or(NoRay::BeyondMaxAngle)?;
        if angle_from_axis_rad(direction) > self.max_angle_rad + RIM_ROUNDING_RAD {
            return Err(NoRay::BeyondMaxAngle);
        }
        Ok(direction)
    }

    /// Returns the point of the ground plane (z = 0, world axes, metres) that is seen at a pixel. Fails if the pixel
    /// has no valid ray, the ray does not meet the ground, or the camera is not above it.
    pub fn unproject_to_ground(&self, pose: CameraPose, pixel: DVec2) -> Result<DVec2, NoRay> {
        let ray_in_world = pose.rotation_world_from_camera() * self.unproject(pixel)?;
        if !pose.is_finite() || pose.height_m <= 0.0 {
            return Err(NoRay::NotAboveGround);
        }
        let distance_m = -pose.height_m / ray_in_world.z;
        let point_in_world = pose.planar().position_in_world() + distance_m * ray_in_world.truncate();
        // A ray almost parallel to the ground may meet it too far away for a finite number.
        if ray_in_world.z < 0.0 && point_in_world.is_finite() {
            Ok(point_in_world)
        } else {
            Err(NoRay::AboveHorizon)
        }
    }

    /// Checks that a pixel lies in the picture and in the lens's image circle. Fails with the reason if it does not.
    pub fn check_inside(&self, pixel: DVec2) -> Result<(), NoPixel> {
        let inside = (0.0..=f64::from(self.width) - 1.0).contains(&pixel.x)
            && (0.0..=f64::from(self.height) - 1.0).contains(&pixel.y);
        if !inside {
            return Err(NoPixel::OutsideImage { pixel });
        }
        match self.image_circle {
            Some(circle) if !circle.contains(pixel) => Err(NoPixel::OutsideImageCircle { pixel }),
            _ => Ok(()),
        }
    }

    fn pixel_from_plane(&self, plane: DVec2) -> Result<DVec2, NoPixel> {
        let pixel = DVec2::new(self.fx * plane.x + self.cx, self.fy * plane.y + self.cy);
        if pixel.is_finite() { Ok(pixel) } else { Err(NoPixel::OutsideImage { pixel }) }
    }
}

/// Returns the angle between a direction and the optical axis, 0 to π, radians.
fn angle_from_axis_rad(direction: DVec3) -> f64 {
    direction.truncate().length().atan2(direction.z)
}

#[cfg(test)]
mod tests;
