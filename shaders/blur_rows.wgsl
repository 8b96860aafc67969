// Gaussian blur along the rows; the edge's value is repeated outside. Twin: `blur_rows` in
// crates/core/src/preprocess/blur.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> grey: array<u32>;
/// Three zeros, 2 · radius + 1 weights that sum to one, three zeros.
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read_write> across: array<vec4<f32>>;

@compute @workgroup_size(PICTURE_THREADS)
fn blur_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let row = index / picture.row_words * picture.row_words;
    let column = 4u * (index - row);
    let radius = picture.blur_radius;
    var sum = vec4<f32>(0.0);
    // Every value that is read counts for each of the four pixels, with the weight of its distance from that pixel.
    for (var i = 0u; i < 2u * radius + 4u; i++) {
        let source = min(max(column + i, radius) - radius, picture.width - 1u);
        let value = f32(byte_of(grey[row + source / 4u], source));
        sum += value * vec4<f32>(weights[i + 3u], weights[i + 2u], weights[i + 1u], weights[i]);
    }
    across[index] = sum;
}
