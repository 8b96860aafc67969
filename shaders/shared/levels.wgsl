// Levels of a picture whose unknown pixels are filled, each half the size of the one before.
// Twin: `Level` in crates/core/src/warp/fill.rs.

const LEVEL_THREADS: u32 = 64u;

/// Two levels, one after the other. The finest of all is the picture that was drawn; it is not among the pixels.
struct Levels {
    /// Columns and rows.
    fine: vec2<u32>,
    coarse: vec2<u32>,
    /// Number of the first pixel.
    first_fine: u32,
    first_coarse: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<uniform> levels: Levels;
/// Red, green, blue (0–255) and weight, 0 for unknown pixels, level after level.
@group(0) @binding(1) var<storage, read_write> pixels: array<vec4<f32>>;

fn thread_number(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> u32 {
    return (group.y * groups.x + group.x) * LEVEL_THREADS + thread;
}

/// Weighted mean of summed pixels; the sum's weight is that of the mean where it is less than 1.
fn mean(sum: vec4<f32>) -> vec4<f32> {
    return sum / max(sum.w, 1.0);
}

fn coarse_pixel(column: i32, row: i32) -> vec4<f32> {
    let last = vec2<i32>(levels.coarse) - 1;
    let place = vec2<u32>(clamp(vec2<i32>(column, row), vec2<i32>(0), last));
    return pixels[levels.first_coarse + place.y * levels.coarse.x + place.x];
}

/// Colour of the coarser level at a pixel of the finer one, and a weight of 0 if nothing around it is known. The centre of a
/// coarse pixel lies between two fine ones: three quarters of its own, one quarter of the next.
fn bilinear(place: vec2<u32>) -> vec4<f32> {
    let own = vec2<i32>(place / 2u);
    let beside = own + select(vec2<i32>(1), vec2<i32>(-1), place % 2u == vec2<u32>(0u));
    let sum = 9.0 * coarse_pixel(own.x, own.y)
        + 3.0 * coarse_pixel(beside.x, own.y)
        + 3.0 * coarse_pixel(own.x, beside.y)
        + coarse_pixel(beside.x, beside.y);
    return select(vec4<f32>(0.0), vec4<f32>(sum.xyz / max(sum.w, 1e-12), 1.0), sum.w > 0.0);
}
