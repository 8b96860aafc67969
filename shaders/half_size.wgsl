// The first level: the drawn picture at half its size, from the pixels that some source saw.
// Twin: `half_size` in crates/core/src/warp/fill.rs.

#import shared/levels.wgsl

/// One word with colour and source, then one with the trust.
@group(0) @binding(2) var<storage, read> warped: array<vec2<u32>>;

/// From this number of a source on, a pixel was seen by none.
const OUTSIDE: u32 = 254u;

/// Colour with a weight of 1, or nothing.
fn known(place: vec2<u32>) -> vec4<f32> {
    if any(place >= levels.fine) {
        return vec4<f32>(0.0);
    }
    let word = warped[place.y * levels.fine.x + place.x].x;
    let color = vec3<f32>(vec3<u32>(word & 255u, (word >> 8u) & 255u, (word >> 16u) & 255u));
    return select(vec4<f32>(0.0), vec4<f32>(color, 1.0), (word >> 24u) < OUTSIDE);
}

@compute @workgroup_size(LEVEL_THREADS)
fn half_size(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= levels.coarse.x * levels.coarse.y {
        return;
    }
    let first = 2u * vec2<u32>(index % levels.coarse.x, index / levels.coarse.x);
    let sum = known(first)
        + known(first + vec2<u32>(1u, 0u))
        + known(first + vec2<u32>(0u, 1u))
        + known(first + vec2<u32>(1u, 1u));
    pixels[levels.first_coarse + index] = mean(sum);
}
