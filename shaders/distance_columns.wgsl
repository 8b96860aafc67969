// Smallest distance over the column, from the distances along the rows, eight grey levels per pixel. Twin:
// `distance_columns` in crates/core/src/preprocess/distance.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> across: array<u32>;
@group(0) @binding(2) var<storage, read_write> image: array<u32>;

/// `DISTANCE_RADIUS_PX`.
const RADIUS: u32 = 32u;
/// `DISTANCE_UNITS_PER_PX`.
const UNITS_PER_PX: f32 = 8.0;

@compute @workgroup_size(PICTURE_THREADS)
fn distance_columns(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let row = index / picture.row_words;
    let column = index - row * picture.row_words;
    var nearest = vec4<u32>(2u * RADIUS * RADIUS);
    let end = min(row + RADIUS + 1u, picture.height);
    for (var other = max(row, RADIUS) - RADIUS; other < end; other++) {
        let distances = bytes_of(across[other * picture.row_words + column]);
        let along = max(row, other) - min(row, other);
        nearest = min(nearest, distances * distances + vec4<u32>(along * along));
    }
    image[index] = word_of(min(vec4<u32>(sqrt(vec4<f32>(nearest)) * UNITS_PER_PX + 0.5), vec4<u32>(255u)));
}
