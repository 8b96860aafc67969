//! Parameters that a calibration can find.

use reality_sim_core::camera::{Camera, Distortion};

/// Parameter of the lens or of the mount.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Parameter {
    /// Focal length along the rows, pixels; that along the columns keeps its ratio to it.
    FocalLength,
    /// Focal length along the columns divided by that along the rows.
    AspectRatio,
    /// Column of the principal point, pixels.
    PrincipalX,
    /// Row of the principal point, pixels.
    PrincipalY,
    /// Coefficient of the lens's distortion, by its place in [`Distortion::parameters`].
    Distortion(usize),
    /// Nominal height of the projection centre above the carpet, metres.
    Height,
    /// Turn of the camera against the stated pitch, down is positive, radians.
    MountPitch,
    /// Turn of the camera against the stated roll, clockwise is positive, radians.
    MountRoll,
}

impl Parameter {
    /// Returns the name in reports and files, with the unit where there is one.
    pub fn name(self, distortion: &Distortion) -> &'static str {
        match self {
            Self::FocalLength => "fx",
            Self::AspectRatio => "aspect_ratio",
            Self::PrincipalX => "cx",
            Self::PrincipalY => "cy",
            Self::Distortion(index) => distortion.names().get(index).copied().unwrap_or("distortion"),
            Self::Height => "height_m",
            Self::MountPitch => "mount_pitch_rad",
            Self::MountRoll => "mount_roll_rad",
        }
    }

    /// Returns whether the parameter belongs to the lens.
    pub fn is_of_lens(self) -> bool {
        !matches!(self, Self::Height | Self::MountPitch | Self::MountRoll)
    }

    /// Returns the standard deviation of what is known of the parameter before the pictures are looked at: wide enough that
    /// pictures which show it decide, narrow enough that it stays possible where they do not.
    ///
    /// The focal length may be half or twice the guess. Principal points of the real cameras on which this was tried lie up to
    /// 4 % of the width from the centre. Pixels are square to a few per mille. Distortions of wide lenses
    /// lie within one, of fisheyes within a tenth of these coefficients.
    pub(crate) fn prior_sigma(self, camera: &Camera, height_m: f64) -> f64 {
        match self {
            Self::FocalLength => 0.5 * camera.fx,
            Self::AspectRatio => 0.005,
            Self::PrincipalX | Self::PrincipalY => 0.05 * f64::from(camera.width),
            Self::Distortion(index) => distortion_sigmas(&camera.distortion)[index.min(4)],
            Self::Height => 0.5 * height_m,
            Self::MountPitch | Self::MountRoll => 0.1,
        }
    }
}

fn distortion_sigmas(distortion: &Distortion) -> [f64; 5] {
    match distortion {
        Distortion::Pinhole => [0.0; 5],
        Distortion::Opencv(_) => [0.5, 0.5, 0.01, 0.01, 0.5],
        Distortion::OpencvFisheye(_) => [0.1, 0.05, 0.02, 0.005, 0.0],
    }
}

/// Returns the choices of distortion coefficients, from the fewest to the most, by their places.
pub(crate) fn distortion_choices(distortion: &Distortion) -> &'static [&'static [usize]] {
    match distortion {
        Distortion::Pinhole => &[&[]],
        Distortion::Opencv(_) => &[&[], &[0], &[0, 1], &[0, 1, 2, 3], &[0, 1, 2, 3, 4]],
        Distortion::OpencvFisheye(_) => &[&[], &[0], &[0, 1], &[0, 1, 2], &[0, 1, 2, 3]],
    }
}
