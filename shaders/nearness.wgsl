// The cap minus the distance to the next white pixel, at least 0. Twin: `nearness` in
// crates/core/src/observation/model.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read_write> image: array<u32>;

@compute @workgroup_size(PICTURE_THREADS)
fn nearness(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let distances = bytes_of(image[index]);
    image[index] = word_of(max(vec4<u32>(picture.nearness_cap), distances) - distances);
}
