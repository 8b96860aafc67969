// Unknown pixels of a level take the colour of the next coarser one. Twin: `take_unknown` in crates/core/src/warp/fill.rs.

#import shared/levels.wgsl

@compute @workgroup_size(LEVEL_THREADS)
fn take_unknown(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= levels.fine.x * levels.fine.y {
        return;
    }
    if pixels[levels.first_fine + index].w == 0.0 {
        pixels[levels.first_fine + index] = bilinear(vec2<u32>(index % levels.fine.x, index / levels.fine.x));
    }
}
