// The drawn picture as a texture; pixels that no source saw are filled from the first level, and those outside the lens stay
// black. Twin: `complete` in crates/core/src/warp/blend.rs.

#import shared/levels.wgsl

/// One word with colour and source, then one with the trust.
@group(0) @binding(2) var<storage, read> warped: array<vec2<u32>>;
@group(0) @binding(3) var picture: texture_storage_2d<rgba8unorm, write>;

const NOWHERE: u32 = 255u;

@compute @workgroup_size(LEVEL_THREADS)
fn complete(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= levels.fine.x * levels.fine.y {
        return;
    }
    let place = vec2<u32>(index % levels.fine.x, index / levels.fine.x);
    let word = warped[index].x;
    let drawn = vec3<f32>(vec3<u32>(word & 255u, (word >> 8u) & 255u, (word >> 16u) & 255u));
    let filled = bilinear(place);
    let is_filled = (word >> 24u) == NOWHERE && filled.w > 0.0;
    let color = select(drawn, floor(filled.xyz + 0.5), is_filled);
    textureStore(picture, place, vec4<f32>(color / 255.0, 1.0));
}
