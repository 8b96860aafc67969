//! Angle up to which a distortion maps different directions to different points.

/// Number of steps of the search. If `growth` dips below zero for less than one step, the picture folds by less than a
/// millionth of a pixel.
const STEPS: u32 = 4096;

/// Largest angle from the optical axis that a pinhole can take, radians: tan 89° is 57 focal lengths.
pub(super) const PINHOLE_MAX_ANGLE_RAD: f64 = 89.0 * std::f64::consts::PI / 180.0;

/// Returns the first angle, at most `limit_rad`, at which `growth` is no longer a positive finite number.
pub(super) fn last_growing_angle_rad(limit_rad: f64, growth: impl Fn(f64) -> f64) -> f64 {
    let grows = |angle_rad: f64| {
        let growth = growth(angle_rad);
        growth > 0.0 && growth.is_finite()
    };
    let angle = |step: u32| limit_rad * f64::from(step) / f64::from(STEPS);
    let Some(falling) = (1..=STEPS).find(|&step| !grows(angle(step))) else { return limit_rad };
    let (mut low, mut high) = (angle(falling - 1), angle(falling));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if grows(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
