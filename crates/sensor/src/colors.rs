//! The colours of the scene, in linear light.

use glam::Vec3;
use reality_sim_core::{field::FieldDimensions, sequence::CameraSetup};

/// Colours of the scene as the camera records them: linear RGB, 1 is full scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneColors {
    /// White lines and marks.
    pub line_linear_rgb: Vec3,
    /// The carpet.
    pub carpet_linear_rgb: Vec3,
    /// Posts and crossbar of the goal at −x.
    pub goal_negative_x_linear_rgb: Vec3,
    /// Posts and crossbar of the goal at +x.
    pub goal_positive_x_linear_rgb: Vec3,
    /// The hall's floor outside the carpet.
    pub floor_linear_rgb: Vec3,
    /// The hall's walls.
    pub wall_linear_rgb: Vec3,
    /// The hall's ceiling.
    pub ceiling_linear_rgb: Vec3,
}

impl Default for SceneColors {
    /// Returns white lines and goals on green carpet, exposed so that nothing is clipped; the hall is grey. Lines and carpet
    /// have the colours of the nominal camera of the project's ray-traced recordings.
    fn default() -> Self {
        let white = Vec3::new(0.65, 0.67, 0.65);
        Self {
            line_linear_rgb: white,
            carpet_linear_rgb: Vec3::new(0.04, 0.144, 0.05),
            goal_negative_x_linear_rgb: white,
            goal_positive_x_linear_rgb: white,
            floor_linear_rgb: Vec3::splat(0.12),
            wall_linear_rgb: Vec3::splat(0.25),
            ceiling_linear_rgb: Vec3::splat(0.4),
        }
    }
}

impl SceneColors {
    /// Takes lines and carpet from the camera's photometry, goals from the field, and the default for the rest.
    pub fn new(setup: &CameraSetup, field: &FieldDimensions) -> Self {
        let default = Self::default();
        let recorded =
            |color: Option<[f64; 3]>| color.map(|rgb| Vec3::from_array(rgb.map(|value| value as f32)));
        let goal = |srgb: Option<[u8; 3]>| srgb.map(|rgb| Vec3::from_array(rgb.map(linear_from_srgb)));
        let photometry = setup.photometry;
        Self {
            line_linear_rgb: recorded(photometry.and_then(|p| p.line_linear_rgb))
                .unwrap_or(default.line_linear_rgb),
            carpet_linear_rgb: recorded(photometry.and_then(|p| p.carpet_linear_rgb))
                .unwrap_or(default.carpet_linear_rgb),
            goal_negative_x_linear_rgb: goal(field.goal_srgb_negative_x)
                .unwrap_or(default.goal_negative_x_linear_rgb),
            goal_positive_x_linear_rgb: goal(field.goal_srgb_positive_x)
                .unwrap_or(default.goal_positive_x_linear_rgb),
            ..default
        }
    }
}

/// Converts an sRGB value to a linear one (IEC 61966-2-1).
pub fn linear_from_srgb(value: u8) -> f32 {
    let value = f32::from(value) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
