// Angles in single precision: WGSL guarantees its own sine and cosine only to 2⁻¹¹, half a milliradian.

const PI: f32 = 3.14159265358979;
const TAU: f32 = 6.28318530717959;

/// Sine and cosine of an angle within a few turns of zero: quarter turns are subtracted in two parts (Cody and Waite,
/// 1980), then both Taylor series run to the limit of single precision.
fn sin_cos(angle_rad: f32) -> vec2<f32> {
    let quarters = round(angle_rad * (2.0 / PI));
    // 1.5703125 has eight significant bits: its product with a small whole number is exact.
    let rest = (angle_rad - quarters * 1.5703125) - quarters * 0.00048382679490;
    let square = rest * rest;
    let sine = rest + rest * square
        * (-1.6666666667e-1 + square * (8.3333333333e-3 + square * (-1.9841269841e-4 + square * 2.7557319224e-6)));
    let cosine = 1.0 + square
        * (-0.5 + square * (4.1666666667e-2 + square * (-1.3888888889e-3 + square * 2.4801587302e-5)));
    let quadrant = i32(quarters) & 3;
    let turned = select(vec2<f32>(sine, cosine), vec2<f32>(cosine, -sine), (quadrant & 1) == 1);
    return select(turned, -turned, quadrant >= 2);
}

/// Angle wrapped to [−π, π].
fn wrap_angle(angle_rad: f32) -> f32 {
    return angle_rad - TAU * round(angle_rad / TAU);
}
