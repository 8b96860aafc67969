// Distance of every pixel from the nearest white one in its row. Twin: `distance_rows` in
// crates/core/src/preprocess/distance.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> evidence: array<u32>;
@group(0) @binding(2) var<storage, read_write> across: array<u32>;

/// `DISTANCE_RADIUS_PX`.
const RADIUS: u32 = 32u;

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
    let row = index / picture.row_words * picture.row_words;
    let column = index - row;
    let pixels = vec4<i32>(4 * i32(column)) + vec4<i32>(0, 1, 2, 3);
    var nearest = vec4<u32>(RADIUS);
    let end = min(column + RADIUS / 4u + 1u, picture.row_words);
    for (var other = max(column, RADIUS / 4u) - RADIUS / 4u; other < end; other++) {
        let white = bytes_of(evidence[row + other]) > vec4<u32>(0u);
        for (var i = 0u; i < 4u; i++) {
            let distance = vec4<u32>(abs(pixels - vec4<i32>(4 * i32(other) + i32(i))));
            nearest = select(nearest, min(nearest, distance), vec4<bool>(white[i]));
        }
    }
    across[index] = word_of(nearest);
}
