//! Colours with the same meaning in every panel, distinguishable with any colour vision, on light and dark backgrounds.

use eframe::egui::Color32;

/// Pose estimate of the filter: lines, path, arrow.
pub const POSE: Color32 = Color32::from_rgb(255, 45, 160);
/// Ground truth.
pub const TRUTH: Color32 = Color32::from_rgb(20, 130, 255);
/// The field's border in the picture, and the camera's footprint on the field.
pub const BORDER: Color32 = Color32::from_rgb(255, 205, 0);
/// Particles of full weight.
pub const PARTICLE: Color32 = Color32::from_rgb(255, 150, 30);
/// Odometry alone.
pub const ODOMETRY: Color32 = Color32::from_rgb(190, 190, 200);
/// Carpet seen from above.
pub const CARPET: Color32 = Color32::from_rgb(18, 56, 36);
/// Ground beside the carpet.
pub const BESIDE: Color32 = Color32::from_rgb(24, 38, 32);
/// Carpet's lines seen from above.
pub const LINE: Color32 = Color32::from_rgb(225, 235, 228);
/// Given model.
pub const GIVEN: Color32 = Color32::from_rgb(240, 140, 30);
/// Model extended by the effects found.
pub const EXTENDED: Color32 = Color32::from_rgb(0, 165, 150);
