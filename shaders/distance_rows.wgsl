// Distance of every pixel from the nearest white one in its row. Twin: `distance_rows` in
// crates/core/src/preprocess/distance.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> evidence: array<u32>;
@group(0) @binding(2) var<storage, read_write> across: array<u32>;

/// `DISTANCE_RADIUS_PX`.
const RADIUS: u32 = 32u;

fn is_white(pixel: u32) -> bool {
    return byte_of(evidence[pixel / 4u], pixel) > 0u;
}

fn distance_of(pixel: u32) -> u32 {
    let column = pixel % picture.width;
    let last = picture.width - 1u - column;
    for (var distance = 0u; distance < RADIUS; distance++) {
        if (distance <= column && is_white(pixel - distance)) || (distance <= last && is_white(pixel + distance)) {
            return distance;
        }
    }
    return RADIUS;
}

@compute @workgroup_size(PICTURE_THREADS)
fn distance_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let pixel = 4u * index;
    across[index] = word_of(vec4<u32>(
        distance_of(pixel),
        distance_of(pixel + 1u),
        distance_of(pixel + 2u),
        distance_of(pixel + 3u),
    ));
}
