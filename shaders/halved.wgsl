// A level at half its size. Twin: `halved` in crates/core/src/warp/fill.rs.

#import shared/levels.wgsl

fn fine_pixel(place: vec2<u32>) -> vec4<f32> {
    if any(place >= levels.fine) {
        return vec4<f32>(0.0);
    }
    return pixels[levels.first_fine + place.y * levels.fine.x + place.x];
}

@compute @workgroup_size(LEVEL_THREADS)
fn halved(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= levels.coarse.x * levels.coarse.y {
        return;
    }
    let first = 2u * vec2<u32>(index % levels.coarse.x, index / levels.coarse.x);
    let sum = fine_pixel(first)
        + fine_pixel(first + vec2<u32>(1u, 0u))
        + fine_pixel(first + vec2<u32>(0u, 1u))
        + fine_pixel(first + vec2<u32>(1u, 1u));
    pixels[levels.first_coarse + index] = mean(sum);
}
